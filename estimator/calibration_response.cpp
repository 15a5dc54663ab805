#include "estimator/calibration_response.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/moved_pixels.h"
#include "estimator/observe/sampling.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/uncertainty/score_test.h"

namespace turnlight::estimator {
namespace {

constexpr std::size_t kPixels = 20000;
constexpr double kMostLost = 0.1;  // of the pixels: beyond, a direction is no small step
constexpr int kMostHalvings = 8;

// The sample at the solution, ready to be asked.
struct Fit {
  const CalibratedView& view;
  const observe::PixelSample& sample;
  const model::Scene& scene;
  const solve::EvaluateOptions& options;
  const uncertainty::ScoreProbe& probe;
};

// The sample with the calibration moved, and which of its pixels still lie on the surface.
struct Side {
  MovedCalibration moved;
  std::vector<std::uint8_t> seen;
  observe::Observations pixels;

  Side(const Fit& fit, MovedCalibration calibration)
      : moved(std::move(calibration)),
        pixels(observe::Moved(fit.sample, moved.poses, moved.lens ? &*moved.lens : nullptr,
                              fit.view.geometry, fit.view.rays, seen)) {}
  std::size_t Seen() const {
    return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), std::uint8_t{1}));
  }
};

// The radiances that the moved calibration makes of the sample's pixels; as they are if it has
// none.
Result<solve::Prediction> Radiances(const Fit& fit, const MovedCalibration& moved) {
  const observe::Observations& pixels = fit.sample.pixels;
  const auto channels = static_cast<std::size_t>(pixels.channels);
  solve::Prediction out(pixels.radiance.begin(), pixels.radiance.begin() + pixels.channels);
  if (!moved.radiance) return out;
  std::vector<std::vector<std::size_t>> of_keyframe(fit.view.keyframes);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels.pixel[i] != observe::Observations::kNoPixel)
      of_keyframe[fit.sample.keyframe[i]].push_back(i);
  std::vector<Status> statuses(of_keyframe.size());
  const auto take = [&](std::size_t k) {
    if (of_keyframe[k].empty()) return;
    const auto picture = moved.radiance(k);
    if (!picture) {
      statuses[k] = Forward(picture);
      return;
    }
    for (const std::size_t i : of_keyframe[k]) {
      const int row = static_cast<int>(pixels.pixel[i]) / picture->cols;
      const int column = static_cast<int>(pixels.pixel[i]) % picture->cols;
      const float* value =
          picture->ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * picture->channels();
      for (std::size_t c = 0; c < channels; ++c)
        out[c][i] = value[c] / static_cast<float>(pixels.radiance_unit);
    }
  };
  const std::size_t at_a_time = observe::KeyframesInFlight(
      static_cast<std::size_t>(fit.view.rays.width()) * fit.view.rays.height());
  for (std::size_t first = 0; first < of_keyframe.size(); first += at_a_time)
    ParallelFor(std::min(at_a_time, of_keyframe.size() - first),
                [&](std::size_t i) { take(first + i); });
  for (const Status& status : statuses)
    if (!status) return Forward(status);
  return out;
}

// The change of the gradient for one sigma along a direction.
Result<Eigen::VectorXd> GradientOf(const Fit& fit, const CalibrationErrors& errors,
                                   std::size_t item, std::size_t direction) {
  double sigmas = 1.0;
  const auto sides = [&] {
    return std::array{Side(fit, errors.move(item, direction, sigmas)),
                      Side(fit, errors.move(item, direction, -sigmas))};
  };
  std::array<Side, 2> both = sides();
  const double least = (1.0 - kMostLost) * static_cast<double>(fit.sample.pixels.used);
  for (int i = 0; i < kMostHalvings; ++i) {
    if (static_cast<double>(std::min(both[0].Seen(), both[1].Seen())) >= least) break;
    sigmas *= 0.5;
    both = sides();
  }
  // Of the residuals, model minus observed.
  solve::Prediction change = solve::Predict(both[0].pixels, fit.scene, fit.options);
  uncertainty::AddTimes(-1.0, solve::Predict(both[1].pixels, fit.scene, fit.options), change);
  if (both[0].moved.radiance || both[1].moved.radiance)
    for (std::size_t side = 0; side < 2; ++side) {
      const auto radiances = Radiances(fit, both[side].moved);
      if (!radiances) return Forward(radiances);
      uncertainty::AddTimes(side == 0 ? -1.0 : 1.0, *radiances, change);
    }
  for (auto& channel : change)
    for (std::size_t i = 0; i < channel.size(); ++i)
      if (both[0].seen[i] == 0 || both[1].seen[i] == 0) channel[i] = 0.0f;
  return fit.probe.Of(change, 0.5 / sigmas).cross_hessian;
}

}  // namespace

Result<std::optional<uncertainty::CalibrationResponse>> RespondToCalibration(
    const CalibratedView& view, const observe::Observations& all, const solve::Solution& solution,
    const CalibrationErrors& errors, const StopFlag* stop) {
  if (errors.items.empty()) return std::optional<uncertainty::CalibrationResponse>();
  const observe::PixelSample sample = observe::SampleOfKeyframes(
      all, kPixels, 5, solution.evaluate.shadows.usable.get(), solution.scene.flickers());
  const model::Scene& scene = solution.scene;
  solve::EvaluateOptions options;
  options.huber = solution.evaluate.huber;
  options.samples_per_side = solve::FootprintSamples(sample.pixels, scene.reflectance, 2);
  options.shadows = solve::CastShadows(sample.pixels, scene);
  const uncertainty::ScoreProbe probe(sample.pixels, scene, options);
  const Fit fit{view, sample, scene, options, probe};
  uncertainty::CalibrationResponse out;
  out.as_modelled = solve::Evaluate(sample.pixels, scene, options);
  for (std::size_t item = 0; item < errors.items.size(); ++item) {
    const std::size_t directions = errors.items[item].directions;
    Eigen::MatrixXd gradients(out.as_modelled.gradient.size(),
                              static_cast<Eigen::Index>(directions));
    for (std::size_t d = 0; d < directions; ++d) {
      if (StopRequested(stop)) return InterruptedError();
      auto gradient = GradientOf(fit, errors, item, d);
      if (!gradient) return Forward(gradient);
      gradients.col(static_cast<Eigen::Index>(d)) = *gradient;
    }
    out.items.push_back({errors.items[item].words, std::move(gradients)});
  }
  return std::optional(std::move(out));
}

}  // namespace turnlight::estimator
