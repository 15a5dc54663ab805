#include "calib/calibrate/probe/spot_shape.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/angles.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Levels, as shares of the peak, at which a spot is cut off: what is above counts by how much it is
// above, so that nothing jumps where a pixel comes in. The first uses nearly all of a spot, of a
// clipped one the soft rim, and says where it is; from one to the next, what is lopsided moves.
// What is not clipped has no bloom to keep away from, but never within so many sigmas of noise.
constexpr std::array<double, 3> kClippedLevels{0.15, 0.3, 0.5};
constexpr std::array<double, 3> kOpenLevels{0.04, 0.15, 0.3};
constexpr double kAboveNoise = 4.0;
// Blur of lens and pixel, sigma in pixels, of which nothing is known: between none and twice this.
constexpr double kBlur = 0.6;
// Pixels. What sampling leaves of a small spot's place; half of a pixel is lost at a clipped edge.
constexpr double kOpenFloor = 0.006;
constexpr double kClippedFloor = 0.05;
// Shares, of variances, of what may be wrong with a spot: of the way between its place as a patch
// of pixels and of directions, and of the way from level to level. The study of coverage has them.
struct ShapeShares {
  double between, moved;
};
constexpr ShapeShares kOpenShares{0.03, 0.04}, kClippedShares{0.25, 0.125};

struct Weighted {
  Vector2d pixel;  // of the picture
  double weight;   // radiance above the level
  double slope;    // d weight / d radiance
};

std::vector<Weighted> Above(const SpotMaps& maps, const cv::Mat1b& flooded, double level) {
  std::vector<Weighted> pixels;
  for (int row = 0; row < flooded.rows; ++row)
    for (int column = 0; column < flooded.cols; ++column) {
      if (!flooded(row, column)) continue;
      const double above = double{maps.grey(row, column)} - maps.ground(row, column) - level;
      if (above > 0.0)
        pixels.push_back({{column + maps.origin.x, row + maps.origin.y},
                          above,
                          maps.clipped(row, column) ? 0.0 : 1.0});
    }
  return pixels;
}

struct Moments {
  double sum = 0.0;
  Vector2d mean = Vector2d::Zero();
  Matrix2d spread = Matrix2d::Zero();  // second moments
  Matrix2d noise = Matrix2d::Zero();   // of the mean, for a noise of 1
};

Moments MomentsOf(const std::vector<Weighted>& pixels) {
  Moments moments;
  for (const Weighted& at : pixels) {
    moments.sum += at.weight;
    moments.mean += at.weight * at.pixel;
  }
  if (!(moments.sum > 0.0)) return moments;
  moments.mean /= moments.sum;
  for (const Weighted& at : pixels) {
    const Vector2d off = at.pixel - moments.mean;
    const Matrix2d square = off * off.transpose();
    moments.spread += at.weight / moments.sum * square;
    moments.noise += at.slope / (moments.sum * moments.sum) * square;
  }
  return moments;
}

// Solid angle of the mirrored directions per pixel, times that direction: what a pixel's weight is
// multiplied with to sum over directions.
std::optional<Vector3d> PatchOf(const BallView& view, const Vector2d& pixel) {
  const auto seen = MirrorAt(view, pixel);
  const auto differential = MirrorDifferential(view, pixel);
  if (!seen || !differential) return std::nullopt;
  return differential->col(0).cross(differential->col(1)).norm() * seen->direction;
}

struct Patch {
  Vector3d direction = Vector3d::UnitZ();  // centre of gravity, unit
  double weight = 0.0;                     // sum of weight times solid angle
  double extent = 0.0;                     // radians
};

// The spot summed over directions. A lens's blur B of variance s^2 is taken back to second order:
// the sum over the blurred picture of f - s^2/2 Laplacian f is that over the sharp one of f.
std::optional<Patch> PatchOfSpot(const BallView& view, const std::vector<Weighted>& pixels,
                                 double blur) {
  Vector3d sum = Vector3d::Zero();
  double total = 0.0;
  std::vector<std::pair<Vector3d, double>> parts;
  for (const Weighted& at : pixels) {
    const auto here = PatchOf(view, at.pixel);
    if (!here) return std::nullopt;
    Vector3d of_direction = -4.0 * *here;
    double of_angle = -4.0 * here->norm();
    for (const Vector2d& step :
         {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1)}) {
      const auto beside = PatchOf(view, at.pixel + step);
      if (!beside) return std::nullopt;
      of_direction += *beside;
      of_angle += beside->norm();
    }
    sum += at.weight * (*here - 0.5 * blur * blur * of_direction);
    total += at.weight * (here->norm() - 0.5 * blur * blur * of_angle);
    parts.emplace_back(here->normalized(), at.weight * here->norm());
  }
  if (!(sum.norm() > 0.0) || !(total > 0.0)) return std::nullopt;
  Patch patch{sum.normalized(), total, 0.0};
  const Eigen::Matrix<double, 3, 2> across = Across(patch.direction);
  Matrix2d spread = Matrix2d::Zero();
  double weights = 0.0;
  for (const auto& [direction, weight] : parts) {
    const Vector2d off = across.transpose() * direction;
    spread += weight * off * off.transpose();
    weights += weight;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(spread / weights);
  patch.extent = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  return patch;
}

// The image point near `pixel` that sees a direction.
std::optional<Vector2d> PixelSeeing(const BallView& view, Vector2d pixel,
                                    const Vector3d& direction) {
  for (int i = 0; i < 8; ++i) {
    const auto seen = MirrorAt(view, pixel);
    const auto differential = MirrorDifferential(view, pixel);
    if (!seen || !differential) return std::nullopt;
    const Vector2d step = (differential->transpose() * *differential)
                              .ldlt()
                              .solve(differential->transpose() * (direction - seen->direction));
    if (!step.allFinite() || step.norm() > 3.0) return std::nullopt;
    pixel += step;
  }
  return pixel;
}

// The flooded part and its neighbours, where the soft rim fades.
cv::Mat1b WithRim(const SpotMaps& maps, const Peak& peak, double share, bool* cut) {
  const double level = std::max(share * peak.height, 1.0001 * peak.saddle);
  cv::Mat1b flooded = FloodFrom(maps.rest, maps.usable, peak.at, static_cast<float>(level));
  cv::dilate(flooded, flooded, {});
  const cv::Rect touched = cv::boundingRect(flooded);
  *cut = cv::countNonZero(flooded & ~maps.usable) > 0 || touched.x == 0 || touched.y == 0 ||
         touched.br().x == flooded.cols || touched.br().y == flooded.rows;
  flooded &= maps.usable;
  return flooded;
}

// Fills in levels, size and whether it is clipped from the part above half of the peak.
void MeasureLevels(const SpotMaps& maps, const cv::Mat1b& flooded, Spot& spot) {
  double peak = 0.0;
  for (int row = 0; row < flooded.rows; ++row)
    for (int column = 0; column < flooded.cols; ++column)
      if (flooded(row, column)) {
        peak = std::max(peak, double{maps.grey(row, column)} - maps.ground(row, column));
        spot.clipped = spot.clipped || maps.clipped(row, column) > 0;
      }
  for (int row = 0; row < flooded.rows; ++row)
    for (int column = 0; column < flooded.cols; ++column)
      if (flooded(row, column) && maps.grey(row, column) - maps.ground(row, column) >= 0.5 * peak)
        spot.area_px += 1.0;
  spot.peak = peak;
  spot.noise = maps.noise;
}

// Where the spot is, cut off at three levels; what is lopsided moves from one to the next.
std::optional<Vector2d> MeasurePlace(const SpotMaps& maps, const Peak& peak, const BallView& view,
                                     Spot& spot) {
  Vector2d place = Vector2d::Zero();
  Matrix2d shape = Matrix2d::Zero();
  const ShapeShares& shares = spot.clipped ? kClippedShares : kOpenShares;
  for (std::size_t i = 0; i < kOpenLevels.size(); ++i) {
    bool cut = false;
    const double share = spot.clipped
                             ? kClippedLevels[i]
                             : std::max(kOpenLevels[i], kAboveNoise * maps.noise / spot.peak);
    const cv::Mat1b flooded = WithRim(maps, peak, share, &cut);
    const double level = std::max(share * spot.peak, double{peak.saddle});
    const auto pixels = Above(maps, flooded, level);
    const Moments moments = MomentsOf(pixels);
    if (!(moments.sum > 0.0)) return std::nullopt;
    const double size = std::sqrt(0.5 * moments.spread.trace());
    const auto patch = PatchOfSpot(view, pixels, std::min(kBlur, size));
    if (!patch) return std::nullopt;
    const auto by_direction = PixelSeeing(view, moments.mean, patch->direction);
    if (!by_direction) return std::nullopt;
    // A lamp that the ball resolves is even over directions; what blur or bloom widened is even
    // over pixels. Which of the two a clipped spot is cannot be seen.
    const Vector2d between = *by_direction - moments.mean;
    const Vector2d here = moments.mean + (spot.clipped ? 0.5 : 1.0) * between;
    if (i == 0) {
      place = here;
      spot.noise_covariance = maps.noise * maps.noise * moments.noise;
      shape += shares.between * between * between.transpose();
      spot.extent_deg = RadToDeg(patch->extent);
      const auto all = PatchOfSpot(view, Above(maps, flooded, 0.0), 0.0);
      spot.irradiance = all ? all->weight : patch->weight;
    } else {
      const Vector2d moved = here - place;
      shape += shares.moved * moved * moved.transpose();
    }
  }
  const double floor = spot.clipped ? kClippedFloor : kOpenFloor;
  spot.shape_covariance = shape + floor * floor * Matrix2d::Identity();
  return place;
}

}  // namespace

SpotShape MeasureShape(const SpotMaps& maps, const Peak& peak, const BallView& view) {
  SpotShape shape;
  Spot& spot = shape.spot;
  constexpr double kHalf = 0.5;
  const cv::Mat1b half = WithRim(maps, peak, kHalf, &shape.cut);
  MeasureLevels(maps, half, spot);
  spot.ground = maps.ground(peak.at);
  const auto place = MeasurePlace(maps, peak, view, spot);
  if (!place) return shape;
  const auto seen = MirrorAt(view, *place);
  if (!seen) return shape;
  spot.pixel = *place;
  spot.cosine = seen->cosine;
  shape.measured = true;
  return shape;
}

}  // namespace turnlight::calib::calibrate::probe
