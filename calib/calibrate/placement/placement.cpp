#include "calib/calibrate/placement/placement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "calib/calibrate/placement/ambiguity.h"
#include "calib/calibrate/placement/fit.h"
#include "calib/calibrate/placement/start.h"
#include "estimator/target/geometry.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector3d;

constexpr int kSteps = 60;
constexpr int kTrialSteps = 8;             // from each start
constexpr std::size_t kTrialPoints = 120;  // of each view, while starts are compared
constexpr std::size_t kMostPoints = 800;   // of each view; neighbours tell the same
constexpr std::size_t kStarts = 6;         // that are refined, of those tried
constexpr double kLeastReach = 8.0;        // pixels
constexpr double kReachShare = 0.15;       // of the outline's extent
constexpr std::size_t kLeastPoints = 8;    // of a view's outline
// What is still a fit: this share of the points, and this rms in pixels.
constexpr double kLeastUsed = 0.4, kLargestRms = 4.0;
// A worse fit than this is tried with the angles the other way round.
constexpr double kDoubtfulRms = 1.0, kDoubtfulUsed = 0.75;
constexpr double kReversedGain = 0.25;  // of the cost, at most, to say so

std::vector<View> Thinned(const std::vector<View>& views, std::size_t most) {
  std::vector<View> thinned = views;
  for (View& view : thinned) {
    const std::size_t step = (view.outline.size() + most - 1) / most;
    if (step < 2) continue;
    std::vector<OutlinePoint> kept;
    for (std::size_t i = 0; i < view.outline.size(); i += step) kept.push_back(view.outline[i]);
    view.outline = std::move(kept);
  }
  return thinned;
}

double ExtentOf(const std::vector<View>& views) {
  double extent = 0.0;
  for (const View& view : views) {
    if (view.outline.empty()) continue;
    Eigen::Vector2d low = view.outline[0].pixel, high = low;
    for (const OutlinePoint& point : view.outline) {
      low = low.cwiseMin(point.pixel);
      high = high.cwiseMax(point.pixel);
    }
    extent = std::max(extent, (high - low).norm());
  }
  return extent;
}

struct Task {
  const rig::RigCalibration& calibration;
  const calib::TargetShape& shape;
  const std::vector<View>& views;
  const std::vector<PickedPoint>& picked;
  const PlacementOptions& options;
  Vector3d center_T;
  double size;
  bool outlines;  // else picked points decide

  bool sphere() const { return std::holds_alternative<calib::SphereShape>(shape); }
};

Problem MakeProblem(const Task& task, const std::vector<View>& views) {
  Problem problem{task.calibration,
                  views,
                  {},
                  {},
                  task.options.edge_offset_sigma,
                  task.outlines ? task.options.common_shift_sigma : 0.0,
                  task.size};
  if (task.sphere())
    problem.model = SphereModel(task.calibration, views);
  else if (task.outlines)
    problem.model = ContourModel(task.calibration, task.shape, views);
  else
    problem.model = PickedModel(task.calibration, views, task.picked, task.options.picked_sigma);
  for (std::size_t i = 0; i < 6; ++i) problem.free[i] = i >= 3 || !task.sphere();
  problem.free[kRadius] = task.sphere() && task.options.fit_radius;
  problem.free[kEdgeOffset] = task.outlines && task.options.edge_offset_sigma > 0.0;
  return problem;
}

Result<std::vector<State>> StartsOf(const Task& task) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&task.shape)) {
    const auto start =
        StartSphere(task.calibration, task.views, sphere->radius, task.options.fit_radius);
    if (start) return std::vector{*start};
    return InputError(task.options.fit_radius
                          ? "the radius cannot be told from these angles: allowed are pictures at "
                            "two that differ, or a known radius, without --fit-radius"
                          : "the outlines are too small to tell where the sphere is");
  }
  if (!task.picked.empty()) {
    auto starts = StartPicked(task.calibration, task.views, task.picked, task.size, 4);
    if (!starts.empty()) return starts;
    return InputError(
        "the picked points fit no placement in front of the camera: is each point's "
        "position the one of its pixel?");
  }
  if (const auto* plane = std::get_if<calib::PlaneShape>(&task.shape)) {
    auto starts = StartPlane(task.calibration, task.views, *plane);
    if (!starts.empty()) return starts;
    return InputError(
        "no outline has four corners: pick four points of the target (--points FILE)");
  }
  if (!task.options.upright)
    return InputError(
        "a mesh needs picked points to begin with (--points FILE), or, if it stands upright on the "
        "table (its z axis along the table's), --upright");
  auto starts = StartUpright(task.calibration, task.views, task.center_T, task.size);
  if (!starts.empty()) return starts;
  return InputError("the outlines are too small to tell where the mesh is");
}

// The best few, by how far a few steps on a few points get.
std::vector<State> BestStarts(const Task& task, std::vector<State> starts, double reach) {
  if (starts.size() < 2 || !task.outlines) return starts;
  const std::vector<View> few = Thinned(task.views, kTrialPoints);
  const Problem problem = MakeProblem(task, few);
  std::vector<std::pair<double, State>> tried;
  for (const State& start : starts) {
    const Fit fit = Solve(problem, start, reach, kTrialSteps);
    tried.push_back({LimitedCost(fit.residuals, kCostLimit), fit.state});
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<State> best;
  for (const auto& [cost, state] : tried)
    if (best.size() < kStarts) best.push_back(state);
  return best;
}

struct Fitted {
  Fit fit;
  double cost = 0.0;
};

Result<Fitted> FitAll(const Task& task, const std::vector<View>& views) {
  auto starts = StartsOf(task);
  if (!starts) return Forward(starts);
  const double reach = std::max(kLeastReach, kReachShare * ExtentOf(views));
  const Problem problem = MakeProblem(task, views);
  Fitted best;
  best.cost = INFINITY;
  for (const State& start : BestStarts(task, *std::move(starts), reach)) {
    const Fit near = Solve(problem, start, reach, kSteps);
    State begin = near.state;
    begin.edge_offset = std::clamp(begin.edge_offset, -1.0, 1.0);
    Fit fit = Solve(problem, begin, std::max(kLeastReach, 6.0 * near.rms), kSteps);
    const double cost = LimitedCost(fit.residuals, kCostLimit);
    if (cost < best.cost) best = {std::move(fit), cost};
  }
  return best;
}

double UsedShare(const Fit& fit) {
  const auto used = std::count(fit.used.begin(), fit.used.end(), true);
  return fit.used.empty() ? 0.0 : static_cast<double>(used) / static_cast<double>(fit.used.size());
}

// If the outlines fit with the table going the other way round: by what rms.
std::optional<double> ReversedRms(const Task& task, const std::vector<View>& views, double cost) {
  std::vector<View> reversed = views;
  for (View& view : reversed) view.angle_deg = -view.angle_deg;
  const Task other{task.calibration, task.shape,    reversed,  task.picked,
                   task.options,     task.center_T, task.size, task.outlines};
  const auto fitted = FitAll(other, reversed);
  if (!fitted || !(fitted->cost < kReversedGain * cost)) return std::nullopt;
  return fitted->fit.rms;
}

Status CheckInputs(const Task& task) {
  if (task.sphere() && !task.outlines)
    return InputError("a sphere needs outlines: no picture shows enough of it");
  if (!task.outlines && task.picked.empty())
    return InputError("no picture shows enough of the target's outline, and no points are picked");
  if (!task.picked.empty() && task.picked.size() < 4 && !task.sphere())
    return InputError(std::to_string(task.picked.size()) +
                      " points are picked, allowed are at least 4");
  for (const PickedPoint& point : task.picked)
    if (point.view >= task.views.size())
      return InputError(point.where + ": there is no such frame");
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (const PickedPoint& point : task.picked)
    mean += point.p_T / static_cast<double>(task.picked.size());
  for (const PickedPoint& point : task.picked)
    spread += (point.p_T - mean) * (point.p_T - mean).transpose();
  const Vector3d sizes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  if (!task.picked.empty() && !task.sphere() && !(sizes[1] > 1e-6 * sizes[2]))
    return InputError(
        "the picked points lie on one line of the target, allowed are points that "
        "span a plane");
  return {};
}

// How long a pixel is at the target, in the first view.
double PixelLength(const Task& task, const State& state) {
  const Vector3d p_C = PoseOfTableInCamera(task.calibration.geometry, task.views[0].angle_deg) *
                       (state.X_AT * task.center_T);
  const double step = 1e-4 * p_C.norm();
  const auto pixels =
      task.calibration.lens.Project({p_C, p_C + step * p_C.cross(Vector3d::UnitY()).normalized()});
  return step / (pixels[1] - pixels[0]).norm();
}

void FillPoints(const Fit& fit, Placement& placement) {
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    const Residual& r = fit.residuals[i];
    placement.points.push_back({r.view, r.pixel, r.normal, r.value, fit.used[i]});
  }
}

Status CheckFit(const Fit& fit, const Task& task, const std::optional<double>& reversed) {
  if (UsedShare(fit) >= kLeastUsed && fit.rms <= kLargestRms) return {};
  std::string text = Format(
      "the outlines do not fit the target: %.0f %% of their points are near the expected outline, "
      "with an rms of %.2f px; allowed is at least %.0f %% and at most %.0f px.",
      100.0 * UsedShare(fit), fit.rms, 100.0 * kLeastUsed, kLargestRms);
  if (reversed)
    text += Format(
        " With the angles the other way round the rms is %.2f px: the table turns "
        "against the calibration's sense (angle_scale has the wrong sign)",
        *reversed);
  else
    text += task.picked.empty() ? " Are size, calibration and angles those of these pictures?"
                                : " Are the picked points right, and the size and the calibration "
                                  "those of these pictures?";
  return NoEstimateError(text);
}

Placement Describe(const Task& task, const Problem& problem, const Fit& fit) {
  const FitCovariance covariance = CovarianceOf(problem, fit);
  Placement placement;
  placement.X_AT = fit.state.X_AT;
  placement.from_outlines = covariance.from_outlines.topLeftCorner<6, 6>();
  placement.from_calibration = covariance.from_calibration.topLeftCorner<6, 6>();
  placement.covariance = placement.from_outlines + placement.from_calibration;
  const Eigen::MatrixXd total = covariance.from_outlines + covariance.from_calibration;
  placement.calibration = covariance.calibration;
  placement.with_calibration = covariance.with_calibration.topRows(6);
  placement.radius = fit.state.radius;
  placement.radius_sigma = std::sqrt(total(kRadius, kRadius));
  placement.edge_offset = fit.state.edge_offset;
  placement.edge_offset_sigma = std::sqrt(total(kEdgeOffset, kEdgeOffset));
  placement.rms = fit.rms;
  placement.correlation = fit.correlation;
  placement.wobble = covariance.wobble;
  placement.views = covariance.views;
  placement.rotation_matters = !task.sphere();
  placement.pixel_length = PixelLength(task, fit.state);
  FillPoints(fit, placement);
  return placement;
}

}  // namespace

rig::RigCalibration WithTarget(const rig::RigCalibration& calibration, const Placement& placement) {
  rig::RigCalibration with = calibration;
  with.geometry.X_AT = placement.X_AT;
  with.target_placed = true;
  rig::MarkFound(with, {"X_AT"});
  // Symmetric to the last bit, as sums of products are not.
  const Eigen::MatrixXd own = 0.5 * (placement.covariance + placement.covariance.transpose());
  with.covariances.X_AT = own;
  with.covariances.joint.reset();
  const rig::JointCovariance& parts = placement.calibration;
  if (parts.of.empty()) return with;
  rig::JointCovariance joint{parts.of, {}};
  joint.of.push_back("X_AT");
  const Eigen::Index size = parts.matrix.rows();
  joint.matrix.resize(size + 6, size + 6);
  joint.matrix << parts.matrix, placement.with_calibration.transpose(), placement.with_calibration,
      own;
  with.covariances.joint = std::move(joint);
  return with;
}

Result<Placement> PlaceTarget(const rig::RigCalibration& calibration,
                              const calib::TargetShape& shape, const std::vector<View>& views,
                              const std::vector<PickedPoint>& picked,
                              const PlacementOptions& options) {
  const estimator::target::Geometry geometry(shape);
  const std::vector<View> thinned = Thinned(views, kMostPoints);
  const bool outlines = std::any_of(views.begin(), views.end(), [](const View& view) {
    return view.outline.size() >= kLeastPoints;
  });
  const Task task{calibration,       shape,   thinned, picked, options, geometry.center(),
                  geometry.radius(), outlines};
  if (Status status = CheckInputs(task); !status) return Forward(status);
  auto fitted = FitAll(task, thinned);
  if (!fitted) return Forward(fitted);
  Fit& fit = fitted->fit;
  std::optional<double> reversed;
  if (fit.rms > kDoubtfulRms || UsedShare(fit) < kDoubtfulUsed)
    reversed = ReversedRms(task, thinned, fitted->cost);
  if (Status status = CheckFit(fit, task, reversed); !status) return Forward(status);
  const Problem problem = MakeProblem(task, thinned);
  Placement placement = Describe(task, problem, fit);
  placement.reversed_rms = reversed;
  if (outlines) ResolveAmbiguity(problem, fit, shape, !picked.empty(), placement);
  AddRemarks(shape, thinned, options, placement);
  return placement;
}

}  // namespace turnlight::calib::calibrate::placement
