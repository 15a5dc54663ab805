#include "estimator/determined.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/angles.h"
#include "base/format.h"
#include "base/messages/messages.h"
#include "estimator/notes.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator {
namespace {

// Of a value of which is known only that it lies between 0 and the most that it could be, the sigma
// is this share of the most: that of a uniform distribution.
constexpr double kUniform = 0.28867513459481287;
// The diffuse part is what shading shows lights by: one that is less than its sigma is none as soon
// as the sigma is this share of the brightest radiance.
constexpr double kDiffuseShare = 0.05;
// Of what is spread over orders of magnitude, as the highlight's strength: sigmas per value of
// which only the range is known, uniform in the logarithm, five orders of it.
constexpr double kUnknownFactor = 3.5;
constexpr double kMostRoughness = 90.0;  // degrees
constexpr double kFlatDeg = 5.0;         // normals within this say nothing of a direction

bool IsUnknown(double value, double sigma, double most, double share = kUniform) {
  return !std::isfinite(sigma) || (sigma > value && sigma > share * most);
}
bool IsUnknownFactor(double value, double sigma, double most) {
  return IsUnknown(value, sigma, most) && (!std::isfinite(sigma) || sigma > kUnknownFactor * value);
}

bool HasDirection(const LightEstimate& light) {
  return std::isfinite(light.direction_sigma) &&
         RadToDeg(light.direction_sigma) <= kUnknownDirectionDeg;
}

// The widest angle between the mean normal and the normals that are seen.
double NormalSpreadDeg(const observe::Observations& all) {
  const auto normal = [&](std::size_t i) {
    return Eigen::Vector3d(all.normal[0][i], all.normal[1][i], all.normal[2][i]).normalized();
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != observe::Observations::kNoPixel) mean += normal(i);
  mean.normalize();
  double least = 1.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != observe::Observations::kNoPixel)
      least = std::min(least, mean.dot(normal(i)));
  return RadToDeg(std::acos(std::clamp(least, -1.0, 1.0)));
}

tl::unexpected<Error> NoDirection(const observe::Observations& all, const Estimate& estimate) {
  const double spread = NormalSpreadDeg(all);
  if (spread < kFlatDeg)
    return messages::Refuse("direction-unknown/flat", {{"spread", Format("%.1f", spread)}});
  const double noise = observe::EstimateNoise(all), brightest = observe::BrightestRadiance(all);
  if (Noisy(noise, brightest))
    return messages::Refuse("direction-unknown/noisy",
                            {{"share", Format("%.0f", 100.0 * noise / brightest)}});
  const double sigma = RadToDeg(estimate.lights.front().direction_sigma);
  return messages::Refuse(
      "direction-unknown",
      {{"sigma", std::isfinite(sigma) ? Format("%.0f degrees", sigma) : "without a bound"},
       {"views", std::to_string(estimate.views) + (estimate.views == 1 ? " view" : " views")},
       {"pixels", std::to_string(estimate.pixels)}});
}

// The lights that have no direction, out of every list.
std::size_t DropLights(Estimate& out) {
  std::size_t dropped = 0;
  for (std::size_t i = out.lights.size(); i-- > 0;) {
    if (HasDirection(out.lights[i])) continue;
    const auto at = static_cast<std::ptrdiff_t>(i);
    out.lights.erase(out.lights.begin() + at);
    out.stat.lights.erase(out.stat.lights.begin() + at);
    auto& forecasts = out.fit.directions.lights;
    if (!forecasts.empty()) forecasts.erase(forecasts.begin() + at);
    for (uncertainty::BudgetItem& item : out.budget)
      item.sigma.lights.erase(item.sigma.lights.begin() + at);
    out.correlation = uncertainty::WithoutLight(out.correlation, i);
    ++dropped;
  }
  return dropped;
}

class Unknowns {
 public:
  void Add(const std::string& key, bool unknown) {
    if (unknown) keys_.push_back(key);
  }
  // Of R, G and B.
  void Add(const std::string& key, const Eigen::Vector3d& value, const Eigen::Vector3d& sigma,
           double most, double share) {
    for (int c = 0; c < 3; ++c)
      Add(key + "/" + std::to_string(c), IsUnknown(value[c], sigma[c], most, share));
  }
  std::vector<std::string> keys() const { return keys_; }

 private:
  std::vector<std::string> keys_;
};

void AddLight(const Estimate& estimate, std::size_t i, double most, Unknowns& unknowns) {
  const LightEstimate& light = estimate.lights[i];
  const std::string number = std::to_string(i), key = "lights/" + number + "/";
  unknowns.Add(key + "intensity", light.intensity_sigma && IsUnknown(light.light.intensity,
                                                                     *light.intensity_sigma, 1.0));
  const bool no_distance = light.distance && IsUnknown(*light.distance, *light.distance_sigma, 0.0);
  for (const char* place : {"distance", "position", "position_covariance"})
    unknowns.Add(key + place, no_distance);
  unknowns.Add("products/diffuse/" + number, light.diffuse_product, light.diffuse_product_sigma,
               most, kDiffuseShare);
  // Without a highlight its product is 0, and the sigma says how much could have been overlooked.
  const bool lobe = estimate.reflectance.lobes[0].present();
  const double specular = light.specular_product[0], sigma = light.specular_product_sigma[0];
  unknowns.Add("products/specular/" + number,
               lobe ? IsUnknownFactor(specular, sigma, most) : !(sigma <= most));
}

void AddReflectance(const Estimate& estimate, double most, Unknowns& unknowns) {
  const model::Reflectance& r = estimate.reflectance;
  const ReflectanceSigma& sigma = estimate.sigma;
  unknowns.Add("reflectance/albedo", r.albedo, sigma.albedo, 1.0, kUniform);
  unknowns.Add("reflectance/ambient", IsUnknown(r.ambient, sigma.ambient, most));
  unknowns.Add("reflectance/diffuse", IsUnknown(r.diffuse, sigma.diffuse, most, kDiffuseShare));
  if (r.diffuse_model == model::DiffuseModel::kOrenNayar)
    unknowns.Add("reflectance/roughness_deg",
                 !sigma.roughness ||
                     IsUnknown(RadToDeg(r.roughness), RadToDeg(*sigma.roughness), kMostRoughness));
}

// What of a lobe is not known: its strength, its shape, and its peak, which depends on the shape
// too unless the lobe is a power of a cosine.
struct UnknownOfLobe {
  bool strength, shape, peak;
};

UnknownOfLobe UnknownOf(const model::Lobe& lobe, const ReflectanceSigma::OfLobe& sigma,
                        double most) {
  const model::reflectance::LobeFacts& facts = model::FactsOf(lobe.model);
  model::Lobe unit = lobe;
  unit.strength = 1.0;
  const double scale = model::LobePeak(unit);
  UnknownOfLobe out{};
  out.strength = IsUnknownFactor(scale * lobe.strength, scale * sigma.strength, most);
  // As above, of the range that the model allows: an alpha spans half as many orders as a
  // shininess.
  const double factor = kUniform * std::log(facts.most_shape / facts.least_shape);
  out.shape = !sigma.shape || *sigma.shape > factor * lobe.shape;
  out.peak = out.strength || (out.shape && !facts.cosine_power);
  return out;
}

void AddLobes(const Estimate& estimate, double most, Unknowns& unknowns) {
  const auto& lobes = estimate.reflectance.lobes;
  if (!lobes[0].present()) return;
  const UnknownOfLobe first = UnknownOf(lobes[0], estimate.sigma.lobes[0], most);
  const bool listed = model::FactsOf(lobes[0].model).physical || lobes[1].present();
  unknowns.Add("reflectance/specular", first.strength);
  unknowns.Add("reflectance/lobe/peak", first.peak);
  if (!model::FactsOf(lobes[0].model).physical) unknowns.Add("reflectance/shininess", first.shape);
  unknowns.Add("reflectance/lobe/fwhm_deg", first.shape);
  for (std::size_t k = 0; k < lobes.size() && listed && lobes[k].present(); ++k) {
    const UnknownOfLobe unknown = UnknownOf(lobes[k], estimate.sigma.lobes[k], most);
    const std::string key = "reflectance/lobes/" + std::to_string(k) + "/";
    unknowns.Add(key + "specular", unknown.strength);
    unknowns.Add(key + model::FactsOf(lobes[k].model).shape_key, unknown.shape);
    unknowns.Add(key + "peak", unknown.peak);
    unknowns.Add(key + "fwhm_deg", unknown.shape);
  }
}

// The keys for a person: three channels as one, and nothing that follows from another key.
std::string Shown(const std::vector<std::string>& keys) {
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::string& key = keys[i];
    const bool of_lobe = key.find("/lobe/") != std::string::npos || key.ends_with("/peak") ||
                         key.ends_with("/fwhm_deg");
    if (of_lobe || key.ends_with("position") || key.ends_with("position_covariance")) continue;
    const std::string stem = key.substr(0, key.size() - 1);
    if (key.ends_with("/0") && i + 2 < keys.size() && keys[i + 1] == stem + "1" &&
        keys[i + 2] == stem + "2") {
      shown.push_back(key.substr(0, key.size() - 2));
      i += 2;
    } else {
      shown.push_back(key);
    }
  }
  return Listed(shown);
}

}  // namespace

bool IsUndetermined(const Estimate& estimate, const std::string& key) {
  return std::find(estimate.undetermined.begin(), estimate.undetermined.end(), key) !=
         estimate.undetermined.end();
}

Status LeaveOutUnknown(const observe::Observations& all, Estimate& out) {
  if (!out.has_sigmas) return {};
  if (!out.lights.empty() && !HasDirection(out.lights.front())) return NoDirection(all, out);
  if (const std::size_t dropped = DropLights(out); dropped > 0)
    AddNote("light-left-out",
            {{"lights", dropped == 1 ? "1 light is" : std::to_string(dropped) + " lights are"}},
            out);
  const double most = all.radiance_unit * observe::BrightestRadiance(all);
  Unknowns unknowns;
  for (std::size_t i = 0; i < out.lights.size(); ++i) AddLight(out, i, most, unknowns);
  AddReflectance(out, most, unknowns);
  AddLobes(out, most, unknowns);
  unknowns.Add("products/ambient", out.ambient_product, out.ambient_product_sigma, most, kUniform);
  out.undetermined = unknowns.keys();
  if (!out.undetermined.empty())
    AddNote(out.lights.empty() ? "not-determined/no-light" : "not-determined",
            {{"list", Shown(out.undetermined)}}, out);
  return {};
}

}  // namespace turnlight::estimator
