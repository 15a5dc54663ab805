#include "calib/calibrate/placement/ambiguity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kSquare = 1e-3;  // of the sides, relative: below, outlines cannot tell them apart
// Outlines that a rotation changes by less, in pixels or as a share of the target's extent, are the
// same: less is what the facets of a turned body do.
constexpr double kSameOutline = 0.25, kSameOutlineShare = 0.004;
constexpr double kTurnsDeg[] = {17.0, 40.0, 71.0, 104.0, 139.0, 180.0};
constexpr double kDifferentDeg = 0.5;    // between angles that count as two
constexpr double kManyOutliers = 0.1;    // share of a view's points
constexpr double kOffsetSurprise = 3.0;  // sigma of the prior

void ChooseTurnOfPlane(const calib::PlaneShape& plane, Placement& placement) {
  const bool square = std::abs(plane.width - plane.height) < kSquare * plane.width;
  const auto turned = [](const calib::Pose& pose, double angle, const Vector3d& axis) {
    return calib::Pose{pose.rotation * Eigen::AngleAxisd(angle, axis).toRotationMatrix(),
                       pose.translation};
  };
  if (plane.sides == 2 && placement.X_AT.rotation(2, 2) < 0.0)
    placement.X_AT = turned(placement.X_AT, pi, Vector3d::UnitX());
  calib::Pose best = placement.X_AT;
  for (int i = 1; i < 4; ++i) {
    if (!square && i != 2) continue;
    const calib::Pose other = turned(placement.X_AT, 0.5 * pi * i, Vector3d::UnitZ());
    if (other.rotation(0, 0) > best.rotation(0, 0)) best = other;
  }
  placement.X_AT = best;
  placement.remarks.push_back(std::string("the outline of a ") + (square ? "square" : "rectangle") +
                              " cannot tell which of its sides is which: T's x axis is the one "
                              "nearest to A's x axis; picked points decide it");
}

// The direction that the outlines determine worst: a twist (w unit, d) in the pose's parameters.
struct Twist {
  Vector3d w, d;
};

Twist WeakestTwist(const Problem& problem, const Fit& fit) {
  const MatrixXd information = InformationOf(problem, fit);
  const Matrix3d ww = information.topLeftCorner(3, 3), wd = information.block(0, 3, 3, 3);
  const Matrix3d dd_inverse = Matrix3d(information.block(3, 3, 3, 3)).inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(ww - wd * dd_inverse * wd.transpose());
  const Vector3d w = solver.eigenvectors().col(0);
  return {w, -dd_inverse * wd.transpose() * w};
}

bool LooksTheSameTurned(const Problem& problem, const Fit& fit, const Twist& twist,
                        double tolerance) {
  const Vector3d& t = fit.state.X_AT.translation;
  const Vector3d pivot = t + twist.w.cross(twist.d);
  const double before = LimitedCost(fit.residuals, kCostLimit);
  return std::all_of(std::begin(kTurnsDeg), std::end(kTurnsDeg), [&](double turn_deg) {
    const Matrix3d turn = Eigen::AngleAxisd(DegToRad(turn_deg), twist.w).toRotationMatrix();
    State state = fit.state;
    state.X_AT = {turn * fit.state.X_AT.rotation, pivot + turn * (t - pivot)};
    const double after = LimitedCost(problem.model(state, kCostLimit), kCostLimit);
    return after - before < tolerance * tolerance;
  });
}

void FindSymmetry(const Problem& problem, const Fit& fit, Placement& placement) {
  const Twist twist = WeakestTwist(problem, fit);
  const double tolerance =
      std::max(kSameOutline, kSameOutlineShare * problem.size / placement.pixel_length);
  if (!twist.d.allFinite() || !LooksTheSameTurned(problem, fit, twist, tolerance)) return;
  Eigen::Matrix<double, 6, 1> direction;
  direction << twist.w, twist.d;
  placement.from_outlines += pi * pi / 3.0 * direction * direction.transpose();
  placement.covariance = placement.from_outlines + placement.from_calibration;
  placement.symmetry_axis = placement.X_AT.rotation.transpose() * twist.w;
  const Vector3d& axis = *placement.symmetry_axis;
  placement.remarks.push_back(Format(
      "the outlines are the same however the target is turned about (%.2f, %.2f, %.2f) of T: the "
      "rotation about it is not determined, which its covariance says; picked points alone decide "
      "it",
      axis.x(), axis.y(), axis.z()));
}

bool OneAngle(const std::vector<View>& views, const Placement& placement) {
  std::optional<double> first;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (placement.views[v].used == 0) continue;
    if (!first) first = views[v].angle_deg;
    if (std::abs(std::remainder(views[v].angle_deg - *first, 360.0)) > kDifferentDeg) return false;
  }
  return true;
}

}  // namespace

void ResolveAmbiguity(const Problem& problem, const Fit& fit, const calib::TargetShape& shape,
                      bool picked, Placement& placement) {
  if (const auto* plane = std::get_if<calib::PlaneShape>(&shape)) {
    if (!picked) ChooseTurnOfPlane(*plane, placement);
  } else if (std::holds_alternative<calib::MeshShape>(shape)) {
    FindSymmetry(problem, fit, placement);
  }
}

void AddRemarks(const calib::TargetShape& shape, const std::vector<View>& views,
                const PlacementOptions& options, Placement& placement) {
  std::vector<std::string>& remarks = placement.remarks;
  if (placement.reversed_rms)
    remarks.push_back(Format(
        "with the angles the other way round the outlines fit better, %.2f px rms instead of "
        "%.2f: the table seems to turn against the calibration's sense",
        *placement.reversed_rms, placement.rms));
  if (OneAngle(views, placement)) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(
        Matrix3d(placement.covariance.bottomRightCorner<3, 3>()));
    remarks.push_back(Format(
        "one angle only: how far the target is from the camera rests on its size alone, sigma "
        "%.3g; pictures at other angles tell it by triangulation",
        std::sqrt(std::max(0.0, solver.eigenvalues()[2]))));
  }
  if (options.edge_offset_sigma > 0.0 &&
      std::abs(placement.edge_offset) > kOffsetSurprise * options.edge_offset_sigma)
    remarks.push_back(Format(
        "the outlines lie %.2f px %s what the shape and its place ask for: is the %s right, and "
        "the lens that of these pictures?",
        std::abs(placement.edge_offset), placement.edge_offset > 0.0 ? "outside" : "inside",
        std::holds_alternative<calib::SphereShape>(shape) ? "radius" : "target's size"));
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewFit& view = placement.views[v];
    const double lost = static_cast<double>(view.points - view.used);
    if (view.points > 0 && lost > kManyOutliers * static_cast<double>(view.points))
      remarks.push_back(
          Format("%s: %.0f %% of the outline does not belong to the target and is "
                 "left out: a shadow, a holder, or something before it",
                 views[v].label.c_str(), 100.0 * lost / static_cast<double>(view.points)));
  }
}

}  // namespace turnlight::calib::calibrate::placement
