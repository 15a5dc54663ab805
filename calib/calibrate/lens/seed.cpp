#include "calib/calibrate/lens/seed.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxSeedViews = 24;
constexpr std::size_t kMinPoints = 4;
// Of the homography's singular values: below it the points are on a line.
constexpr double kLeastSingular = 1e-9;
constexpr double kShortestFocal = 0.25, kLongestFocal = 8.0;  // of the picture's longer side
constexpr int kFocalCount = 11;

std::vector<Vector3d> Rays(const mrcal_lensmodel_t& model, const double* intrinsics,
                           const board::BoardView& view) {
  std::vector<mrcal_point2_t> pixels;
  for (const board::SeenPoint& seen : view.points)
    pixels.push_back({{seen.pixel.x(), seen.pixel.y()}});
  std::vector<mrcal_point3_t> rays(pixels.size());
  mrcal_unproject(rays.data(), pixels.data(), static_cast<int>(pixels.size()), &model, intrinsics);
  std::vector<Vector3d> result;
  for (const mrcal_point3_t& ray : rays)
    result.push_back(Vector3d(ray.x, ray.y, ray.z).normalized());
  return result;
}

std::vector<Vector3d> SeenPoints(const std::vector<Vector3d>& p_B, const board::BoardView& view) {
  std::vector<Vector3d> points;
  for (const board::SeenPoint& seen : view.points) points.push_back(p_B[seen.point]);
  return points;
}

double RmsDistance(const Problem& problem, std::size_t view) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Eigen::Vector2d& residual : Residuals(problem, view)) {
    if (residual.hasNaN()) continue;
    sum += residual.squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

double MedianOfViews(const Problem& problem) {
  std::vector<double> values;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) values.push_back(RmsDistance(problem, i));
  return Median(values);
}

// From a focal length to the best lens and poses near it; nothing if the optimizer fails.
std::optional<Problem> FitCore(Problem problem, const board::Board& board,
                               const std::vector<board::BoardView>& views) {
  problem.poses = PosesThrough(problem.model, problem.intrinsics, board, views);
  Problem fitted = problem;
  if (!Optimize(fitted, {})) return std::nullopt;
  Problem moved = fitted;
  if (!Optimize(moved, {.core = true}) || !(moved.intrinsics[0] > 0.0 && moved.intrinsics[1] > 0.0))
    return fitted;
  return moved;
}

std::vector<board::BoardView> SomeViews(const std::vector<board::BoardView>& views) {
  if (views.size() <= kMaxSeedViews) return views;
  std::vector<board::BoardView> some;
  for (std::size_t i = 0; i < kMaxSeedViews; ++i)
    some.push_back(views[i * views.size() / kMaxSeedViews]);
  return some;
}

}  // namespace

std::optional<Pose> PoseFromRays(const std::vector<Vector3d>& p_B,
                                 const std::vector<Vector3d>& v_C) {
  if (p_B.size() < kMinPoints) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : p_B) mean += p / static_cast<double>(p_B.size());
  double size = 0.0;
  for (const Vector3d& p : p_B) size = std::max(size, (p - mean).norm());
  if (!(size > 0.0)) return std::nullopt;
  // v x (H (x, y, 1)) = 0, three rows a point.
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < p_B.size(); ++i) {
    if (!v_C[i].allFinite()) continue;
    const Vector3d x((p_B[i].x() - mean.x()) / size, (p_B[i].y() - mean.y()) / size, 1.0);
    Eigen::Matrix3d cross;
    cross << 0, -v_C[i].z(), v_C[i].y(), v_C[i].z(), 0, -v_C[i].x(), -v_C[i].y(), v_C[i].x(), 0;
    Eigen::Matrix<double, 3, 9> rows;
    for (int k = 0; k < 3; ++k) rows.middleCols<3>(3 * k) = x[k] * cross;
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  if (!(solver.eigenvalues()[1] > kLeastSingular * solver.eigenvalues()[8])) return std::nullopt;
  Eigen::Matrix3d h = Eigen::Map<const Eigen::Matrix3d>(solver.eigenvectors().col(0).data());
  double ahead = 0.0;
  for (std::size_t i = 0; i < p_B.size(); ++i) {
    const Vector3d x((p_B[i].x() - mean.x()) / size, (p_B[i].y() - mean.y()) / size, 1.0);
    if (v_C[i].allFinite()) ahead += v_C[i].dot(h * x);
  }
  if (ahead < 0.0) h = -h;
  const double scale = 0.5 * (h.col(0).norm() + h.col(1).norm());
  if (!(scale > 0.0)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes << h.col(0), h.col(1), h.col(0).cross(h.col(1)) / scale;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose pose;
  pose.rotation = svd.matrixU() * svd.matrixV().transpose();
  if (pose.rotation.determinant() < 0.0) return std::nullopt;
  pose.translation = h.col(2) * (size / scale) - pose.rotation * mean;
  return pose;
}

std::vector<mrcal_pose_t> PosesThrough(const mrcal_lensmodel_t& model,
                                       const std::vector<double>& intrinsics,
                                       const board::Board& board,
                                       const std::vector<board::BoardView>& views) {
  const std::vector<Vector3d> p_B = board::BoardPoints(board);
  // Where there is none: ahead, at about the distance at which a board fills a picture.
  Pose somewhere;
  somewhere.translation.z() = board.spacing * std::max(board.columns, board.rows);
  std::vector<mrcal_pose_t> poses;
  for (const board::BoardView& view : views)
    poses.push_back(
        ToMrcal(PoseFromRays(SeenPoints(p_B, view), Rays(model, intrinsics.data(), view))
                    .value_or(somewhere)));
  return poses;
}

std::vector<Seed> FindSeeds(const std::array<int, 2>& image_size, const board::Board& board,
                            const std::vector<board::BoardView>& views) {
  const std::vector<board::BoardView> some = SomeViews(views);
  Problem problem;
  problem.image_size = image_size;
  problem.grid = CoarseGridOfBoard(board);
  for (const board::BoardView& view : some) {
    const auto observed = Observations(problem.grid, view);
    problem.observed.insert(problem.observed.end(), observed.begin(), observed.end());
  }
  std::vector<Seed> seeds;
  for (const char* name : {"LENSMODEL_STEREOGRAPHIC", "LENSMODEL_PINHOLE"}) {
    problem.model = LensModelOf(name);
    std::optional<Seed> best;
    for (int i = 0; i < kFocalCount; ++i) {
      const double focal =
          std::max(image_size[0], image_size[1]) * kShortestFocal *
          std::pow(kLongestFocal / kShortestFocal, static_cast<double>(i) / (kFocalCount - 1));
      problem.intrinsics = {focal, focal, 0.5 * (image_size[0] - 1), 0.5 * (image_size[1] - 1)};
      const auto fitted = FitCore(problem, board, some);
      if (!fitted) continue;
      const double median = MedianOfViews(*fitted);
      if (!std::isfinite(median) || (best && median >= best->median_px)) continue;
      best = Seed{fitted->model, {}, {}, median};
      std::copy_n(fitted->intrinsics.begin(), 4, best->core.begin());
    }
    if (!best) continue;
    best->poses = PosesThrough(best->model, {best->core.begin(), best->core.end()}, board, views);
    seeds.push_back(*best);
  }
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Seed& a, const Seed& b) { return a.median_px < b.median_px; });
  return seeds;
}

}  // namespace turnlight::calib::calibrate::lens
