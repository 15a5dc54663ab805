#include "calib/calibrate/probe/spots.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "calib/calibrate/probe/peaks.h"
#include "calib/calibrate/probe/spot_shape.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// ---- What counts. Lengths are shares of the ball's radius, heights those of what they are named
// after.

// The opening's square. Light from a patch of 23 degrees (a window, a wall) fills it and is broad.
constexpr double kBroadShare = 0.2;
// Nearer to the outline, a pixel's footprint grows without bound. (n.v; the normals there are more
// than 78 degrees from the camera.)
constexpr double kRimCosine = 0.2;
constexpr int kRimPixels = 2;  // mixed with the background by blur and outline's error
// A peak is told from noise, from texture and from the tails of a brighter one.
constexpr double kMinNoise = 8.0;        // sigmas
constexpr double kMinGroundShare = 0.1;  // of the radiance around it
constexpr double kMinPeakShare = 0.02;   // of the highest peak
constexpr double kSplitDepth = 0.35;     // of the lower peak: two lamps, not one with noise
// A lamp's mirror image outshines what is around it: a matte surface lit by the same lamp is darker
// than the lamp by orders of magnitude, texture and weak inter-reflections are not.
constexpr double kLightGroundShare = 0.5;
constexpr double kLightPeakShare = 0.1;  // of the brightest light, if nothing is clipped
constexpr double kLightIrradianceShare = 0.03;
// Where other spots are clipped, one that is not even at half of white may be a lit object.
constexpr double kLightWhiteShare = 0.5;
constexpr double kMaxExtentDeg = 15.0;  // a window, not a lamp

// The ball's region of the picture that can be looked at, and a frame around it.
struct Region {
  cv::Rect box;
  cv::Mat1b usable;  // of the box: 255 or 0
};

cv::Mat1b FilledMask(const cv::Mat1b& mask) {
  cv::Mat1b outside;
  cv::copyMakeBorder(mask == 0, outside, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::floodFill(outside, {0, 0}, 128);
  return cv::Mat1b(outside(cv::Rect(1, 1, mask.cols, mask.rows)) != 128);
}

Region FindRegion(const cv::Mat1b& mask, const BallView& view) {
  cv::Mat1b usable(view.rays->height(), view.rays->width(), uchar{0});
  ParallelFor(static_cast<std::size_t>(usable.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    for (int column = 0; column < usable.cols; ++column) {
      const auto seen = MirrorOnBall(view.ball, view.X_WC.translation,
                                     view.X_WC.rotation * view.rays->Ray(column, row));
      if (seen) usable(row, column) = 255;
    }
  });
  if (!mask.empty()) usable &= FilledMask(mask);
  cv::erode(usable, usable, {}, {-1, -1}, kRimPixels);
  for (int row = 0; row < usable.rows; ++row) {
    for (int column = 0; column < usable.cols; ++column) {
      if (!usable(row, column)) continue;
      const auto seen = MirrorOnBall(view.ball, view.X_WC.translation,
                                     view.X_WC.rotation * view.rays->Ray(column, row));
      if (!seen || seen->cosine < kRimCosine) usable(row, column) = 0;
    }
  }
  // With what bounds it, so that a spot that is cut is seen to be.
  cv::Rect box = cv::boundingRect(usable);
  if (box.empty()) return {};
  box = cv::Rect(box.x - 1, box.y - 1, box.width + 2, box.height + 2) &
        cv::Rect({0, 0}, usable.size());
  return {box, usable(box).clone()};
}

// The mean of the channels; not finite counts as clipped, with the brightest finite value.
cv::Mat1f GreyOf(const LinearImage& picture, const cv::Rect& box, const cv::Mat1b& usable) {
  cv::Mat1f grey;
  if (picture.radiance.channels() == 1)
    grey = picture.radiance(box).clone();
  else
    cv::transform(picture.radiance(box), grey, cv::Matx13f(1.0f / 3, 1.0f / 3, 1.0f / 3));
  float brightest = 0.0f;
  for (int row = 0; row < grey.rows; ++row)
    for (int column = 0; column < grey.cols; ++column)
      if (usable(row, column) && std::isfinite(grey(row, column)))
        brightest = std::max(brightest, grey(row, column));
  for (float& value : grey)
    if (!std::isfinite(value)) value = brightest;
  return grey;
}

double NoiseOf(const cv::Mat1f& grey, const cv::Mat1b& usable, const cv::Mat1b& clipped) {
  std::vector<double> sizes;
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 1; column + 1 < grey.cols; ++column) {
      bool good = true;
      for (int x = column - 1; x <= column + 1; ++x)
        good = good && usable(row, x) && !clipped(row, x);
      if (good)
        sizes.push_back(std::abs(double{grey(row, column - 1)} - 2.0 * grey(row, column) +
                                 grey(row, column + 1)));
    }
  }
  return SigmaOfSecondDifference(Median(sizes), kMedianOfNormal);
}

// The picture without what is smaller than the square: an opening within the region, at a scale at
// which the square is small.
cv::Mat1f BroadPart(const cv::Mat1f& grey, const cv::Mat1b& usable, double radius_px) {
  constexpr double kCoarseRadius = 80.0;
  const double scale = std::min(1.0, kCoarseRadius / radius_px);
  const int side =
      std::max(3, 1 + 2 * static_cast<int>(std::lround(0.5 * kBroadShare * radius_px * scale)));
  const cv::Size coarse(std::max(1, static_cast<int>(std::lround(grey.cols * scale))),
                        std::max(1, static_cast<int>(std::lround(grey.rows * scale))));
  cv::Mat1f inside, weight, value;
  usable.convertTo(inside, CV_32F, 1.0 / 255.0);
  cv::resize(inside, weight, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(grey.mul(inside), value, coarse, 0, 0, cv::INTER_AREA);
  const cv::Mat square = cv::Mat::ones(side, side, CV_8U);
  const cv::Mat outside = weight < 0.25f;
  value /= cv::max(weight, 0.25f);
  value.setTo(FLT_MAX, outside);
  cv::erode(value, value, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(FLT_MAX));
  value.setTo(-FLT_MAX, outside);
  cv::dilate(value, value, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(-FLT_MAX));
  // Beyond the region, what is nearest to it: interpolation at its border stays finite.
  cv::Mat1f wide;
  cv::dilate(value, wide, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT,
             cv::Scalar(-FLT_MAX));
  wide.copyTo(value, outside);
  value.setTo(0.0f, value == -FLT_MAX);
  cv::Mat1f broad;
  cv::resize(value, broad, grey.size(), 0, 0, cv::INTER_LINEAR);
  return broad;
}

void ExplainLevels(double white, std::vector<Spot>& spots) {
  double peak = 0.0, irradiance = 0.0;
  bool any_clipped = false;
  for (const Spot& spot : spots) {
    if (!spot.why.empty()) continue;
    peak = std::max(peak, spot.peak);
    irradiance = std::max(irradiance, spot.irradiance);
    any_clipped = any_clipped || spot.clipped;
  }
  for (Spot& spot : spots) {
    if (!spot.why.empty()) continue;
    if (!spot.clipped && any_clipped && spot.peak + spot.ground < kLightWhiteShare * white)
      spot.why = "not bright: others are clipped, and this may be a lit object";
    else if (spot.peak < kLightPeakShare * peak ||
             spot.irradiance < kLightIrradianceShare * irradiance)
      spot.why = "much weaker than the brightest: an inter-reflection, or a weak lamp";
    else
      spot.kind = SpotKind::kLight;
  }
}

// A level of the broad part that most of the ball is below.
double BrightGround(const cv::Mat1f& ground, const cv::Mat1b& usable) {
  std::vector<double> levels;
  for (int row = 0; row < ground.rows; ++row)
    for (int column = 0; column < ground.cols; ++column)
      if (usable(row, column)) levels.push_back(ground(row, column));
  return LowerQuantile(levels, 0.95);
}

// Whether a peak is a corner of something broad: the square of the opening does not fit into those
// of a window that stands askew. At half of the peak's height it is then one with the broad part.
bool BelongsToBroad(const cv::Mat1f& smooth, const cv::Mat1f& ground, const cv::Mat1b& usable,
                    const Peak& peak) {
  constexpr float kHalf = 0.5f, kLow = 0.25f;  // of the height
  constexpr double kMostly = 0.4;              // of the pixels
  const cv::Mat1b one = FloodFrom(smooth, usable, peak.at, ground(peak.at) + kHalf * peak.height);
  const cv::Mat1b broad = smooth - ground < kLow * peak.height;
  return cv::countNonZero(one & broad) > kMostly * cv::countNonZero(one);
}

std::string WhyNoLight(const Spot& spot, double bright_ground, bool cut) {
  if (cut) return "cut by the picture's edge, the ball's rim or what hides the ball";
  if (spot.extent_deg > kMaxExtentDeg) return "too extended for a lamp: a window or a lit surface";
  if (spot.peak < kLightGroundShare * std::max(spot.ground, bright_ground))
    return "hardly brighter than the ball is by itself: texture, or a weak highlight";
  return "";
}

}  // namespace

SpotsFound FindSpots(const LinearImage& picture, const cv::Mat1b& mask, const BallView& view) {
  SpotsFound found;
  const Region region = FindRegion(mask, view);
  const double radius_px = RadiusInPixels(view);
  if (region.box.width < 5 || region.box.height < 5 || !(radius_px > 5.0)) return found;
  found.ball_seen = true;
  const cv::Mat1f grey = GreyOf(picture, region.box, region.usable);
  const cv::Mat1b clipped = picture.saturated(region.box);
  found.noise = NoiseOf(grey, region.usable, clipped);
  cv::Mat1f smooth;
  constexpr double kSmoothing = 0.7;  // pixels: noise has fewer peaks, lamps hardly merge
  cv::GaussianBlur(grey, smooth, {}, kSmoothing, kSmoothing, cv::BORDER_REPLICATE);
  const cv::Mat1f ground = BroadPart(smooth, region.usable, radius_px);
  const cv::Mat1f rest = smooth - ground;

  double highest = 0.0;
  cv::minMaxLoc(rest, nullptr, &highest, nullptr, nullptr, region.usable);
  const double floor = std::max(kMinNoise * found.noise, kMinPeakShare * highest);
  const double bright_ground = BrightGround(ground, region.usable);
  double white = 0.0;  // the level at which the picture clips
  for (const Peak& peak : FindPeaks(rest, region.usable, static_cast<float>(0.5 * floor),
                                    kSplitDepth, static_cast<float>(kMinNoise * found.noise))) {
    if (peak.height < std::max(floor, kMinGroundShare * ground(peak.at))) continue;
    const SpotShape shape = MeasureShape(
        {grey, ground, rest, clipped, region.usable, region.box.tl(), found.noise}, peak, view);
    if (!shape.measured) continue;
    Spot spot = shape.spot;
    spot.why = BelongsToBroad(smooth, ground, region.usable, peak)
                   ? "part of something broad and bright: a window or a lit surface"
                   : WhyNoLight(spot, bright_ground, shape.cut);
    if (spot.clipped) white = std::max(white, spot.peak + spot.ground);
    found.spots.push_back(spot);
  }
  ExplainLevels(white, found.spots);
  std::stable_sort(found.spots.begin(), found.spots.end(), [](const Spot& a, const Spot& b) {
    return std::pair(a.kind, -a.irradiance) < std::pair(b.kind, -b.irradiance);
  });
  double spot_pixels = 0.0;
  for (const Spot& spot : found.spots)
    if (spot.clipped) spot_pixels += spot.area_px;
  const double clipped_pixels = cv::countNonZero(clipped & region.usable);
  found.clipped_share =
      std::max(0.0, clipped_pixels - spot_pixels) / cv::countNonZero(region.usable);
  return found;
}

}  // namespace turnlight::calib::calibrate::probe
