#include "calib/calibrate/probe/lights.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/format.h"
#include "base/statistics.h"
#include "calib/calibrate/probe/light_fit.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearSigmas = 3.0;  // the estimator's
constexpr double kBound95 = 1.645;   // one-sided normal
constexpr double kSamePlace = 1.5;   // pixels: views that show one spot at one place of the picture
constexpr double kMinNearRadii = 1.0;  // a light within so many radii of the ball's surface is none

// The spots of a group as what they are known to. What is wrong with a spot's shape is wrong in all
// views that show it at the same place: their number does not help.
std::vector<Sighting> SightingsOf(const std::vector<std::vector<Spot>>& spots,
                                  const SpotGroup& group) {
  std::vector<Sighting> sightings;
  const auto spot_at = [&](const SpotIndex& index) -> const Spot& {
    return spots[index.view][index.spot];
  };
  for (const SpotIndex& index : group) {
    const Spot& spot = spot_at(index);
    const auto alike = std::count_if(group.begin(), group.end(), [&](const SpotIndex& other) {
      return (spot_at(other).pixel - spot.pixel).norm() < kSamePlace;
    });
    sightings.push_back(
        {index.view, spot.pixel,
         spot.noise_covariance + static_cast<double>(alike) * spot.shape_covariance});
  }
  return sightings;
}

// A fit and its covariance from all causes, in the coordinates of LightFit.
struct Whole {
  LightFit fit;
  Matrix3d stat = Matrix3d::Zero();
  std::map<std::string, Matrix3d> systematic;
  Matrix3d total = Matrix3d::Zero();
};

std::optional<Whole> FitWhole(const std::vector<BallView>& views,
                              const std::vector<Perturbation>& perturbations,
                              const std::vector<Sighting>& sightings, const Vector3d& reference,
                              bool near) {
  const auto fit = FitLight(views, sightings, reference, near);
  if (!fit) return std::nullopt;
  Whole whole;
  whole.fit = *fit;
  // The larger of what the spots' sigmas say and what the views disagree by.
  const double scatter = fit->freedom > 0 ? fit->chi_squared / fit->freedom : 1.0;
  whole.stat = std::max(1.0, scatter) * fit->covariance;
  whole.total = whole.stat;
  const Eigen::Matrix<double, 3, 2> across = Across(fit->u);
  for (const Perturbation& perturbation : perturbations) {
    const auto moved = FitLight(perturbation.views, sightings, reference, near);
    if (!moved) return std::nullopt;
    Vector3d by;
    by << across.transpose() * (moved->u - fit->u), moved->rho - fit->rho;
    auto& item = whole.systematic.try_emplace(perturbation.item, Matrix3d::Zero()).first->second;
    item += by * by.transpose();
    whole.total += by * by.transpose();
  }
  return whole;
}

double LargerSigma(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(covariance);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

// From coordinates at the reference point p to those at W's origin: U = u + rho p, u' = U / |U|,
// rho' = rho / |U|.
struct AtOrigin {
  Vector3d u;
  double rho;
  Eigen::Matrix<double, 4, 3> differential;  // of (u', rho') by (steps of u, rho)
};

AtOrigin ToOrigin(const LightFit& fit, const Vector3d& reference) {
  const Vector3d whole = fit.u + fit.rho * reference;
  const double length = whole.norm();
  AtOrigin at{whole / length, fit.rho / length, {}};
  Eigen::Matrix3d by;
  by.leftCols<2>() = Across(fit.u);
  by.col(2) = reference;
  const Matrix3d tangent = (Matrix3d::Identity() - at.u * at.u.transpose()) / length;
  at.differential.topRows<3>() = tangent * by;
  at.differential.row(3) = -fit.rho / (length * length) * at.u.transpose() * by;
  at.differential(3, 2) += 1.0 / length;
  return at;
}

LightSigmas SigmasOf(const AtOrigin& at, const Matrix3d& covariance, bool near) {
  const Eigen::Matrix4d here = at.differential * covariance * at.differential.transpose();
  LightSigmas sigmas;
  sigmas.direction = LargerSigma(here.topLeftCorner<3, 3>());
  if (near) {
    sigmas.inverse_distance = std::sqrt(here(3, 3));
    sigmas.distance = sigmas.inverse_distance / (at.rho * at.rho);
  }
  return sigmas;
}

// Nearer than this the light is with a chance of 5 %.
std::optional<double> DistanceMin(const std::optional<Whole>& with_distance,
                                  const Vector3d& reference, double radius) {
  if (!with_distance) return std::nullopt;
  const double rho =
      std::max(0.0, with_distance->fit.rho) + kBound95 * std::sqrt(with_distance->total(2, 2));
  if (!(rho > 0.0) || 1.0 / rho < (1.0 + kMinNearRadii) * radius) return std::nullopt;
  return (reference + with_distance->fit.u / rho).norm();
}

void FillPosition(const Whole& whole, const Vector3d& reference, ProbeLight& light) {
  const double rho = whole.fit.rho;
  light.position = reference + whole.fit.u / rho;
  Matrix3d by;
  by.leftCols<2>() = Across(whole.fit.u) / rho;
  by.col(2) = -whole.fit.u / (rho * rho);
  light.position_covariance = by * whole.total * by.transpose();
}

void FillBudget(const Whole& whole, bool near, ProbeLight& light) {
  const auto item = [&](const std::string& name, const Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance.topLeftCorner<2, 2>());
    light.budget.push_back({name, std::sqrt(std::max(0.0, eigen.eigenvalues()[1])),
                            near ? std::sqrt(covariance(2, 2)) : 0.0});
  };
  item("spots", whole.stat);
  for (const auto& [name, covariance] : whole.systematic) item(name, covariance);
}

void FillBrightness(const std::vector<std::vector<Spot>>& spots, ProbeLight& light) {
  std::vector<double> open, all, extents;
  for (const SpotIndex& index : light.spots) {
    const Spot& spot = spots[index.view][index.spot];
    (spot.clipped ? all : open).push_back(spot.irradiance);
    extents.push_back(spot.extent_deg);
  }
  light.extent_deg = Median(extents);
  light.clipped = open.empty();
  light.irradiance = light.clipped ? *std::max_element(all.begin(), all.end()) : Median(open);
  if (light.clipped || open.size() < 2) return;
  double sum = 0.0;
  for (const double value : open) sum += (value - light.irradiance) * (value - light.irradiance);
  const double count = static_cast<double>(open.size());
  light.intensity_sigma = std::sqrt(sum / (count - 1.0) / count);
}

Vector3d MeanPoint(const std::vector<BallView>& views, const std::vector<std::vector<Spot>>& spots,
                   const SpotGroup& group) {
  Vector3d sum = Vector3d::Zero();
  for (const SpotIndex& index : group)
    if (const auto seen = MirrorAt(views[index.view], spots[index.view][index.spot].pixel))
      sum += seen->point;
  return sum / static_cast<double>(group.size());
}

std::optional<ProbeLight> MakeLight(const std::vector<BallView>& views,
                                    const std::vector<std::vector<Spot>>& spots,
                                    const std::vector<Perturbation>& perturbations,
                                    const SpotGroup& group) {
  const Vector3d reference = MeanPoint(views, spots, group);
  const std::vector<Sighting> sightings = SightingsOf(spots, group);
  const auto with_distance = FitWhole(views, perturbations, sightings, reference, true);
  const double radius = views[group.front().view].ball.radius;
  ProbeLight light;
  light.near = with_distance &&
               with_distance->fit.rho > kNearSigmas * std::sqrt(with_distance->total(2, 2)) &&
               1.0 / with_distance->fit.rho > (1.0 + kMinNearRadii) * radius;
  const auto whole =
      light.near ? with_distance : FitWhole(views, perturbations, sightings, reference, false);
  if (!whole) return std::nullopt;
  const AtOrigin at = ToOrigin(whole->fit, reference);
  light.direction = at.u;
  light.inverse_distance = light.near ? at.rho : 0.0;
  light.reference = reference;
  light.direction_at_reference = whole->fit.u;
  const Eigen::Matrix<double, 3, 2> across = Across(whole->fit.u);
  light.reference_covariance = across * whole->total.topLeftCorner<2, 2>() * across.transpose();
  light.direction_covariance =
      (at.differential * whole->total * at.differential.transpose()).topLeftCorner<3, 3>();
  light.sigma = SigmasOf(at, whole->total, light.near);
  light.stat = SigmasOf(at, whole->stat, light.near);
  light.distance_min = DistanceMin(with_distance, reference, radius);
  if (light.near) FillPosition(*whole, reference, light);
  FillBudget(*whole, light.near, light);
  light.scatter =
      whole->fit.freedom > 0 ? std::sqrt(whole->fit.chi_squared / whole->fit.freedom) : 0.0;
  light.spots = group;
  FillBrightness(spots, light);
  return light;
}

// Views whose ball would show the light of these spots, going by their mean direction.
std::size_t ViewsThatCould(const std::vector<BallView>& views, const ProbeLight& light) {
  constexpr double kSeenCosine = 0.25;  // a little within what FindSpots looks at
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [&](const BallView& view) {
        const auto pixel = PixelOfLight(view, light.direction, light.inverse_distance);
        const auto seen = pixel ? MirrorAt(view, *pixel) : std::nullopt;
        return seen && seen->cosine > kSeenCosine;
      }));
}

std::string WhyCandidate(const std::vector<BallView>& views,
                         const std::vector<std::vector<Spot>>& spots, const SpotGroup& group,
                         const std::optional<ProbeLight>& light) {
  std::size_t looks_like_one = 0;
  std::string why;
  for (const SpotIndex& index : group) {
    const Spot& spot = spots[index.view][index.spot];
    if (spot.kind == SpotKind::kLight) ++looks_like_one;
    if (why.empty()) why = spot.why;
  }
  if (2 * looks_like_one < group.size() || looks_like_one == 0) return why;
  if (!light) return "its rays do not meet";
  const std::size_t could = std::max(group.size(), ViewsThatCould(views, *light));
  if (2 * group.size() < could)
    return Format("seen in %zu of %zu views: it does not stand still, or is often hidden",
                  group.size(), could);
  return "";
}

// Strongest first; relative to the strongest, if what that is is known.
void FillIntensities(std::vector<ProbeLight>& lights) {
  std::stable_sort(lights.begin(), lights.end(), [](const ProbeLight& a, const ProbeLight& b) {
    return a.irradiance > b.irradiance;
  });
  const bool known = std::none_of(lights.begin(), lights.end(),
                                  [](const ProbeLight& light) { return light.clipped; });
  for (ProbeLight& light : lights) {
    if (known) light.intensity = light.irradiance / lights.front().irradiance;
    if (known && light.intensity_sigma)
      *light.intensity_sigma /= lights.front().irradiance;
    else
      light.intensity_sigma.reset();
  }
}

}  // namespace

ProbeLights FindLights(const std::vector<BallView>& views,
                       const std::vector<std::vector<Spot>>& spots,
                       const std::vector<Perturbation>& perturbations) {
  ProbeLights found;
  for (const SpotGroup& group : GroupSpots(views, spots)) {
    auto light = MakeLight(views, spots, perturbations, group);
    std::string why = WhyCandidate(views, spots, group, light);
    if (why.empty()) {
      found.lights.push_back(std::move(*light));
      continue;
    }
    const auto seen =
        MirrorAt(views[group.front().view], spots[group.front().view][group.front().spot].pixel);
    if (seen) found.candidates.push_back({group, seen->direction, std::move(why)});
  }
  FillIntensities(found.lights);
  return found;
}

}  // namespace turnlight::calib::calibrate::probe
