#include <algorithm>
#include <memory>

#include "calib/calibrate/drift/sights.h"
#include "calib/calibrate/placement/contour.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr std::size_t kFewestOnOutline = 40;  // of an outline
constexpr std::size_t kMostOnOutline = 400;   // of an outline; neighbours tell the same
constexpr double kLeastOutlineReach = 12.0;   // pixels
constexpr double kReachShare = 0.15;          // of an outline's extent

placement::View ThinnedView(const placement::View& view) {
  placement::View thinned = view;
  const std::size_t step = (view.outline.size() + kMostOnOutline - 1) / kMostOnOutline;
  if (step < 2) return thinned;
  thinned.outline.clear();
  for (std::size_t i = 0; i < view.outline.size(); i += step)
    thinned.outline.push_back(view.outline[i]);
  return thinned;
}

double ExtentOf(const placement::View& view) {
  Eigen::Vector2d low = view.outline.front().pixel, high = low;
  for (const placement::OutlinePoint& point : view.outline) {
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  return (high - low).norm();
}

}  // namespace

Result<Sights> SightsOfOutlines(const rig::RigCalibration& calibration, const TargetShape& shape,
                                const std::vector<placement::View>& views) {
  Sights sights(calibration);
  sights.edges = true;
  for (const placement::View& view : views) {
    if (view.outline.size() < kFewestOnOutline) {
      sights.left_out.push_back(view.label + ": no outline of the target was found");
      continue;
    }
    sights.views.push_back(ThinnedView(view));
    sights.reach = std::max({sights.reach, kLeastOutlineReach, kReachShare * ExtentOf(view)});
  }
  if (sights.views.empty())
    return InputError("no picture shows the target's outline, allowed is at least one that does");
  const double reach = sights.reach;
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    sights.residuals = [radius = sphere->radius, reach](const rig::RigCalibration& rig,
                                                        const std::vector<placement::View>& at,
                                                        double edge_offset) {
      return placement::SphereModel(rig, at)({rig.geometry.X_AT, radius, edge_offset}, reach);
    };
    return sights;
  }
  const auto finder = std::make_shared<const placement::ContourFinder>(shape);
  sights.residuals = [finder, reach](const rig::RigCalibration& rig,
                                     const std::vector<placement::View>& at, double edge_offset) {
    return placement::ContourModel(rig, finder, at)({rig.geometry.X_AT, 0.0, edge_offset}, reach);
  };
  return sights;
}

}  // namespace turnlight::calib::calibrate::drift
