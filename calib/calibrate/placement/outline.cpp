#include "calib/calibrate/placement/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/statistics.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBorder = 4.0;       // pixels
constexpr int kTangentPoints = 5;     // along the outline, on each side
constexpr double kSampleStep = 0.25;  // pixels along the normal
constexpr int kSamples = 53;          // from -7 to 6 pixels: the mask's edge is at 0.5
constexpr double kFirstSample = -7.0, kMaskEdge = 0.5;
constexpr double kLevelFrom = 2.5, kLevelTo = 4.5;  // from the edge, where levels are taken
constexpr double kShadeTo = 7.0;                    // likewise, where the target's shading is taken
constexpr double kOfShading = 0.5;       // of what shading moves an edge by: how well that is known
constexpr double kLeastEdge = 0.3;       // of the level inside: what shading may leave at the edge
constexpr double kFarthest = 2.5;        // pixels from the mask's edge
constexpr double kLeastContrast = 0.25;  // of the median along the outline
constexpr double kLeastSignal = 5.0;     // sigma of the noise
constexpr double kLeastSigma = 0.05;     // pixels
constexpr double kMaskBlur = 1.0;        // pixels
constexpr std::size_t kFewContourPoints = 8;

// Three channels, those that are missing 0.
cv::Mat3f ThreeChannels(const cv::Mat& picture) {
  if (picture.channels() == 3) return picture;
  const cv::Mat1f none(picture.size(), 0.0f);
  cv::Mat3f merged;
  cv::merge(std::vector<cv::Mat>{picture, none, none}, merged);
  return merged;
}

// Of a channel's pixels: white noise, which what changes slowly does not move.
double NoiseOf(const cv::Mat3f& picture) {
  std::array<std::vector<double>, 3> differences;
  for (int row = 0; row < picture.rows; row += 3)
    for (int column = 1; column + 1 < picture.cols; column += 3)
      for (int c = 0; c < 3; ++c)
        differences[static_cast<std::size_t>(c)].push_back(std::abs(picture(row, column - 1)[c] -
                                                                    2.0 * picture(row, column)[c] +
                                                                    picture(row, column + 1)[c]));
  double noise = 0.0;
  for (auto& values : differences)
    noise = std::max(noise, SigmaOfSecondDifference(Median(values), kMedianOfNormal));
  return noise;
}

Vector3d Sample(const cv::Mat3f& picture, const Vector2d& p) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  const double dx = p.x() - x, dy = p.y() - y;
  const auto at = [&](int row, int column) {
    const cv::Vec3f& value =
        picture(std::clamp(row, 0, picture.rows - 1), std::clamp(column, 0, picture.cols - 1));
    return Vector3d(value[0], value[1], value[2]);
  };
  return (1.0 - dy) * ((1.0 - dx) * at(y, x) + dx * at(y, x + 1)) +
         dy * ((1.0 - dx) * at(y + 1, x) + dx * at(y + 1, x + 1));
}

struct Edge {
  double at = 0.0;        // along the normal
  double contrast = 0.0;  // between the levels
  double slope = 0.0;     // of the share, per pixel
  double shading = 0.0;   // how far it would be moved if the target's shading were overlooked
};

// The picture along a normal: the share of the target's level over the background's.
struct Profile {
  std::array<double, kSamples> share;
  double contrast = 0.0;   // between the levels
  double per_pixel = 0.0;  // of the share inside, by shading, towards the outside
};

double SampleAt(int i) { return kFirstSample + kSampleStep * i; }

std::optional<Profile> ProfileAlong(const cv::Mat3f& signal, const Vector2d& from,
                                    const Vector2d& normal) {
  std::array<Vector3d, kSamples> values;
  Vector3d inside = Vector3d::Zero(), outside = Vector3d::Zero();
  double count_inside = 0.0, count_outside = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double away = SampleAt(i) - kMaskEdge;
    Vector3d& value = values[static_cast<std::size_t>(i)] =
        Sample(signal, from + SampleAt(i) * normal);
    if (std::abs(away) < kLevelFrom || std::abs(away) > kLevelTo) continue;
    (away < 0.0 ? inside : outside) += value;
    (away < 0.0 ? count_inside : count_outside) += 1.0;
  }
  outside /= count_outside;
  const Vector3d change = inside / count_inside - outside;
  Profile profile;
  profile.contrast = change.norm();
  if (!(profile.contrast > 0.0)) return std::nullopt;
  double n = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double share =
        (values[static_cast<std::size_t>(i)] - outside).dot(change) / change.squaredNorm();
    profile.share[static_cast<std::size_t>(i)] = share;
    const double away = SampleAt(i) - kMaskEdge;
    if (away > -kLevelFrom || away < -kShadeTo) continue;
    n += 1.0, x += away, xx += away * away, y += share, xy += away * share;
  }
  profile.per_pixel = (n * xy - x * y) / (n * xx - x * x);
  return profile;
}

// Where the share passes half of what the target would have there.
std::optional<Edge> HalfWay(const Profile& profile, double per_pixel) {
  constexpr double kLevelAt = -0.5 * (kLevelFrom + kLevelTo);
  const auto above = [&](int i) {
    const double away = SampleAt(i) - kMaskEdge;
    return profile.share[static_cast<std::size_t>(i)] -
           0.5 * std::max(kLeastEdge, 1.0 + per_pixel * (away - kLevelAt));
  };
  Edge edge;
  edge.contrast = profile.contrast;
  double nearest = kFarthest;
  bool found = false;
  for (int i = 0; i + 1 < kSamples; ++i) {
    const double a = above(i), b = above(i + 1);
    if (!(a >= 0.0 && b < 0.0)) continue;
    const double at = kFirstSample + kSampleStep * (i + a / (a - b));
    if (std::abs(at - kMaskEdge) > nearest) continue;
    nearest = std::abs(at - kMaskEdge);
    edge.at = at;
    edge.slope = (a - b) / kSampleStep;
    found = true;
  }
  return found ? std::optional(edge) : std::nullopt;
}

// A target that is shaded towards its outline has another level there than further inside: a line
// through the levels inside says which.
std::optional<Edge> EdgeAlong(const cv::Mat3f& signal, const Vector2d& from,
                              const Vector2d& normal) {
  const auto profile = ProfileAlong(signal, from, normal);
  if (!profile) return std::nullopt;
  auto edge = HalfWay(*profile, profile->per_pixel);
  const auto plain = HalfWay(*profile, 0.0);
  if (!edge || !plain) return std::nullopt;
  edge->shading = edge->at - plain->at;
  return edge;
}

// Away from the mask, along the outline's points.
std::optional<Vector2d> NormalAt(const std::vector<cv::Point>& contour, std::size_t i,
                                 const cv::Mat1b& mask) {
  const std::size_t count = contour.size();
  const cv::Point along =
      contour[(i + kTangentPoints) % count] - contour[(i + count - kTangentPoints) % count];
  Vector2d normal = Vector2d(along.y, -along.x).normalized();
  if (!normal.allFinite()) return std::nullopt;
  const auto inside = [&](double step) {
    const cv::Point p(static_cast<int>(std::lround(contour[i].x + step * normal.x())),
                      static_cast<int>(std::lround(contour[i].y + step * normal.y())));
    return cv::Rect({0, 0}, mask.size()).contains(p) && mask(p) > 0;
  };
  if (inside(3.0) == inside(-3.0)) return std::nullopt;
  return inside(3.0) ? Vector2d(-normal) : normal;
}

std::vector<OutlinePoint> OutlineOf(const cv::Mat3f& signal, const cv::Mat1b& mask, double noise) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<OutlinePoint> points;
  std::vector<double> contrasts;
  for (const auto& contour : contours) {
    if (contour.size() < kFewContourPoints) continue;
    for (std::size_t i = 0; i < contour.size(); ++i) {
      const Vector2d from(contour[i].x, contour[i].y);
      if (from.minCoeff() < kBorder || from.x() > mask.cols - 1 - kBorder ||
          from.y() > mask.rows - 1 - kBorder)
        continue;
      const auto normal = NormalAt(contour, i, mask);
      if (!normal) continue;
      const auto edge = EdgeAlong(signal, from, *normal);
      if (!edge || edge->contrast < kLeastSignal * noise) continue;
      points.push_back({from + edge->at * *normal, *normal,
                        std::hypot(kLeastSigma, noise / (edge->contrast * edge->slope),
                                   kOfShading * edge->shading)});
      contrasts.push_back(edge->contrast);
    }
  }
  std::vector<double> sorted = contrasts;
  const double least = kLeastContrast * Median(sorted);
  std::vector<OutlinePoint> clear;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (contrasts[i] >= least) clear.push_back(points[i]);
  return clear;
}

}  // namespace

std::vector<OutlinePoint> FindOutline(const cv::Mat& picture, const cv::Mat& empty,
                                      const cv::Mat1b& mask) {
  const cv::Mat3f signal = ThreeChannels(empty.empty() ? picture : cv::Mat(picture - empty));
  return OutlineOf(signal, mask, NoiseOf(signal));
}

std::vector<OutlinePoint> OutlineOfMask(const cv::Mat1b& mask) {
  cv::Mat1f smooth;
  mask.convertTo(smooth, CV_32F, 1.0 / 255.0);
  cv::GaussianBlur(smooth, smooth, {0, 0}, kMaskBlur);
  return OutlineOf(ThreeChannels(smooth), mask, 0.0);
}

}  // namespace turnlight::calib::calibrate::placement
