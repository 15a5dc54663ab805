#include "calib/calibrate/lens/problem.h"

#include <fcntl.h>
#include <suitesparse/cholmod.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace turnlight::calib::calibrate::lens {
namespace {

// Corners of tags are brought to a grid as fine as is needed to place them within this share of the
// tags' spacing, a few hundredths of a pixel at most, and no finer than kMaxSteps a spacing.
constexpr double kGridTolerance = 5e-4;
constexpr int kMaxSteps = 32;
// How much stiffer a shape is where it must not be than where it may.
constexpr double kForbidden = 1e3;

constexpr mrcal_problem_constants_t kConstants{.point_min_range = 0.0, .point_max_range = 0.0};

mrcal_problem_selections_t Selections(const Pass& pass) {
  mrcal_problem_selections_t selections{};
  selections.do_optimize_intrinsics_core = pass.core;
  selections.do_optimize_intrinsics_distortions = pass.distortions;
  selections.do_optimize_extrinsics = true;
  selections.do_optimize_frames = true;
  selections.do_optimize_calobject_warp = pass.warp;
  selections.do_apply_regularization = pass.regularized;
  selections.do_apply_outlier_rejection = pass.rejects_outliers;
  return selections;
}

std::vector<mrcal_observation_board_t> BoardObservations(std::size_t count) {
  std::vector<mrcal_observation_board_t> observations(count);
  for (std::size_t i = 0; i < count; ++i)
    observations[i] = {.icam = {.intrinsics = 0, .extrinsics = -1}, .iframe = static_cast<int>(i)};
  return observations;
}

// mrcal and what it builds on say on standard error what they do on the way, outliers and steps
// that failed: nothing that a user of the result needs. While one of these lives, it goes nowhere.
class SilentStandardError {
 public:
  SilentStandardError() : kept_(dup(STDERR_FILENO)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) close(nowhere);
  }
  ~SilentStandardError() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  SilentStandardError(const SilentStandardError&) = delete;
  SilentStandardError& operator=(const SilentStandardError&) = delete;

 private:
  const int kept_;
};

struct Steps {
  int spacing = 1, marker = 1;  // in cells of the fine grid
};

Steps FineSteps(double ratio) {
  Steps best;
  double least = std::numeric_limits<double>::infinity();
  for (int spacing = 2; spacing <= kMaxSteps && least > kGridTolerance; ++spacing) {
    const int marker = std::max(1, static_cast<int>(std::lround(ratio * spacing)));
    const double error = std::abs(ratio - static_cast<double>(marker) / spacing);
    if (error < least) {
      least = error;
      best = {spacing, marker};
    }
  }
  return best;
}

PointGrid GridOfTags(const board::Board& board) {
  const Steps steps = FineSteps(board.marker / board.spacing);
  PointGrid grid;
  grid.columns = steps.spacing * (board.columns - 1) + steps.marker + 1;
  grid.rows = steps.spacing * (board.rows - 1) + steps.marker + 1;
  grid.spacing = board.spacing / steps.spacing;
  for (int tag = 0; tag < board.columns * board.rows; ++tag) {
    const int x = steps.spacing * (tag % board.columns), y = steps.spacing * (tag / board.columns);
    const int m = steps.marker;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {m, 0}, {m, m}, {0, m}})
      grid.cells.push_back((y + dy) * grid.columns + x + dx);
  }
  return grid;
}

}  // namespace

PointGrid GridOfBoard(const board::Board& board) {
  if (board.kind == board::BoardKind::kAprilTagGrid) return GridOfTags(board);
  PointGrid grid{board.columns, board.rows, board.spacing, {}};
  for (int i = 0; i < board.columns * board.rows; ++i) grid.cells.push_back(i);
  return grid;
}

PointGrid CoarseGridOfBoard(const board::Board& board) {
  if (board.kind != board::BoardKind::kAprilTagGrid) return GridOfBoard(board);
  PointGrid grid{board.columns, board.rows, board.spacing, {}};
  for (int tag = 0; tag < board.columns * board.rows; ++tag)
    grid.cells.insert(grid.cells.end(), {tag, -1, -1, -1});
  return grid;
}

mrcal_lensmodel_t LensModelOf(const std::string& full_name) {
  mrcal_lensmodel_t model{};
  mrcal_lensmodel_from_name(&model, full_name.c_str());
  return model;
}

std::vector<mrcal_point3_t> Observations(const PointGrid& grid, const board::BoardView& view) {
  std::vector<mrcal_point3_t> observed(
      static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows),
      mrcal_point3_t{{0.0, 0.0, -1.0}});
  for (const board::SeenPoint& seen : view.points)
    if (const int cell = grid.cells[seen.point]; cell >= 0)
      observed[static_cast<std::size_t>(cell)] = {
          {seen.pixel.x(), seen.pixel.y(), 1.0 / seen.spread}};
  return observed;
}

Pose ToPose(const mrcal_pose_t& pose) {
  const Eigen::Vector3d r(pose.r.x, pose.r.y, pose.r.z);
  const double angle = r.norm();
  Pose result;
  if (angle > 0.0) result.rotation = Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
  result.translation = {pose.t.x, pose.t.y, pose.t.z};
  return result;
}

mrcal_pose_t ToMrcal(const Pose& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  const Eigen::Vector3d r = turn.angle() * turn.axis();
  const Eigen::Vector3d& t = pose.translation;
  mrcal_pose_t result{};
  result.r = {{r.x(), r.y(), r.z()}};
  result.t = {{t.x(), t.y(), t.z()}};
  return result;
}

bool Optimize(Problem& problem, const Pass& pass) {
  const auto observations = BoardObservations(problem.poses.size());
  const int views = static_cast<int>(problem.poses.size());
  const SilentStandardError silence;
  const mrcal_stats_t stats = mrcal_optimize(
      nullptr, 0, nullptr, 0, problem.intrinsics.data(), nullptr, problem.poses.data(), nullptr,
      &problem.warp, 1, 0, views, 0, 0, observations.data(), nullptr, views, 0,
      problem.observed.data(), &problem.model, problem.image_size.data(), Selections(pass),
      &kConstants, problem.grid.spacing, problem.grid.columns, problem.grid.rows, false, false);
  if (!(stats.rms_reproj_error__pixels >= 0.0)) return false;
  for (const double value : problem.intrinsics)
    if (!std::isfinite(value)) return false;
  for (const mrcal_pose_t& pose : problem.poses)
    if (!ToPose(pose).translation.allFinite() || !ToPose(pose).rotation.allFinite()) return false;
  return std::isfinite(problem.warp.x2) && std::isfinite(problem.warp.y2);
}

namespace {

// p_B of the grid's points, bent by the warp.
std::vector<Eigen::Vector3d> BentPoints(const PointGrid& grid, const mrcal_calobject_warp_t& warp) {
  const auto bend = [](int i, int count) {
    const double x = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    return 4.0 * x * (1.0 - x);
  };
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      points.emplace_back(grid.spacing * column, grid.spacing * row,
                          warp.x2 * bend(column, grid.columns) + warp.y2 * bend(row, grid.rows));
  return points;
}

std::vector<mrcal_point2_t> ProjectView(const Problem& problem, std::size_t view, bool shaped,
                                        std::vector<mrcal_point3_t>* by_point) {
  const Pose X_CB = ToPose(problem.poses[view]);
  auto p_B = BentPoints(problem.grid, problem.warp);
  std::vector<mrcal_point3_t> p_C(p_B.size());
  for (std::size_t i = 0; i < p_B.size(); ++i) {
    if (shaped) p_B[i] += problem.shape[i];
    const Eigen::Vector3d p = X_CB * p_B[i];
    p_C[i] = {{p.x(), p.y(), p.z()}};
  }
  std::vector<mrcal_point2_t> pixels(p_B.size());
  if (by_point != nullptr) by_point->resize(2 * p_B.size());
  // One by one: of several points mrcal 2.2 gives the derivatives of the first alone, if those by
  // the intrinsics are not asked for.
  for (std::size_t i = 0; i < p_C.size(); ++i)
    mrcal_project(&pixels[i], by_point != nullptr ? &(*by_point)[2 * i] : nullptr, nullptr, &p_C[i],
                  1, &problem.model, problem.intrinsics.data());
  return pixels;
}

// What a board without its shape would have shown: so mrcal's residuals are those with the shape.
std::vector<mrcal_point3_t> WithoutShape(const Problem& problem) {
  std::vector<mrcal_point3_t> observed = problem.observed;
  for (std::size_t view = 0; view < problem.poses.size(); ++view) {
    const auto plain = ProjectView(problem, view, false, nullptr);
    const auto shaped = ProjectView(problem, view, true, nullptr);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      observed[view * plain.size() + i].x -= shaped[i].x - plain[i].x;
      observed[view * plain.size() + i].y -= shaped[i].y - plain[i].y;
    }
  }
  return observed;
}

// What a shape must not be: a shift, a turn or a change of size of the whole board, which its
// poses, or nothing, can tell from it. Seven directions in the space of shapes, of length 1.
Eigen::MatrixXd NoShapes(const PointGrid& grid) {
  const auto p_B = BentPoints(grid, {});
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : p_B) mean += p / static_cast<double>(p_B.size());
  Eigen::MatrixXd directions(7, 3 * static_cast<Eigen::Index>(p_B.size()));
  for (std::size_t i = 0; i < p_B.size(); ++i) {
    const Eigen::Vector3d p = p_B[i] - mean;
    auto at = directions.middleCols<3>(3 * static_cast<Eigen::Index>(i));
    for (int axis = 0; axis < 3; ++axis) {
      at.row(axis) = Eigen::Vector3d::Unit(axis).transpose();
      at.row(3 + axis) = Eigen::Vector3d::Unit(axis).cross(p).transpose();
    }
    at.row(6) = p.transpose();
  }
  directions.rowwise().normalize();
  return directions;
}

// The rows of mrcal's jacobian with three more columns a point, and what keeps the shape small.
void AppendShape(const Problem& problem, Linearization& linear) {
  const Eigen::Index rows = linear.jacobian.rows(), states = linear.jacobian.cols();
  const auto shape = static_cast<Eigen::Index>(3 * problem.shape.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index row = 0; row < rows; ++row)
    for (decltype(linear.jacobian)::InnerIterator it(linear.jacobian, row); it; ++it)
      entries.emplace_back(row, it.col(), it.value());
  std::vector<mrcal_point3_t> by_point;
  for (std::size_t view = 0; view < problem.poses.size(); ++view) {
    const Eigen::Matrix3d rotation = ToPose(problem.poses[view]).rotation;
    ProjectView(problem, view, true, &by_point);
    for (std::size_t i = 0; i < problem.shape.size(); ++i) {
      const std::size_t measured = view * problem.shape.size() + i;
      const double weight = problem.observed[measured].z;
      if (weight < 0.0) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        const mrcal_point3_t& d = by_point[2 * i + k];
        const Eigen::Vector3d by_shape =
            weight * (rotation.transpose() * Eigen::Vector3d(d.x, d.y, d.z));
        for (Eigen::Index c = 0; c < 3; ++c)
          entries.emplace_back(static_cast<Eigen::Index>(2 * measured + k),
                               states + 3 * static_cast<Eigen::Index>(i) + c, by_shape[c]);
      }
    }
  }
  const double hold = 1.0 / problem.grid.spacing;
  for (Eigen::Index i = 0; i < shape; ++i) entries.emplace_back(rows + i, states + i, hold);
  const Eigen::MatrixXd forbidden = kForbidden * hold * NoShapes(problem.grid);
  for (Eigen::Index k = 0; k < 7; ++k)
    for (Eigen::Index i = 0; i < shape; ++i)
      entries.emplace_back(rows + shape + k, states + i, forbidden(k, i));
  linear.jacobian.resize(rows + shape + 7, states + shape);
  linear.jacobian.setFromTriplets(entries.begin(), entries.end());
  linear.residuals.conservativeResize(rows + shape + 7);
  linear.scales.conservativeResize(states + shape);
  linear.scales.tail(shape).setOnes();
  for (std::size_t i = 0; i < problem.shape.size(); ++i)
    linear.residuals.segment<3>(rows + 3 * static_cast<Eigen::Index>(i)) = hold * problem.shape[i];
  linear.residuals.tail<7>() = forbidden * (linear.residuals.segment(rows, shape) / hold);
  linear.shape_index = static_cast<int>(states);
}

// Where mrcal's state has what.
void FindStates(const Problem& problem, const mrcal_problem_selections_t& selections,
                Linearization& result) {
  const int views = static_cast<int>(problem.poses.size());
  const mrcal_lensmodel_t* model = &problem.model;
  result.intrinsics_index =
      mrcal_state_index_intrinsics(0, 1, 0, views, 0, 0, views, selections, model);
  result.intrinsics_count = mrcal_num_states_intrinsics(1, selections, model);
  result.poses_index = mrcal_state_index_frames(0, 1, 0, views, 0, 0, views, selections, model);
  result.warp_index = mrcal_state_index_calobject_warp(1, 0, views, 0, 0, views, selections, model);
}

}  // namespace

Linearization Linearize(const Problem& problem, const Pass& pass) {
  const auto observations = BoardObservations(problem.poses.size());
  const std::vector<mrcal_point3_t> observed =
      problem.shape.empty() ? problem.observed : WithoutShape(problem);
  const mrcal_problem_selections_t selections = Selections(pass);
  const int views = static_cast<int>(problem.poses.size());
  const int columns = problem.grid.columns, rows = problem.grid.rows;
  const mrcal_lensmodel_t* model = &problem.model;
  const int states = mrcal_num_states(1, 0, views, 0, 0, views, selections, model);
  const int measurements =
      mrcal_num_measurements(views, 0, columns, rows, 1, 0, views, 0, 0, selections, model);
  const int entries = _mrcal_num_j_nonzero(views, 0, columns, rows, 1, 0, views, 0, 0,
                                           observations.data(), nullptr, selections, model);
  Linearization result;
  // mrcal writes the transpose by columns, which is the matrix by rows.
  std::vector<int> starts(static_cast<std::size_t>(measurements) + 1);
  std::vector<int> indices(static_cast<std::size_t>(entries));
  std::vector<double> values(static_cast<std::size_t>(entries));
  cholmod_sparse transposed{};
  transposed.nrow = static_cast<std::size_t>(states);
  transposed.ncol = static_cast<std::size_t>(measurements);
  transposed.nzmax = static_cast<std::size_t>(entries);
  transposed.p = starts.data();
  transposed.i = indices.data();
  transposed.x = values.data();
  transposed.itype = CHOLMOD_INT;
  transposed.xtype = CHOLMOD_REAL;
  transposed.dtype = CHOLMOD_DOUBLE;
  transposed.sorted = 1;
  transposed.packed = 1;
  std::vector<double> packed(static_cast<std::size_t>(states));
  result.residuals.resize(measurements);
  mrcal_optimizer_callback(packed.data(), states * static_cast<int>(sizeof(double)),
                           result.residuals.data(), measurements * static_cast<int>(sizeof(double)),
                           &transposed, problem.intrinsics.data(), nullptr, problem.poses.data(),
                           nullptr, &problem.warp, 1, 0, views, 0, 0, observations.data(), nullptr,
                           views, 0, observed.data(), model, problem.image_size.data(), selections,
                           &kConstants, problem.grid.spacing, columns, rows, false);
  result.jacobian = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
      measurements, states, starts.back(), starts.data(), indices.data(), values.data());
  result.observation_rows = mrcal_num_measurements_boards(views, columns, rows);
  result.scales = Eigen::VectorXd::Ones(states);
  mrcal_unpack_solver_state_vector(result.scales.data(), 1, 0, views, 0, 0, selections, model);
  FindStates(problem, selections, result);
  if (!problem.shape.empty()) AppendShape(problem, result);
  return result;
}

std::vector<Eigen::Vector2d> Residuals(const Problem& problem, std::size_t view) {
  const auto pixels = ProjectView(problem, view, !problem.shape.empty(), nullptr);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector2d> residuals(pixels.size(), Eigen::Vector2d(kNan, kNan));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const mrcal_point3_t& observed = problem.observed[view * pixels.size() + i];
    // What was never seen is at (0, 0) with a weight of -1; an outlier keeps its pixel.
    if (observed.x == 0.0 && observed.y == 0.0 && observed.z < 0.0) continue;
    residuals[i] = {observed.x - pixels[i].x, observed.y - pixels[i].y};
  }
  return residuals;
}

}  // namespace turnlight::calib::calibrate::lens
