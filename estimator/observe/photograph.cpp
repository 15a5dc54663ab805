#include "estimator/observe/photograph.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations_builder.h"
#include "estimator/observe/radiance_unit.h"

namespace turnlight::estimator::observe {
namespace {

constexpr double kFloor = 0.0007;    // of the brightest
constexpr double kShare = 0.02;      // of a value
constexpr double kShift = 0.5;       // pixels
constexpr double kBeside = 0.15;     // of a value, beside clipped pixels
constexpr double kClipped = 0.15;    // of a clipped pixel's value
constexpr double kContrast = 0.15;   // of the surround: a highlight
constexpr double kAboveNoise = 6.0;  // sigmas of a pixel: the least highlight
constexpr double kScale = 2.0, kSurround = 2.5;
constexpr int kGrown = 3, kGrownClipped = 4;  // pixels

cv::Mat1b Grown(const cv::Mat1b& mask, int by) {
  cv::Mat1b out;
  cv::dilate(mask, out, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * by + 1, 2 * by + 1}));
  return out;
}

// What is bright against its surround at any scale, and clipped, each grown a little.
cv::Mat1b HighlightsOf(const cv::Mat1f& grey, const cv::Mat1b& inside, const cv::Mat1b& clipped,
                       double noise) {
  cv::Mat1f share;
  inside.convertTo(share, CV_32F, 1.0 / 255.0);
  cv::Mat1b bright(grey.size(), std::uint8_t{0});
  for (const double scale : {1.0, kScale, 2.0 * kScale}) {
    const cv::Mat1f around = MeanInside(grey, share, kSurround * scale);
    bright |= (MeanInside(grey, share, scale) - around) >
              cv::max(kContrast * around, kAboveNoise * noise);
  }
  return (Grown(bright, kGrown) | Grown(clipped, kGrownClipped)) & inside;
}

// The slope's size, radiance per pixel.
cv::Mat1f SlopeOf(const cv::Mat1f& grey) {
  cv::Mat1f dx, dy, out;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 3, 0.125);
  cv::magnitude(dx, dy, out);
  return out;
}

// What belongs to a keyframe's pixels besides their values.
struct Planes {
  cv::Mat1b marks;     // as in Observations::at_white
  cv::Mat1f variance;  // of what a model will leave; divided by what a pixel counts for
};

Planes PlanesOf(const model::Keyframe& keyframe, const cv::Mat1b& inside, double correlated) {
  const cv::Mat1f grey = GreyOf(keyframe.image.radiance);
  const cv::Mat1b clipped = keyframe.image.saturated & inside;
  const cv::Mat1b beside = Grown(clipped, 1);
  const double noise = NoiseOf(grey, inside);
  const cv::Mat1b highlights = HighlightsOf(grey, inside, clipped, noise);
  const cv::Mat1f slope = SlopeOf(grey);
  double brightest = 0.0;
  cv::minMaxLoc(grey, nullptr, &brightest, nullptr, nullptr, inside);
  Planes out{cv::Mat1b(grey.size(), std::uint8_t{0}), cv::Mat1f(grey.size(), 1.0f)};
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      if (inside(y, x) == 0) continue;
      const double value = std::max(static_cast<double>(grey(y, x)), 0.0);
      double sigma = std::hypot(std::hypot(kFloor * brightest, noise), kShare * value,
                                kShift * static_cast<double>(slope(y, x)));
      if (beside(y, x) != 0) sigma = std::max(sigma, kBeside * value);
      if (clipped(y, x) != 0) sigma = kClipped * value;
      double variance = sigma * sigma;
      if (!keyframe.image.variance.empty())
        variance += static_cast<double>(keyframe.image.variance(y, x));
      if (highlights(y, x) == 0) variance *= correlated;
      out.variance(y, x) = static_cast<float>(variance);
      out.marks(y, x) = static_cast<std::uint8_t>((clipped(y, x) != 0 ? 7 : 0) |
                                                  (highlights(y, x) != 0 ? kInHighlight : 0));
    }
  return out;
}

// Of so many pixels at most `most` in all keyframes: one in how many is taken.
double OneIn(std::size_t count, std::size_t keyframes, std::size_t most) {
  return std::max(
      static_cast<double>(count * keyframes) / static_cast<double>(std::max<std::size_t>(most, 1)),
      1.0);
}

// Takes some of the pixels, those that count together for what they leave out; of highlights each
// counts for itself. Gives how many independent pixels are taken.
double Thin(const PhotographOptions& options, std::uint64_t stream, std::size_t keyframes,
            KeyframeTracer& tracer, Planes& planes) {
  std::size_t shaded = 0, bright = 0;
  const auto is_bright = [&](int y, int x) { return (planes.marks(y, x) & kInHighlight) != 0; };
  const cv::Mat1b& flags = tracer.flags();
  for (int y = 0; y < flags.rows; ++y)
    for (int x = 0; x < flags.cols; ++x)
      if (flags(y, x) == 0) ++(is_bright(y, x) ? bright : shaded);
  const double one_shaded = OneIn(shaded, keyframes, options.most_shaded),
               one_bright = OneIn(bright, keyframes, options.most_bright);
  const double counts = std::min(one_shaded, options.correlated);
  const RandomStream random(1, stream);
  cv::Mat1b left_out(flags.size(), std::uint8_t{0});
  for (int y = 0; y < flags.rows; ++y)
    for (int x = 0; x < flags.cols; ++x) {
      if (flags(y, x) != 0) continue;
      const bool in_highlight = is_bright(y, x);
      const auto at = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(flags.cols) +
                      static_cast<std::uint64_t>(x);
      if (random.Uniform(at) * (in_highlight ? one_bright : one_shaded) >= 1.0)
        left_out(y, x) = 255;
      else if (!in_highlight)
        planes.variance(y, x) /= static_cast<float>(counts);
    }
  tracer.LeaveOut(left_out);
  return static_cast<double>(bright) / one_bright +
         static_cast<double>(shaded) / one_shaded * counts / options.correlated;
}

// Weights by the variances, and how many pixels they make.
void Weigh(Observations& all) {
  all.weight.assign(all.size(), 0.0f);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel && all.variance[i] > 0.0f)
      all.weight[i] = static_cast<float>(kWeighedSigma) / std::sqrt(all.variance[i]);
}

}  // namespace

Result<Photograph> TakePhotograph(const model::KeyframeSource& keyframes,
                                  const target::Geometry& geometry, const calib::RayGrid& rays,
                                  const PhotographOptions& options) {
  Photograph out;
  std::vector<Spot> spots;
  ObservationsBuilder builder(geometry, rays, keyframes.size(), kAllPixels);
  builder.MarkPixels();
  double independent = 0.0;
  const auto put = [&](std::size_t k, const model::Keyframe& keyframe, KeyframeTracer& tracer) {
    const cv::Mat1b inside = (tracer.flags() & (kOffTarget | kSilhouette | kGrazing)) == 0;
    for (Spot& spot : FindSpots(keyframe, k, inside, geometry, rays)) spots.push_back(spot);
    Planes planes = PlanesOf(keyframe, inside, options.correlated);
    independent += Thin(options, k, keyframes.size(), tracer, planes);
    model::Keyframe weighed = keyframe;
    weighed.image.variance = planes.variance;
    builder.Add(weighed, tracer, &planes.marks);
  };
  if (const Status status =
          TraceKeyframes(keyframes, geometry, rays, options.stop, put, Clipped::kKept);
      !status)
    return Forward(status);
  out.pixels = builder.Finish();
  SetRadianceUnit(out.pixels);
  // Not all neighbours are there, and a shadow's edge is what a shift of the picture may change.
  out.pixels.subsampled = true;
  Weigh(out.pixels);
  out.pixels.independent = independent;
  out.spots = ClusterSpots(spots, out.pixels.reference, out.pixels.radius);
  return out;
}

}  // namespace turnlight::estimator::observe
