#include "calib/calibrate/probe/association.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/angles.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

// Between what errors of the ball's place do to a direction and the nearest two lamps.
const double kAgree = DegToRad(1.5);
// Pairs are proposed by spots of so many views: more add nothing but time.
constexpr std::size_t kProposingViews = 12;

struct Ray {
  SpotIndex index;
  Vector3d point, direction;
  bool light = false;
  bool taken = false;
};

struct Proposal {
  Vector3d u;  // from W's origin: u - rho x
  double rho = 0.0;
};

// The point where two rays pass each other; nothing unless it is in front of both.
std::optional<Vector3d> Passing(const Ray& a, const Ray& b) {
  const double cosine = a.direction.dot(b.direction);
  const double sine_squared = 1.0 - cosine * cosine;
  if (sine_squared < 1e-12) return std::nullopt;
  const Vector3d between = b.point - a.point;
  const double along_a =
      (between.dot(a.direction) - cosine * between.dot(b.direction)) / sine_squared;
  const double along_b =
      (cosine * between.dot(a.direction) - between.dot(b.direction)) / sine_squared;
  if (!(along_a > 0.0) || !(along_b > 0.0)) return std::nullopt;
  return 0.5 * (a.point + along_a * a.direction + b.point + along_b * b.direction);
}

double AngleTo(const Ray& ray, const Proposal& proposal) {
  const Vector3d predicted = (proposal.u - proposal.rho * ray.point).normalized();
  return 2.0 * std::asin(std::min(1.0, 0.5 * (predicted - ray.direction).norm()));
}

struct Support {
  std::vector<std::size_t> rays;
  int lights = 0;
  double angles = 0.0;
  bool Beats(const Support& other) const {
    if (lights != other.lights) return lights > other.lights;
    if (rays.size() != other.rays.size()) return rays.size() > other.rays.size();
    return angles < other.angles;
  }
};

// Of each view the untaken ray that is nearest to the proposal, if it agrees. Rays are in order of
// views.
Support SupportOf(const std::vector<Ray>& rays, const Proposal& proposal) {
  Support support;
  for (std::size_t first = 0; first < rays.size();) {
    std::size_t end = first;
    std::optional<std::size_t> nearest;
    double angle = kAgree;
    for (; end < rays.size() && rays[end].index.view == rays[first].index.view; ++end) {
      if (rays[end].taken) continue;
      const double here = AngleTo(rays[end], proposal);
      if (here > angle) continue;
      angle = here;
      nearest = end;
    }
    if (nearest) {
      support.rays.push_back(*nearest);
      support.lights += rays[*nearest].light ? 1 : 0;
      support.angles += angle;
    }
    first = end;
  }
  return support;
}

void Consider(const std::vector<Ray>& rays, const Proposal& proposal, Support& best) {
  Support support = SupportOf(rays, proposal);
  if (support.Beats(best)) best = std::move(support);
}

std::vector<Ray> RaysOf(const std::vector<BallView>& views,
                        const std::vector<std::vector<Spot>>& spots) {
  std::vector<Ray> rays;
  for (std::size_t view = 0; view < views.size(); ++view)
    for (std::size_t spot = 0; spot < spots[view].size(); ++spot)
      if (const auto seen = MirrorAt(views[view], spots[view][spot].pixel))
        rays.push_back({{view, spot},
                        seen->point,
                        seen->direction,
                        spots[view][spot].kind == SpotKind::kLight});
  return rays;
}

Support BestSupport(const std::vector<Ray>& rays, std::size_t views) {
  const std::size_t stride = (views + kProposingViews - 1) / kProposingViews;
  std::vector<std::size_t> proposing;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!rays[i].taken && (rays[i].index.view % stride == 0 || views <= kProposingViews))
      proposing.push_back(i);
  Support best;
  for (std::size_t i = 0; i < proposing.size(); ++i) {
    const Ray& a = rays[proposing[i]];
    Consider(rays, {a.direction, 0.0}, best);
    for (std::size_t j = i + 1; j < proposing.size(); ++j) {
      const Ray& b = rays[proposing[j]];
      if (a.index.view == b.index.view) continue;
      if (const auto point = Passing(a, b))
        Consider(rays, {point->normalized(), 1.0 / point->norm()}, best);
    }
  }
  return best;
}

}  // namespace

std::vector<SpotGroup> GroupSpots(const std::vector<BallView>& views,
                                  const std::vector<std::vector<Spot>>& spots) {
  std::vector<Ray> rays = RaysOf(views, spots);
  std::vector<SpotGroup> groups;
  for (;;) {
    Support support = BestSupport(rays, views.size());
    if (support.rays.empty()) {
      // Spots of views that propose nothing.
      const auto left =
          std::find_if(rays.begin(), rays.end(), [](const Ray& r) { return !r.taken; });
      if (left == rays.end()) return groups;
      support = SupportOf(rays, {left->direction, 0.0});
    }
    SpotGroup group;
    for (const std::size_t ray : support.rays) {
      rays[ray].taken = true;
      group.push_back(rays[ray].index);
    }
    groups.push_back(std::move(group));
  }
}

}  // namespace turnlight::calib::calibrate::probe
