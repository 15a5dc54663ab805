#include "estimator/until_known.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::estimator {
namespace {

std::size_t LeastKnown(const Estimate& estimate) {
  const auto worst = std::max_element(estimate.lights.begin(), estimate.lights.end(),
                                      [](const LightEstimate& a, const LightEstimate& b) {
                                        return a.direction_sigma < b.direction_sigma;
                                      });
  return static_cast<std::size_t>(worst - estimate.lights.begin());
}

// Whether the lights are the same, none of them further away than that; radians.
bool Alike(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b,
           double most) {
  if (a.size() != b.size()) return false;
  return std::all_of(a.begin(), a.end(), [&](const Eigen::Vector3d& light) {
    return std::any_of(b.begin(), b.end(), [&](const Eigen::Vector3d& other) {
      return std::atan2(light.cross(other).norm(), light.dot(other)) <= most;
    });
  });
}

}  // namespace

bool UntilKnown::Reached(const Estimate& estimate) const {
  return !estimate.lights.empty() &&
         std::all_of(estimate.lights.begin(), estimate.lights.end(), [&](const auto& light) {
           return light.direction_sigma <= asked_.direction_sigma;  // NaN is not
         });
}

void UntilKnown::Took(double angle_deg, bool looked, const Estimate* estimate) {
  ++taken_;
  if (!looked) return;
  if (estimate == nullptr || !Reached(*estimate)) {
    held_.clear();
    return;
  }
  Held now{angle_deg, {}};
  for (const LightEstimate& light : estimate->lights)
    now.directions.push_back(light.light.direction);
  // From the first on that is not where the lights are now, it begins anew.
  const auto other = std::find_if(held_.rbegin(), held_.rend(), [&](const Held& before) {
    return !Alike(before.directions, now.directions, 2.0 * asked_.direction_sigma);
  });
  held_.erase(held_.begin(), other.base());
  held_.push_back(std::move(now));
}

UntilDecision UntilKnown::End(const std::string& id, const Estimate* estimate,
                              const messages::Values& more) const {
  messages::Values values = more;
  values.emplace("wanted", DegreesText(asked_.direction_sigma));
  values.emplace("taken", std::to_string(taken_));
  values.emplace("planned", std::to_string(asked_.planned));
  values.emplace("extra", std::to_string(plan_is_done() ? taken_ - asked_.planned : 0));
  if (estimate != nullptr && !estimate->lights.empty()) {
    const std::size_t light = LeastKnown(*estimate);
    values.emplace("light", std::to_string(light + 1));
    values.emplace("sigma", DegreesText(estimate->lights[light].direction_sigma));
  }
  UntilDecision out;
  out.kind = UntilDecision::Kind::kEnd;
  out.code = id.substr(id.find('/') + 1);
  out.words = messages::Text(id, values);
  return out;
}

UntilDecision UntilKnown::Early() const {
  if (held_.size() < kFewestHeld) return {};
  const double turned = std::abs(held_.back().angle_deg - held_.front().angle_deg);
  if (turned < kHeldDeg - 1e-6) return {};
  return End("until/early", nullptr, {{"turned", Format("%.4g", turned)}});
}

UntilDecision UntilKnown::After(const Estimate* estimate,
                                const std::vector<CandidateView>& candidates,
                                const target::Geometry& geometry, const calib::RayGrid& rays,
                                const Sensor& sensor) const {
  if (estimate == nullptr || estimate->lights.empty()) return End("until/no-estimate", nullptr);
  if (Reached(*estimate)) return End("until/reached", estimate);
  if (taken_ - asked_.planned >= asked_.most_extra) return End("until/most-extra", estimate);
  if (const auto why = WhyNoForecast(*estimate))
    return End("until/no-forecast", estimate, {{"why", *why}});
  const auto advice = AdviseNextView(*estimate, candidates, geometry, rays, sensor);
  if (!advice) return End("until/no-estimate", nullptr);  // not interrupted: there is no flag
  const bool out_of_reach = !advice->floor_item.empty() && advice->floor >= asked_.direction_sigma;
  const bool floor =
      out_of_reach || (advice->steps.empty() && advice->IsMostlyFloor(advice->sigma));
  if (floor)
    return End("until/floor", estimate,
               {{"floor", DegreesText(advice->floor)},
                {"cause", advice->floor_words},
                {"advice", advice->floor_advice}});
  if (advice->steps.empty()) return End("until/no-view", estimate);
  const NextView::Step& best = advice->steps.front();
  UntilDecision out;
  out.kind = UntilDecision::Kind::kOneMore;
  out.view = candidates[best.candidate];
  out.words = messages::Text("until/one-more", {{"view", out.view.label},
                                                {"light", std::to_string(advice->light + 1)},
                                                {"sigma", DegreesText(advice->sigma)},
                                                {"predicted", DegreesText(best.sigma)},
                                                {"wanted", DegreesText(asked_.direction_sigma)}});
  return out;
}

}  // namespace turnlight::estimator
