#include "estimator/view_information.h"

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations_builder.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/shadows.h"

namespace turnlight::estimator {
namespace {

using observe::Observations;

// Of a view: of more, whole blocks are left out and the others count for them.
constexpr std::size_t kMostPixels = 50'000;
// Pixels beside those that are seen get the radiance of their neighbours so many pixels far, for
// noise is that of a mean over 5 x 5.
constexpr int kReach = 2;

// A picture that says nothing but where the target is.
model::Keyframe BlankKeyframe(const CandidateView& view, const calib::RayGrid& rays,
                              bool weighted) {
  const cv::Size size(rays.width(), rays.height());
  model::Keyframe out;
  out.image.radiance = cv::Mat1f(size, 0.5f);
  out.image.saturated = cv::Mat1b(size, std::uint8_t{0});
  if (weighted) out.image.variance = cv::Mat1f(size, 1.0f);
  out.mask = cv::Mat1b(size, std::uint8_t{255});
  out.X_WC = view.poses.X_WC;
  out.X_WT = view.poses.X_WT;
  return out;
}

struct Seen {
  Observations pixels;  // in white, their radiances without meaning
  double scale = 1.0;   // each stands for so many
};

Seen See(const CandidateView& view, const target::Geometry& geometry, const calib::RayGrid& rays,
         bool weighted) {
  const model::Keyframe blank = BlankKeyframe(view, rays, weighted);
  observe::KeyframeTracer tracer(blank, 0, geometry, rays);
  observe::ObservationsBuilder builder(geometry, rays, 1, kMostPixels);
  builder.Add(blank, tracer);
  Seen out{builder.Finish()};
  out.scale = 1.0 / out.pixels.blocks.share;
  return out;
}

// The radiances, in white, as a picture.
cv::Mat PictureOf(const solve::Prediction& radiances, const Observations& pixels, cv::Size size) {
  constexpr float kUnseen = -1e30f;
  const int channels = static_cast<int>(radiances.size());
  cv::Mat out(size, CV_32FC(channels), cv::Scalar::all(kUnseen));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == Observations::kNoPixel) continue;
    const int row = static_cast<int>(pixels.pixel[i]) / size.width;
    const int column = static_cast<int>(pixels.pixel[i]) % size.width;
    float* value = out.ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * channels;
    for (int c = 0; c < channels; ++c)
      value[c] =
          static_cast<float>(pixels.radiance_unit) * radiances[static_cast<std::size_t>(c)][i];
  }
  cv::Mat around;
  cv::dilate(out, around, cv::Mat1b::ones(2 * kReach + 1, 2 * kReach + 1));
  cv::Mat flat = out.reshape(1), flat_around = around.reshape(1);
  flat_around.copyTo(flat, flat == kUnseen);
  flat.setTo(0.0f, flat == kUnseen);
  return out;
}

// Takes the noise of the predicted picture into the pixels; which of them do not clip.
std::vector<std::uint8_t> TakePicture(const calib::LinearImage& picture, Observations& pixels) {
  cv::Mat1b clipped;
  cv::dilate(picture.saturated, clipped, cv::Mat1b::ones(3, 3));
  std::vector<std::uint8_t> usable(pixels.size(), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == Observations::kNoPixel) continue;
    const int row = static_cast<int>(pixels.pixel[i]) / clipped.cols;
    const int column = static_cast<int>(pixels.pixel[i]) % clipped.cols;
    if (clipped(row, column) != 0) usable[i] = 0;
    if (pixels.weighted) pixels.variance[i] = picture.variance(row, column);
  }
  return usable;
}

solve::EvaluateOptions OptionsFor(const Observations& pixels, const model::Scene& scene) {
  solve::EvaluateOptions options;
  options.samples_per_side = solve::FootprintSamples(pixels, scene.reflectance, 2);
  options.shadows = solve::CastShadows(pixels, scene);
  return options;
}

}  // namespace

Eigen::MatrixXd InformationOf(const CandidateView& view, const FitState& fit,
                              const target::Geometry& geometry, const calib::RayGrid& rays,
                              const Sensor& sensor) {
  const int columns = model::Parameters(fit.scene, fit.frame.channels).count();
  Seen seen = See(view, geometry, rays, fit.frame.weighted);
  if (seen.pixels.used == 0) return Eigen::MatrixXd::Zero(columns, columns);
  Observations placed = seen.pixels;
  observe::CompleteIn(fit.frame, placed);
  const solve::EvaluateOptions options = OptionsFor(placed, fit.scene);
  const solve::Prediction predicted = solve::Predict(placed, fit.scene, options);
  const cv::Mat picture = PictureOf(predicted, placed, {rays.width(), rays.height()});
  const calib::LinearImage taken =
      calib::Linearise(calib::Encode(picture, sensor.radiometry, view.exposure, sensor.depth),
                       sensor.radiometry, view.exposure);
  auto usable = TakePicture(taken, seen.pixels);
  observe::CompleteIn(fit.frame, seen.pixels);
  // The residuals are 0 where the model says what is seen.
  for (std::size_t c = 0; c < predicted.size(); ++c) seen.pixels.radiance[c] = predicted[c];
  solve::EvaluateOptions counted = options;
  if (options.shadows.usable)
    std::transform(usable.begin(), usable.end(), options.shadows.usable->begin(), usable.begin(),
                   [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a & b); });
  counted.shadows.usable = std::make_shared<const std::vector<std::uint8_t>>(std::move(usable));
  return seen.scale * fit.kept_share * fit.loss_share *
         solve::Evaluate(seen.pixels, fit.scene, counted).hessian;
}

}  // namespace turnlight::estimator
