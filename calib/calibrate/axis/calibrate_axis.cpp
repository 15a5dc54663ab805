#include "calib/calibrate/axis/calibrate_axis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "calib/calibrate/axis/axis_fit.h"
#include "calib/calibrate/axis/rig_frame.h"

namespace turnlight::calib::calibrate::axis {
namespace {

// Beyond these an axis is of no use.
constexpr double kWorstDirectionDeg = 1.0;
constexpr double kWorstOffset = 0.01;     // of the camera's distance
constexpr double kWorstTurnDeg = 5.0;     // a turn, by the scale
constexpr double kWorstCornersPx = 10.0;  // no detector and no lens is so bad
constexpr double kSingular = 1e-13;       // smallest eigenvalue, the diagonal being 1
constexpr double kWholeTurnDeg = 1.0;     // how near to whole turns views are that are compared
constexpr double kSmallArcDeg = 90.0;

using Covariance = Eigen::Matrix<double, kParameters, kParameters>;

struct StepCovariance {
  Covariance covariance = Covariance::Zero();  // with the intrinsics' share
  Eigen::MatrixXd with_intrinsics;             // kParameters x N; empty
};

// The inverse, by way of a unit diagonal; nothing if it is singular.
std::optional<Eigen::MatrixXd> InverseOf(const Eigen::MatrixXd& normal) {
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  if (!scaled.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  if (eigen.eigenvalues()[0] < kSingular) return std::nullopt;
  return scale.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

// Of the corners and angles, then of the intrinsics: the fit takes them for true, so that it moves
// by the solution's derivative where they move.
std::optional<StepCovariance> CovarianceOf(const AxisFit& fit, const CameraModel& camera,
                                           const AxisOptions& options) {
  const NoiseEstimate& noise = fit.noise;
  // The variance of the angles is known from few of them: its mean, as of Student's t.
  const double freedom = noise.angle_freedom;
  const double ratio = std::pow(noise.angle / noise.corner, 2) * freedom / (freedom - 2.0);
  const auto inverse = InverseOf(MarginalNormal(fit.sums, ratio));
  if (!inverse) return std::nullopt;
  StepCovariance known;
  known.covariance.topLeftCorner(fit.columns, fit.columns) = noise.corner * noise.corner * *inverse;
  if (!options.intrinsics_covariance) return known;
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(fit.columns, options.intrinsics_covariance->rows());
  std::size_t used = 0;
  for (const FitView& view : fit.views) {
    if (!view.used) continue;
    const ViewSums& sums = fit.sums[used++];
    const ViewLinearization linear = Linearize(fit.state, camera, view.kept, view.deviation);
    const Eigen::MatrixXd by_lens = ByIntrinsics(fit.state, camera, view.kept, view.deviation);
    moved += linear.by_step.leftCols(fit.columns).transpose() * by_lens -
             DeviationShare(sums, ratio) * sums.xz * (linear.by_deviation.transpose() * by_lens);
  }
  Eigen::MatrixXd by_intrinsics = Eigen::MatrixXd::Zero(kParameters, moved.cols());
  by_intrinsics.topRows(fit.columns) = -*inverse * moved;
  known.with_intrinsics = by_intrinsics * *options.intrinsics_covariance;
  known.covariance += known.with_intrinsics * by_intrinsics.transpose();
  return known;
}

double LargerSigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()[1]);
}

void SetAxis(const AxisFit& fit, const FrameChoice& choice, const Covariance& covariance,
             AxisCalibration& result) {
  const Pose X_CW = result.X_WC.Inverse();
  const double side = choice.along_u ? 1.0 : -1.0;
  result.direction_C = side * fit.state.u;
  result.origin_C = X_CW.translation;
  const Eigen::Matrix2d across = X_CW.rotation.leftCols<2>().transpose() * AcrossAxis(fit.state.u);
  const double along = (result.origin_C - fit.state.a).dot(fit.state.u);
  Eigen::Matrix<double, 4, kParameters> by = Eigen::Matrix<double, 4, kParameters>::Zero();
  by.block<2, 2>(0, kDirection) = side * across;
  by.block<2, 2>(2, kDirection) = along * across;
  by.block<2, 2>(2, kPoint) = across;
  result.axis_covariance = by * covariance * by.transpose();
  result.direction_sigma_deg = RadToDeg(LargerSigma(result.axis_covariance.topLeftCorner<2, 2>()));
  result.offset_sigma = LargerSigma(result.axis_covariance.bottomRightCorner<2, 2>());
  result.scale_sigma = std::sqrt(covariance(kScale, kScale));
}

void SetRig(const AxisFit& fit, const FrameChoice& choice, const StepCovariance& known,
            const AxisOptions& options, AxisCalibration& result) {
  const auto by = ByStep(fit.state, choice);
  Eigen::MatrixXd covariance = by * known.covariance * by.transpose();
  result.covariance = 0.5 * (covariance + covariance.transpose());
  if (!options.intrinsics_covariance) return;
  const Eigen::MatrixXd cross = by * known.with_intrinsics;
  const Eigen::Index count = cross.cols();
  Eigen::MatrixXd joint(count + kRigParameters, count + kRigParameters);
  joint << *options.intrinsics_covariance, cross.transpose(), cross, result.covariance;
  result.joint_covariance = std::move(joint);
}

void SetViews(const AxisFit& fit, const CameraModel& camera, double side, AxisCalibration& result) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < fit.views.size(); ++i) {
    const FitView& view = fit.views[i];
    FittedView& out = result.views.emplace_back();
    out.view = i;
    out.used = view.used;
    out.why_not = view.used ? "" : view.why_not;
    out.numbering = view.numbering;
    out.points = view.all.points.size();
    if (!view.used) continue;
    ++result.used;
    out.outliers = view.all.points.size() - view.kept.points.size();
    double sum = 0.0;
    for (const Eigen::Vector2d& residual : Residuals(fit.state, camera, view.kept, view.deviation))
      sum += residual.squaredNorm();
    out.rms_px = std::sqrt(sum / (2.0 * static_cast<double>(view.kept.points.size())));
    out.deviation_deg = side * RadToDeg(view.free_deviation);
    out.deviation_sigma_deg = RadToDeg(view.free_sigma);
    out.X_CB = BoardPose(fit.state, view.all, view.free_deviation);
    for (const ModelPoint& point : view.kept.points) {
      squares += (out.X_CB * point.p_B - fit.state.a).cross(fit.state.u).squaredNorm();
      count += 1.0;
    }
  }
  result.board_radius = std::sqrt(squares / count);
}

// In the plane of the board of view a: the mean way from the points of a to those of b.
double ShiftBetween(const FitView& a, const FitView& b, const CameraModel& camera,
                    const Pose& X_CB) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  const Pose X_BC = X_CB.Inverse();
  for (const ModelPoint& from : a.kept.points)
    for (const ModelPoint& to : b.kept.points) {
      if ((from.p_B - to.p_B).norm() > 1e-6 * X_CB.translation.norm()) continue;
      const auto rays = camera.Unproject({from.pixel, to.pixel});
      Eigen::Vector2d hits[2];
      for (int i = 0; i < 2; ++i) {
        const Eigen::Vector3d ray = X_BC.rotation * rays[static_cast<std::size_t>(i)];
        hits[i] = (X_BC.translation - X_BC.translation.z() / ray.z() * ray).head<2>();
      }
      if (!hits[0].allFinite() || !hits[1].allFinite()) continue;
      sum += hits[1] - hits[0];
      count += 1.0;
    }
  return count > 0.0 ? sum.norm() / count : 0.0;
}

void SetClosures(const AxisFit& fit, const CameraModel& camera, double side,
                 AxisCalibration& result) {
  const auto begin = std::find_if(fit.views.begin(), fit.views.end(),
                                  [](const FitView& view) { return view.used; });
  const FitView& first = *begin;
  const auto turned = [&fit](const FitView& view) {
    return 0.5 * fit.state.scale * view.all.approach * fit.state.backlash + view.free_deviation;
  };
  for (auto view = begin + 1; view < fit.views.end(); ++view) {
    const double turns = std::round(RadToDeg(view->all.angle - first.all.angle) / 360.0);
    const double off_deg = RadToDeg(view->all.angle - first.all.angle) - 360.0 * turns;
    if (!view->used || turns == 0.0 || std::abs(off_deg) > kWholeTurnDeg) continue;
    const double whole = 360.0 * turns * (fit.state.scale < 0.0 ? -1.0 : 1.0);
    Closure closure;
    closure.first = static_cast<std::size_t>(begin - fit.views.begin());
    closure.last = static_cast<std::size_t>(view - fit.views.begin());
    closure.turns = turns;
    closure.turned_deg =
        side * (fit.state.scale * 360.0 * turns - whole + RadToDeg(turned(*view) - turned(first)));
    closure.turned_sigma_deg = RadToDeg(std::hypot(first.free_sigma, view->free_sigma));
    closure.shift = ShiftBetween(first, *view, camera, result.views[closure.first].X_CB);
    result.closures.push_back(closure);
  }
}

double ArcOf(const AxisFit& fit) {
  std::vector<double> angles;
  for (const FitView& view : fit.views)
    if (view.used)
      angles.push_back(RadToDeg(view.all.angle) -
                       360.0 * std::floor(RadToDeg(view.all.angle) / 360.0));
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 360.0 - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return 360.0 - gap;
}

// The reasons for a large sigma that can be seen without it.
std::string Reasons(const AxisCalibration& result, double distance) {
  std::vector<std::string> reasons;
  if (result.arc_deg < kSmallArcDeg)
    reasons.push_back("the views span " + NumberText(result.arc_deg, 3) +
                      " degrees of a turn: take them all around, or as far as the board is seen");
  if (result.board_radius < 0.02 * distance)
    reasons.push_back("the board's points are within " + NumberText(result.board_radius, 3) +
                      " of the axis: take a larger board, or put it farther out");
  if (result.corner_sigma_px > 1.0)
    reasons.push_back("the corners are " + NumberText(result.corner_sigma_px, 2) +
                      " px off: is it this lens and this board, did anything move?");
  if (reasons.empty()) reasons.push_back("take more views, all around, of a larger board");
  return reasons.size() == 1 ? reasons[0] : reasons[0] + "; " + reasons[1];
}

Status CheckDetermined(const AxisCalibration& result) {
  const double distance = result.origin_C.norm();
  const double turn_sigma_deg = 360.0 * result.scale_sigma;
  if (result.corner_sigma_px > kWorstCornersPx)
    return NoEstimateError(
        "the views do not show one board that turns about one axis by the angles that the table "
        "reports: at best the corners are " +
        NumberText(result.corner_sigma_px, 2) + " px off, allowed are " +
        NumberText(kWorstCornersPx) +
        ". Did the board or the camera move, are the pictures in the order of their angles, is it "
        "this board and this lens?");
  if (result.direction_sigma_deg <= kWorstDirectionDeg &&
      result.offset_sigma <= kWorstOffset * distance && turn_sigma_deg <= kWorstTurnDeg)
    return {};
  return NoEstimateError(
      Format("the views do not determine the axis: sigma of its direction %.2g degrees (allowed "
             "is %.2g), of where it is %.2g (%.2g), of a turn by the scale %.2g degrees (%.2g); ",
             result.direction_sigma_deg, kWorstDirectionDeg, result.offset_sigma,
             kWorstOffset * distance, turn_sigma_deg, kWorstTurnDeg) +
      Reasons(result, distance));
}

}  // namespace

std::string ViewLabel(std::size_t view, double angle_deg) {
  return "view " + std::to_string(view) + " (" + NumberText(angle_deg, 6) + " deg)";
}

Result<AxisCalibration> CalibrateAxis(const board::Board& board, const CameraModel& camera,
                                      const std::vector<AxisView>& views,
                                      const AxisOptions& options) {
  const auto intrinsics = static_cast<Eigen::Index>(camera.intrinsics().size());
  if (options.intrinsics_covariance && (options.intrinsics_covariance->rows() != intrinsics ||
                                        options.intrinsics_covariance->cols() != intrinsics))
    return InputError("the covariance of the intrinsics is " +
                      std::to_string(options.intrinsics_covariance->rows()) + " x " +
                      std::to_string(options.intrinsics_covariance->cols()) +
                      ", allowed is the camera model's, " + std::to_string(intrinsics) + " x " +
                      std::to_string(intrinsics));
  const auto fit = FitAxis(board, camera, views);
  if (!fit) return Forward(fit);
  const auto known = CovarianceOf(*fit, camera, options);
  if (!known)
    return NoEstimateError(
        "the views do not determine the axis: the board looks the same wherever the axis is");
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const auto points = BoardPoints(board);
  for (const Eigen::Vector3d& point : points) middle += point / static_cast<double>(points.size());
  const FrameChoice choice = ChooseFrame(fit->state, middle, options.origin_height);
  const double side = choice.along_u ? 1.0 : -1.0;
  AxisCalibration result;
  result.X_WC = FrameOf(fit->state, choice);
  result.angle_scale = ScaleIn(fit->state, choice);
  result.board_lies = choice.board_lies;
  result.corner_sigma_px = fit->noise.corner;
  result.angle_sigma_deg = RadToDeg(fit->noise.angle);
  SetRig(*fit, choice, *known, options, result);
  SetAxis(*fit, choice, known->covariance, result);
  SetViews(*fit, camera, side, result);
  SetClosures(*fit, camera, side, result);
  result.arc_deg = ArcOf(*fit);
  ModelView at_zero;
  at_zero.angle = -DegToRad(fit->angle_ref_deg);
  result.X_WB = result.X_WC * BoardPose(fit->state, at_zero, 0.0);
  if (fit->fits_backlash)
    result.backlash = Backlash{RadToDeg(fit->state.backlash),
                               RadToDeg(std::sqrt(known->covariance(kBacklash, kBacklash)))};
  if (const Status status = CheckDetermined(result); !status) return Forward(status);
  return result;
}

}  // namespace turnlight::calib::calibrate::axis
