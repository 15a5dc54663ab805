#include "calib/calibrate/placement/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/statistics.h"
#include "calib/calibrate/placement/calibration_share.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTukey = 4.685;         // 95 % efficient for normal residuals
constexpr double kOutlier = 4.0;         // sigma
constexpr double kSmallestScale = 1e-4;  // of value / sigma; exact outlines have none
// With fewer residuals their own size says too little: the stated sigma is believed, and none is an
// outlier.
constexpr std::size_t kFewResiduals = 40;
constexpr int kApproach = 12;          // steps with Tukey's weights
constexpr double kConverged = 1e-6;    // of a step, in units of its sigma
constexpr double kLongestTurn = 0.25;  // radians of one step
constexpr double kNeighbours = 4.0;    // pixels between points of one piece of an outline
constexpr int kMostLags = 100;         // points along an outline
// A step is held back as if it were known to be 0 with this sigma: a direction that nothing
// determines does not wander, and one that is determined does not notice.
constexpr double kStepTurn = 0.5;  // radians

std::vector<int> FreeParameters(const Problem& problem) {
  std::vector<int> free;
  for (int i = 0; i < kParameters; ++i)
    if (problem.free[static_cast<std::size_t>(i)]) free.push_back(i);
  return free;
}

std::vector<calib::Pose> TablePoses(const Problem& problem) {
  std::vector<calib::Pose> poses;
  for (const View& view : problem.views)
    poses.push_back(PoseOfTableInCamera(problem.calibration.geometry, view.angle_deg));
  return poses;
}

std::size_t CountValid(const std::vector<Residual>& residuals) {
  return static_cast<std::size_t>(
      std::count_if(residuals.begin(), residuals.end(), [](const Residual& r) { return r.valid; }));
}

// From the median, so that up to half may be outliers; of few, from all.
double ScaleOf(const std::vector<Residual>& residuals, std::size_t parameters) {
  std::vector<double> sizes;
  double sum = 0.0;
  for (const Residual& residual : residuals) {
    if (!residual.valid) continue;
    sizes.push_back(std::abs(residual.value) / residual.sigma);
    sum += sizes.back() * sizes.back();
  }
  const std::size_t count = sizes.size();
  if (count < kFewResiduals)
    return std::max(
        1.0, count > parameters ? std::sqrt(sum / static_cast<double>(count - parameters)) : 1.0);
  return std::max(kSmallestScale, Median(sizes) / kMedianOfNormal);
}

// Of the residuals used, which is what the covariance rests on. Beyond 4 sigma nothing is used, so
// the rms is 0.1 % small.
double ScaleOfUsed(const Fit& fit, std::size_t parameters) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const double size = fit.residuals[i].value / fit.residuals[i].sigma;
    sum += size * size;
    ++count;
  }
  if (count <= parameters) return 1.0;
  const double scale = std::sqrt(sum / static_cast<double>(count - parameters));
  return std::max(count < kFewResiduals ? 1.0 : kSmallestScale, scale);
}

// The variance of a sum of neighbouring residuals over that of independent ones: 1 + 2 * the sum of
// the autocorrelations, up to the first that is within its noise of 0. Shifts of whole views do not
// count here: they are told apart below.
double CorrelationAlong(const Fit& fit, const std::vector<Vector2d>& shifts) {
  std::vector<int> piece(fit.residuals.size(), 0);
  VectorXd size = VectorXd::Zero(static_cast<Eigen::Index>(fit.residuals.size()));
  double variance = 0.0, count = 0.0;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Residual& residual = fit.residuals[i];
    if (i > 0) {
      const Residual& last = fit.residuals[i - 1];
      const bool near = residual.view == last.view && residual.edge &&
                        (residual.pixel - last.pixel).norm() < kNeighbours;
      piece[i] = piece[i - 1] + (near ? 0 : 1);
    }
    if (!fit.used[i]) continue;
    const double value = residual.value - residual.normal.dot(shifts[residual.view]);
    size[static_cast<Eigen::Index>(i)] = value / residual.sigma;
    variance += value * value / (residual.sigma * residual.sigma);
    ++count;
  }
  double factor = 1.0;
  if (!(variance > 0.0)) return factor;
  for (int lag = 1; lag <= kMostLags; ++lag) {
    double sum = 0.0, pairs = 0.0;
    for (std::size_t i = static_cast<std::size_t>(lag); i < piece.size(); ++i) {
      const std::size_t j = i - static_cast<std::size_t>(lag);
      if (piece[i] != piece[j] || !fit.used[i] || !fit.used[j]) continue;
      sum += size[static_cast<Eigen::Index>(i)] * size[static_cast<Eigen::Index>(j)];
      ++pairs;
    }
    if (pairs < 1.0) break;
    const double correlation = sum / pairs / (variance / count);
    if (correlation < 2.0 / std::sqrt(pairs)) break;
    factor += 2.0 * correlation;
  }
  return factor;
}

// The shift of each view that its residuals ask for, and what one pixel of it weighs.
struct Shifts {
  std::vector<Vector2d> shift;
  std::vector<Matrix2d> information;  // of unit sigma
};

Shifts ShiftsOf(const Fit& fit, std::size_t views) {
  Shifts shifts{std::vector<Vector2d>(views, Vector2d::Zero()),
                std::vector<Matrix2d>(views, Matrix2d::Zero())};
  std::vector<Vector2d> sums(views, Vector2d::Zero());
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const Residual& r = fit.residuals[i];
    const double weight = 1.0 / (r.sigma * r.sigma);
    shifts.information[r.view] += weight * r.normal * r.normal.transpose();
    sums[r.view] += weight * r.value * r.normal;
  }
  for (std::size_t v = 0; v < views; ++v)
    if (shifts.information[v].determinant() > 1e-6 * shifts.information[v].squaredNorm())
      shifts.shift[v] = shifts.information[v].ldlt().solve(sums[v]);
    else
      shifts.information[v].setZero();
  return shifts;
}

double RmsOf(const Fit& fit) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i)
    if (fit.used[i]) {
      sum += fit.residuals[i].value * fit.residuals[i].value;
      ++count;
    }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

// Of one step: which residuals count how much.
VectorXd Weigh(const std::vector<Residual>& residuals, double scale, bool approach) {
  VectorXd weights = VectorXd::Zero(static_cast<Eigen::Index>(residuals.size()));
  const bool few = CountValid(residuals) < kFewResiduals;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!residuals[i].valid) continue;
    const double size = std::abs(residuals[i].value) / (residuals[i].sigma * scale);
    double weight = size < kOutlier ? 1.0 : 0.0;
    if (approach) {
      const double share = size / kTukey;
      weight = share < 1.0 ? (1.0 - share * share) * (1.0 - share * share) : 0.0;
    }
    weights[static_cast<Eigen::Index>(i)] = few ? 1.0 : weight;
  }
  return weights;
}

struct Normal {
  MatrixXd information = MatrixXd::Zero(kParameters, kParameters);
  VectorXd gradient = VectorXd::Zero(kParameters);
};

Normal NormalEquations(const std::vector<calib::Pose>& X_CA, const std::vector<Residual>& residuals,
                       const VectorXd& weights, const State& state, double scale) {
  Normal normal;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const double weight = weights[static_cast<Eigen::Index>(i)];
    if (!(weight > 0.0)) continue;
    const Residual& residual = residuals[i];
    const Row row = ParameterRow(residual, state, X_CA[residual.view]);
    const double w = weight / (residual.sigma * residual.sigma * scale * scale);
    normal.information += w * row.transpose() * row;
    normal.gradient += w * row.transpose() * residual.value;
  }
  return normal;
}

MatrixXd Restricted(const MatrixXd& matrix, const std::vector<int>& free) {
  MatrixXd small(free.size(), free.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    for (std::size_t j = 0; j < free.size(); ++j)
      small(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = matrix(free[i], free[j]);
  return small;
}

MatrixXd Widened(const MatrixXd& small, const std::vector<int>& free) {
  MatrixXd matrix = MatrixXd::Zero(kParameters, kParameters);
  for (std::size_t i = 0; i < free.size(); ++i)
    for (std::size_t j = 0; j < free.size(); ++j)
      matrix(free[i], free[j]) = small(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return matrix;
}

void AddPrior(const Problem& problem, const State& state, Normal& normal) {
  if (!problem.free[kEdgeOffset]) return;
  const double weight = 1.0 / (problem.edge_offset_sigma * problem.edge_offset_sigma);
  normal.information(kEdgeOffset, kEdgeOffset) += weight;
  normal.gradient[kEdgeOffset] += weight * state.edge_offset;
}

// The step of all parameters; NaN where nothing is determined.
VectorXd StepOf(const Problem& problem, const Normal& normal) {
  const std::vector<int> free = FreeParameters(problem);
  MatrixXd held = normal.information;
  for (int i = 0; i < 3; ++i) {
    held(i, i) += 1.0 / (kStepTurn * kStepTurn);
    held(3 + i, 3 + i) += 1.0 / (problem.size * problem.size);
  }
  held(kRadius, kRadius) += 1.0 / (problem.size * problem.size);
  VectorXd gradient(free.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    gradient[static_cast<Eigen::Index>(i)] = normal.gradient[free[i]];
  const VectorXd small = -Restricted(held, free).ldlt().solve(gradient);
  VectorXd step = VectorXd::Zero(kParameters);
  for (std::size_t i = 0; i < free.size(); ++i) step[free[i]] = small[static_cast<Eigen::Index>(i)];
  const double too_long =
      std::max({1.0, step.segment<3>(0).norm() / kLongestTurn,
                step.segment<3>(3).norm() / problem.size, std::abs(step[kRadius]) / problem.size});
  return step / too_long;
}

void Apply(const VectorXd& step, State& state) {
  state.X_AT = Moved(state.X_AT, step.segment<3>(0), step.segment<3>(3));
  state.radius += step[kRadius];
  state.edge_offset += step[kEdgeOffset];
}

}  // namespace

double CorrelationOf(const Fit& fit, std::size_t views) {
  return CorrelationAlong(fit, ShiftsOf(fit, views).shift);
}

calib::Pose Moved(const calib::Pose& pose, const Vector3d& w, const Vector3d& d) {
  const double angle = w.norm();
  calib::Pose moved{pose.rotation, pose.translation + d};
  if (angle > 0.0)
    moved.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle) * pose.rotation)
                         .normalized()
                         .toRotationMatrix();
  return moved;
}

double LimitedCost(const std::vector<Residual>& residuals, double limit) {
  double sum = 0.0;
  for (const Residual& r : residuals)
    sum += r.valid ? std::min(r.value * r.value, limit * limit) : limit * limit;
  return residuals.empty() ? limit * limit : sum / static_cast<double>(residuals.size());
}

Fit Solve(const Problem& problem, State start, double reach, int most_steps) {
  const std::vector<calib::Pose> X_CA = TablePoses(problem);
  const std::size_t parameters = FreeParameters(problem).size();
  Fit fit;
  fit.state = std::move(start);
  VectorXd weights;
  double spread = 1.0;  // of the noise of a mean: what the edge offset's prior is weighed against
  for (;; ++fit.steps) {
    fit.residuals = problem.model(fit.state, reach);
    const bool approach = fit.steps < kApproach && fit.steps + 1 < most_steps;
    fit.scale = ScaleOf(fit.residuals, parameters);
    weights = Weigh(fit.residuals, fit.scale, approach);
    fit.used.assign(fit.residuals.size(), false);
    for (std::size_t i = 0; i < fit.used.size(); ++i)
      fit.used[i] = weights[static_cast<Eigen::Index>(i)] > 0.0;
    if (fit.steps == most_steps || fit.converged) break;
    if (!approach) {
      fit.scale = ScaleOfUsed(fit, parameters);
      const Shifts shifts = ShiftsOf(fit, problem.views.size());
      fit.correlation = CorrelationAlong(fit, shifts.shift);
      spread = std::sqrt(fit.correlation);
    }
    Normal normal = NormalEquations(X_CA, fit.residuals, weights, fit.state, fit.scale * spread);
    AddPrior(problem, fit.state, normal);
    const VectorXd step = StepOf(problem, normal);
    if (!step.allFinite()) break;
    Apply(step, fit.state);
    fit.converged = !approach && step.dot(normal.information * step) < kConverged * kConverged;
  }
  fit.scale = ScaleOfUsed(fit, parameters);
  fit.rms = RmsOf(fit);
  return fit;
}

MatrixXd InformationOf(const Problem& problem, const Fit& fit) {
  VectorXd weights = VectorXd::Zero(static_cast<Eigen::Index>(fit.used.size()));
  for (std::size_t i = 0; i < fit.used.size(); ++i)
    weights[static_cast<Eigen::Index>(i)] = fit.used[i] ? 1.0 : 0.0;
  return NormalEquations(TablePoses(problem), fit.residuals, weights, fit.state,
                         fit.scale * std::sqrt(fit.correlation))
      .information;
}

namespace {

// Variance per axis of shifts of whole views beyond what the noise explains, in pixels squared; 0
// if it is within chance.
double ShiftVariance(const Fit& fit, const Shifts& shifts, std::size_t parameters) {
  const double noise = fit.scale * fit.scale * fit.correlation;
  double chi2 = 0.0, count = 0.0, squares = 0.0, expected = 0.0;
  for (std::size_t v = 0; v < shifts.shift.size(); ++v) {
    if (!(shifts.information[v].trace() > 0.0)) continue;
    chi2 += shifts.shift[v].dot(shifts.information[v] * shifts.shift[v]) / noise;
    squares += shifts.shift[v].squaredNorm();
    expected += noise * shifts.information[v].inverse().trace();
    count += 2.0;
  }
  const double freedom = count - static_cast<double>(parameters);
  if (freedom < 2.0 || chi2 < freedom + 3.0 * std::sqrt(2.0 * freedom)) return 0.0;
  return std::max(0.0, (squares - expected) / count) * count / freedom;
}

std::vector<ViewFit> ViewFits(const Fit& fit, const Shifts& shifts) {
  std::vector<ViewFit> views(shifts.shift.size());
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    ViewFit& view = views[fit.residuals[i].view];
    ++view.points;
    if (!fit.used[i]) continue;
    ++view.used;
    view.rms += fit.residuals[i].value * fit.residuals[i].value;
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].used > 0)
      views[v].rms = std::sqrt(views[v].rms / static_cast<double>(views[v].used));
    views[v].shift = shifts.shift[v];
  }
  return views;
}

// What shifts of pictures do to the gradient: each view's own, of the given variance, and one that
// all share.
MatrixXd GradientOfShifts(const Problem& problem, const Fit& fit, double variance) {
  const std::vector<calib::Pose> X_CA = TablePoses(problem);
  const double noise = fit.scale * fit.scale * fit.correlation;
  using Sum = Eigen::Matrix<double, kParameters, 2>;
  std::vector<Sum> by_shift(problem.views.size(), Sum::Zero());
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const Residual& r = fit.residuals[i];
    by_shift[r.view] += ParameterRow(r, fit.state, X_CA[r.view]).transpose() *
                        r.normal.transpose() / (noise * r.sigma * r.sigma);
  }
  MatrixXd sum = MatrixXd::Zero(kParameters, kParameters);
  Sum common = Sum::Zero();
  for (const Sum& one : by_shift) {
    sum += variance * one * one.transpose();
    common += one;
  }
  const double shared = problem.common_shift_sigma * problem.common_shift_sigma;
  return sum + shared * common * common.transpose();
}

}  // namespace

FitCovariance CovarianceOf(const Problem& problem, const Fit& fit) {
  const std::vector<int> free = FreeParameters(problem);
  Normal normal{InformationOf(problem, fit)};
  AddPrior(problem, fit.state, normal);
  const MatrixXd inverse = Widened(Restricted(normal.information, free).inverse(), free);
  const Shifts shifts = ShiftsOf(fit, problem.views.size());
  const double variance = ShiftVariance(fit, shifts, free.size());
  const CalibrationShare share = ShareOfCalibration(problem, fit, inverse);
  FitCovariance covariance;
  covariance.from_outlines = inverse + inverse * GradientOfShifts(problem, fit, variance) * inverse;
  covariance.with_calibration = share.transfer * share.covariance;
  covariance.from_calibration = covariance.with_calibration * share.transfer.transpose();
  covariance.calibration = {share.of, share.covariance};
  covariance.wobble = std::sqrt(variance);
  covariance.views = ViewFits(fit, shifts);
  return covariance;
}

}  // namespace turnlight::calib::calibrate::placement
