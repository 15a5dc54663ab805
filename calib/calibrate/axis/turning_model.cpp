#include "calib/calibrate/axis/turning_model.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace turnlight::calib::calibrate::axis {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Jet = ceres::Jet<double, kParameters + 1>;
template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

// Of differences of projections, relative to a point's distance and to an intrinsic. Their errors
// are about the square of it, and rounding divided by it.
constexpr double kRelativeStep = 1e-5;

template <typename T>
Matrix3<T> RotationOf(const Vector3<T>& w) {
  Matrix3<T> r;
  ceres::AngleAxisToRotationMatrix(w.data(), r.data());  // both are column by column
  return r;
}

// The pose of the board in a view: r and t of p_C = r p_B + t.
template <typename T>
void PlaceBoard(const TurningState& state, const ModelView& view, const T* step, const T& deviation,
                Matrix3<T>& r, Vector3<T>& t) {
  const Eigen::Matrix<double, 3, 2> across = AcrossAxis(state.u);
  const auto by = [&across](const Vector3d& from, const T* coordinates) {
    return (from.cast<T>() + across.col(0).cast<T>() * coordinates[0] +
            across.col(1).cast<T>() * coordinates[1])
        .eval();
  };
  const Vector3<T> u = by(state.u, step + kDirection).normalized();
  const Vector3<T> a = by(state.a, step + kPoint);
  const Eigen::Map<const Vector3<T>> w(step + kBoardTurn), d(step + kBoardShift);
  const T scale = state.scale + step[kScale];
  const T backlash = state.backlash + step[kBacklash];
  const T theta = scale * (view.angle + (0.5 * view.approach) * backlash) + deviation;
  const Matrix3<T> turn = RotationOf<T>(u * theta);
  r = turn * (RotationOf<T>(w) * state.X_CB.rotation.cast<T>());
  t = a + turn * (state.X_CB.translation.cast<T>() + d - a);
}

// Image points and their derivatives by position; false if a point is not seen.
bool ProjectWithDerivatives(const CameraModel& camera, const std::vector<Vector3d>& p_C,
                            std::vector<Vector2d>& pixels,
                            std::vector<Eigen::Matrix<double, 2, 3>>& derivatives) {
  std::vector<Vector3d> moved;
  moved.reserve(7 * p_C.size());
  for (const Vector3d& p : p_C) {
    moved.push_back(p);
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0})
        moved.push_back(p + sign * kRelativeStep * p.norm() * Vector3d::Unit(axis));
  }
  const auto seen = camera.Project(moved);
  pixels.clear();
  derivatives.clear();
  for (std::size_t i = 0; i < p_C.size(); ++i) {
    const Vector2d* at = &seen[7 * i];
    Eigen::Matrix<double, 2, 3> derivative;
    for (int axis = 0; axis < 3; ++axis)
      derivative.col(axis) =
          (at[1 + 2 * axis] - at[2 + 2 * axis]) / (2.0 * kRelativeStep * p_C[i].norm());
    if (!at->allFinite() || !derivative.allFinite()) return false;
    pixels.push_back(*at);
    derivatives.push_back(derivative);
  }
  return true;
}

class ViewCost final : public ceres::CostFunction {
 public:
  ViewCost(const TurningState& state, const CameraModel& camera, const ModelView& view)
      : state_(state), camera_(camera), view_(view) {
    set_num_residuals(static_cast<int>(2 * view.points.size()));
    mutable_parameter_block_sizes()->push_back(kParameters);
    mutable_parameter_block_sizes()->push_back(1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    std::array<Jet, kParameters> step;
    for (int i = 0; i < kParameters; ++i)
      step[static_cast<std::size_t>(i)] = Jet(parameters[0][i], i);
    Matrix3<Jet> r;
    Vector3<Jet> t;
    PlaceBoard<Jet>(state_, view_, step.data(), Jet(parameters[1][0], kParameters), r, t);
    std::vector<Vector3<Jet>> p_C;
    std::vector<Vector3d> values;
    for (const ModelPoint& point : view_.points) {
      p_C.push_back(r * point.p_B.cast<Jet>() + t);
      values.emplace_back(p_C.back()[0].a, p_C.back()[1].a, p_C.back()[2].a);
    }
    std::vector<Vector2d> pixels;
    std::vector<Eigen::Matrix<double, 2, 3>> derivatives;
    if (!ProjectWithDerivatives(camera_, values, pixels, derivatives)) return false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double weight = 1.0 / view_.points[i].spread;
      Eigen::Map<Vector2d>(residuals + 2 * i) = weight * (view_.points[i].pixel - pixels[i]);
      if (jacobians == nullptr) continue;
      Eigen::Matrix<double, 3, kParameters + 1> by;
      for (int axis = 0; axis < 3; ++axis) by.row(axis) = p_C[i][axis].v.transpose();
      const Eigen::Matrix<double, 2, kParameters + 1> rows = -weight * (derivatives[i] * by);
      for (int row = 0; row < 2; ++row) {
        const auto at = static_cast<Eigen::Index>(2 * i) + row;
        if (jacobians[0] != nullptr)
          Eigen::Map<Eigen::RowVectorXd>(jacobians[0] + at * kParameters, kParameters) =
              rows.row(row).head<kParameters>();
        if (jacobians[1] != nullptr) jacobians[1][at] = rows(row, kParameters);
      }
    }
    return true;
  }

 private:
  const TurningState& state_;
  const CameraModel& camera_;
  const ModelView& view_;
};

struct DeviationPrior {
  template <typename T>
  bool operator()(const T* deviation, T* residual) const {
    residual[0] = deviation[0] / width;
    return true;
  }
  double width;
};

// A view without a prior for its angle moves freely; Ceres wants some hold.
constexpr double kFreeAngle = 1e3;  // radians

Eigen::Matrix<double, Eigen::Dynamic, kParameters, Eigen::RowMajor> Rows(std::size_t points) {
  return {static_cast<Eigen::Index>(2 * points), kParameters};
}

}  // namespace

Eigen::Matrix<double, 3, 2> AcrossAxis(const Vector3d& u) {
  const Vector3d helper = std::abs(u.z()) > 0.7 ? Vector3d::UnitX() : Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = (helper - helper.dot(u) * u).normalized();
  basis.col(1) = u.cross(basis.col(0));
  return basis;
}

TurningState Stepped(const TurningState& state, const Step& step) {
  const Eigen::Matrix<double, 3, 2> across = AcrossAxis(state.u);
  TurningState next = state;
  next.u = (state.u + across * step.segment<2>(kDirection)).normalized();
  next.a = state.a + across * step.segment<2>(kPoint);
  next.X_CB.rotation = RotationOf<double>(step.segment<3>(kBoardTurn)) * state.X_CB.rotation;
  next.X_CB.translation = state.X_CB.translation + step.segment<3>(kBoardShift);
  next.scale = state.scale + step[kScale];
  next.backlash = state.backlash + step[kBacklash];
  return next;
}

Pose BoardPose(const TurningState& state, const ModelView& view, double deviation) {
  const Step none = Step::Zero();
  Pose X_CB;
  PlaceBoard<double>(state, view, none.data(), deviation, X_CB.rotation, X_CB.translation);
  return X_CB;
}

std::vector<Vector2d> Residuals(const TurningState& state, const CameraModel& camera,
                                const ModelView& view, double deviation) {
  const Pose X_CB = BoardPose(state, view, deviation);
  std::vector<Vector3d> p_C;
  for (const ModelPoint& point : view.points) p_C.push_back(X_CB * point.p_B);
  std::vector<Vector2d> residuals = camera.Project(p_C);
  for (std::size_t i = 0; i < residuals.size(); ++i)
    residuals[i] = view.points[i].pixel - residuals[i];
  return residuals;
}

Status FitTurning(const CameraModel& camera, const std::vector<ModelView>& views,
                  double angle_noise, bool fits_backlash, TurningState& state) {
  const TurningState from = state;
  Step step = Step::Zero();
  ceres::Problem problem;
  problem.AddParameterBlock(step.data(), kParameters);
  if (!fits_backlash)
    problem.SetManifold(step.data(), new ceres::SubsetManifold(kParameters, {kBacklash}));
  for (std::size_t i = 0; i < views.size(); ++i) {
    problem.AddResidualBlock(new ViewCost(from, camera, views[i]), nullptr, step.data(),
                             &state.deviations[i]);
    const double width = views[i].free_angle ? kFreeAngle : angle_noise;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<DeviationPrior, 1, 1>(new DeviationPrior{width}), nullptr,
        &state.deviations[i]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;  // the same bits for any number of threads
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  // A little damping stays, so that the matrices of hopeless candidates can be factored.
  options.max_trust_region_radius = 1e8;
  options.logging_type = ceres::SILENT;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double& deviation : state.deviations)
    options.linear_solver_ordering->AddElementToGroup(&deviation, 0);
  options.linear_solver_ordering->AddElementToGroup(step.data(), 1);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !step.allFinite())
    return NoEstimateError("the fit of the axis found no minimum: " + summary.message);
  const std::vector<double> deviations = state.deviations;
  state = Stepped(from, step);
  state.deviations = deviations;
  return {};
}

ViewLinearization Linearize(const TurningState& state, const CameraModel& camera,
                            const ModelView& view, double deviation) {
  const ViewCost cost(state, camera, view);
  const Step none = Step::Zero();
  auto rows = Rows(view.points.size());
  ViewLinearization linear{Eigen::VectorXd(rows.rows()), {}, Eigen::VectorXd(rows.rows())};
  const double* const parameters[] = {none.data(), &deviation};
  double* jacobians[] = {rows.data(), linear.by_deviation.data()};
  if (!cost.Evaluate(parameters, linear.residuals.data(), jacobians)) {
    linear.residuals.setConstant(std::nan(""));
    rows.setConstant(std::nan(""));
    linear.by_deviation.setConstant(std::nan(""));
  }
  linear.by_step = rows;
  return linear;
}

Eigen::MatrixXd ByIntrinsics(const TurningState& state, const CameraModel& camera,
                             const ModelView& view, double deviation) {
  const std::vector<double>& intrinsics = camera.intrinsics();
  Eigen::MatrixXd by(2 * view.points.size(), intrinsics.size());
  for (std::size_t k = 0; k < intrinsics.size(); ++k) {
    // Distortions are of the order of 0.1 and act on numbers of the order of 1.
    const double step = kRelativeStep * std::max(std::abs(intrinsics[k]), 0.1);
    std::vector<double> moved = intrinsics;
    moved[k] += step;
    const auto above = Residuals(state, camera.WithIntrinsics(moved), view, deviation);
    moved[k] = intrinsics[k] - step;
    const auto below = Residuals(state, camera.WithIntrinsics(moved), view, deviation);
    for (std::size_t i = 0; i < view.points.size(); ++i)
      by.block<2, 1>(static_cast<Eigen::Index>(2 * i), static_cast<Eigen::Index>(k)) =
          (above[i] - below[i]) / (2.0 * step * view.points[i].spread);
  }
  return by;
}

}  // namespace turnlight::calib::calibrate::axis
