#include "estimator/consistency/frame_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/sampling.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/settled_solve.h"
#include "estimator/start/find_start.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr double kShare = 0.8;  // of the pixels, so that highlights and edges do not decide
constexpr std::size_t kFew = 2500, kSample = 8000, kSolved = 20000;  // pixels of a fit
constexpr std::uint64_t kSeed = 3;
constexpr double kDark = 1e-9;

double QuantileLeft(const std::vector<float>& picture, const std::vector<float>& model,
                    double gain) {
  std::vector<float> left(picture.size());
  for (std::size_t i = 0; i < left.size(); ++i)
    left[i] = std::abs(picture[i] - static_cast<float>(gain) * model[i]);
  return static_cast<double>(LowerQuantile(left, kShare));
}

Fit SolveFrom(const observe::Observations& solve_on, const model::Scene& from,
              const StopFlag* stop) {
  solve::SolveOptions options;
  options.max_iterations = 30;
  options.function_tolerance = 1e-5;
  options.stop = stop;
  solve::Solution solution = solve::SolveSettled(solve_on, from, options, 2);
  const double values = solve::ValueCount(solve_on, solution.evaluate);
  return {
      std::move(solution.scene),
      solve_on.radiance_unit * std::sqrt(2.0 * solution.equations.cost / std::max(values, 1.0))};
}

// Starts on some pixels of all, solves on others.
Fit FitBoth(const observe::Observations& all, const observe::Observations& start_on,
            const observe::Observations& solve_on, model::ModelChoice choice,
            const StopFlag* stop) {
  // A factor would explain a frame that is odd.
  choice.changing = false;
  const double noise = observe::EstimateNoise(all);
  const observe::IntensityMap map = observe::MakeIntensityMap(all);
  const start::Start found = start::FindStart(start_on, noise, map, std::nullopt, choice, stop);
  return SolveFrom(solve_on, found.scene, stop);
}

}  // namespace

std::vector<cv::Mat1f> ModelPictures(const observe::Observations& all, const model::Scene& scene,
                                     cv::Size size) {
  solve::EvaluateOptions options;
  options.samples_per_side =
      solve::FootprintSamples(all, scene.reflectance, all.subsampled ? 1 : 2);
  options.shadows = solve::CastShadows(all, scene);
  const solve::Prediction model = solve::Predict(all, scene, options);
  std::vector<cv::Mat1f> out(all.tile_begin.size() - 1);
  ParallelFor(out.size(), [&](std::size_t k) {
    out[k] = cv::Mat1f(size, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = all.tile_begin[k] * observe::kTile;
         i < all.tile_begin[k + 1] * observe::kTile; ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel) continue;
      if (options.shadows.usable && (*options.shadows.usable)[i] == 0) continue;
      const int at = static_cast<int>(all.pixel[i]);
      out[k](at / size.width, at % size.width) =
          static_cast<float>(all.radiance_unit) * model[0][i];
    }
  });
  return out;
}

FrameResidual Compare(const cv::Mat1f& picture, const cv::Mat1f& model) {
  std::vector<float> shown, expected;
  double cross = 0.0, squares = 0.0;
  for (int row = 0; row < model.rows; ++row)
    for (int column = 0; column < model.cols; ++column) {
      const float value = model(row, column);
      if (!std::isfinite(value)) continue;
      shown.push_back(picture(row, column));
      expected.push_back(value);
      cross += static_cast<double>(value) * static_cast<double>(shown.back());
      squares += static_cast<double>(value) * static_cast<double>(value);
    }
  FrameResidual out;
  out.pixels = shown.size();
  if (shown.empty()) return out;
  out.level = std::sqrt(squares / static_cast<double>(shown.size()));
  if (out.level > kDark) out.gain = cross / squares;
  out.left_free = QuantileLeft(shown, expected, out.gain);
  out.left = QuantileLeft(shown, expected, std::clamp(out.gain, kLeastGain, kMostGain));
  return out;
}

observe::Observations Only(const observe::Observations& all, const std::vector<bool>& frames) {
  observe::Observations out = all;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (frames[k]) continue;
    for (std::size_t i = all.tile_begin[k] * observe::kTile;
         i < all.tile_begin[k + 1] * observe::kTile; ++i) {
      if (out.pixel[i] == observe::Observations::kNoPixel) continue;
      out.pixel[i] = observe::Observations::kNoPixel;
      --out.used;
    }
  }
  return out;
}

Fit FitAnew(const observe::Observations& all, const model::ModelChoice& choice,
            const StopFlag* stop) {
  const observe::Observations sample = observe::EvenSubsample(all, kSolved, kSeed, nullptr);
  return FitBoth(all, all, sample, choice, stop);
}

Fit FitQuickly(const observe::Observations& all, model::ModelChoice choice, const StopFlag* stop) {
  if (!choice.diffuse) choice.diffuse = model::DiffuseModel::kLambert;
  if (!choice.specular) choice.specular = model::SpecularModel::kPhong;
  const observe::Observations few = observe::EvenSubsample(all, kFew, kSeed, nullptr);
  const observe::Observations sample = observe::EvenSubsample(all, kSample, kSeed + 1, nullptr);
  return FitBoth(all, few, sample, choice, stop);
}

Fit FitFrom(const observe::Observations& all, const model::Scene& from, const StopFlag* stop) {
  return SolveFrom(observe::EvenSubsample(all, kSample, kSeed + 1, nullptr), from, stop);
}

model::Scene FitRobustly(const observe::Observations& all, const model::Scene& from,
                         const StopFlag* stop) {
  const observe::Observations sample = observe::EvenSubsample(all, kSample, kSeed, nullptr);
  solve::SolveOptions options;
  options.max_iterations = 15;
  options.function_tolerance = 1e-5;
  options.stop = stop;
  solve::EvaluateOptions evaluate;
  evaluate.shadows = solve::CastShadows(sample, from);
  const solve::Prediction model = solve::Predict(sample, from, evaluate);
  std::vector<float> left;
  for (std::size_t i = 0; i < sample.size(); ++i)
    if (sample.pixel[i] != observe::Observations::kNoPixel)
      left.push_back(std::abs(model[0][i] - sample.radiance[0][i]));
  options.evaluate.huber = std::max(static_cast<double>(Median(left)) / kMedianOfNormal, 1e-6);
  return solve::SolveSettled(sample, from, options, 1).scene;
}

}  // namespace turnlight::estimator::consistency
