#include "estimator/consistency/odd_frames.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/statistics.h"
#include "estimator/consistency/oddness.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr double kCore = 0.7;  // share of the frames that a fit concentrates on
constexpr int kConcentrations = 6, kRounds = 3;
constexpr std::size_t kThirds = 3, kFewestOfThird = 100;  // pixels
constexpr double kWellLeft = 0.01;                        // of the level: no other start is tried
constexpr double kTimesUsual = 4.0, kSigmas = 6.0;
constexpr double kLeastLeft = 0.004;  // of the level
constexpr double kLeastGainStep = 0.03;
constexpr std::size_t kNeighbours = 2;  // on each side

double MedianOf(std::vector<double> values) { return Median(values); }

// The median distance from the median, as a sigma.
double Scatter(const std::vector<double>& values) {
  const double middle = MedianOf(values);
  std::vector<double> apart;
  for (const double value : values) apart.push_back(std::abs(value - middle));
  return MedianOf(apart) / kMedianOfNormal;
}

std::vector<double> Lefts(const std::vector<FrameResidual>& residuals) {
  std::vector<double> out;
  for (const FrameResidual& residual : residuals)
    if (residual.pixels > 0) out.push_back(residual.left);
  return out;
}

double Level(const std::vector<FrameResidual>& residuals) {
  std::vector<double> levels;
  for (const FrameResidual& residual : residuals) levels.push_back(residual.level);
  return MedianOf(levels);
}

// The frames of which least is left.
std::vector<bool> Core(const std::vector<FrameResidual>& residuals) {
  std::vector<std::size_t> order(residuals.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return residuals[a].left < residuals[b].left;
  });
  std::vector<bool> core(residuals.size(), false);
  const auto count = static_cast<std::size_t>(std::ceil(kCore * static_cast<double>(order.size())));
  for (std::size_t i = 0; i < count; ++i) core[order[i]] = true;
  return core;
}

// What is left of those, in the mean.
double LeftOfCore(const std::vector<FrameResidual>& residuals) {
  const std::vector<bool> core = Core(residuals);
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k)
    if (core[k]) sum += residuals[k].left, count += 1.0;
  return count > 0.0 ? sum / count : 0.0;
}

// How much each gain is beyond the middle of its neighbours', frames that are odd already aside.
std::vector<double> GainSteps(const std::vector<FrameResidual>& residuals,
                              const std::vector<bool>& aside) {
  std::vector<double> steps(residuals.size(), 0.0);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (aside[k]) continue;
    std::vector<double> around;
    for (std::size_t i = k, found = 0; i-- > 0 && found < kNeighbours;)
      if (!aside[i]) around.push_back(residuals[i].gain), ++found;
    for (std::size_t i = k + 1, found = 0; i < residuals.size() && found < kNeighbours; ++i)
      if (!aside[i]) around.push_back(residuals[i].gain), ++found;
    if (around.size() < 2) continue;
    steps[k] = residuals[k].gain - InterpolatedQuantile(around, 0.5);
  }
  return steps;
}

struct Verdict {
  std::vector<bool> odd, odd_mask;
  double usual = 0.0, level = 0.0;
};

Verdict Judge(const std::vector<FrameResidual>& residuals, const std::vector<double>& on_mask,
              double noise) {
  Verdict out;
  const std::vector<double> lefts = Lefts(residuals);
  out.usual = MedianOf(lefts);
  out.level = Level(residuals);
  const double limit = std::max({kTimesUsual * out.usual, out.usual + kSigmas * Scatter(lefts),
                                 kLeastLeft * out.level, 3.0 * noise});
  for (const FrameResidual& residual : residuals)
    out.odd.push_back(residual.pixels > 0 && residual.left > limit);
  const std::vector<double> steps = GainSteps(residuals, out.odd);
  const double step_limit = std::max(kLeastGainStep, kSigmas * Scatter(steps));
  const double mask = MedianOf(on_mask);
  const double mask_limit = std::max(kMaskStep, kSigmas * Scatter(on_mask));
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    out.odd_mask.push_back(mask - on_mask[k] > mask_limit);
    if (std::abs(steps[k]) > step_limit || out.odd_mask[k]) out.odd[k] = true;
  }
  return out;
}

std::size_t CountOf(const std::vector<bool>& odd) {
  return static_cast<std::size_t>(std::count(odd.begin(), odd.end(), true));
}

bool TooMany(const std::vector<bool>& odd) {
  return static_cast<double>(CountOf(odd)) > kMostOdd * static_cast<double>(odd.size());
}

std::vector<bool> Not(std::vector<bool> of) {
  of.flip();
  return of;
}

class Judging {
 public:
  Judging(const SmallViews& views, const observe::Observations& all,
          const model::ModelChoice& choice, const StopFlag* stop)
      : views_(views), all_(all), choice_(choice), stop_(stop) {}

  std::vector<FrameResidual> ResidualsOf(const model::Scene& scene) const {
    const std::vector<cv::Mat1f> models =
        ModelPictures(all_, scene, views_.views[0].radiance.size());
    std::vector<FrameResidual> out;
    for (std::size_t k = 0; k < models.size(); ++k)
      out.push_back(Compare(views_.views[k].radiance, models[k]));
    return out;
  }

  // From a fit of all to one of those that agree.
  model::Scene Concentrated(model::Scene scene) const {
    std::vector<bool> before;
    for (int i = 0; i < kConcentrations && !StopRequested(stop_); ++i) {
      const std::vector<bool> core = Core(ResidualsOf(scene));
      if (core == before) break;
      scene = FitRobustly(Only(all_, core), scene, stop_);
      before = core;
    }
    return scene;
  }

  // From a fit of all and, where that leads to nothing, of every third frame: of two odd frames one
  // of these three fits has none.
  model::Scene BestStart(const model::Scene& of_all, double noise) const {
    model::Scene best = Concentrated(of_all);
    std::vector<FrameResidual> residuals = ResidualsOf(best);
    double least = LeftOfCore(residuals);
    for (std::size_t first = 0; first < kThirds && !StopRequested(stop_); ++first) {
      if (least <= std::max(kWellLeft * Level(residuals), 3.0 * noise)) break;
      std::vector<bool> third(residuals.size(), false);
      for (std::size_t k = first; k < third.size(); k += kThirds) third[k] = true;
      const observe::Observations some = Only(all_, third);
      if (some.used < kFewestOfThird) continue;
      model::Scene scene = Concentrated(FitQuickly(some, choice_, stop_).scene);
      const std::vector<FrameResidual> left = ResidualsOf(scene);
      if (LeftOfCore(left) >= least) continue;
      best = std::move(scene);
      residuals = left;
      least = LeftOfCore(left);
    }
    return best;
  }

  FramesJudged Run(const std::vector<double>& on_mask) const {
    FramesJudged out;
    const Fit of_all = FitQuickly(all_, choice_, stop_);
    out.rms_of_all = out.rms_of_rest = of_all.rms;
    const double noise = observe::EstimateNoise(all_) * all_.radiance_unit;
    out.noise = noise;
    out.scene = BestStart(of_all.scene, noise);
    std::vector<FrameResidual> residuals = ResidualsOf(out.scene);
    Verdict verdict = Judge(residuals, on_mask, noise);
    for (int round = 0; round < kRounds && !StopRequested(stop_) && !TooMany(verdict.odd);
         ++round) {
      const std::vector<bool> odd = verdict.odd;
      const Fit of_rest =
          CountOf(odd) == 0 ? of_all : FitAnew(Only(all_, Not(odd)), choice_, stop_);
      out.scene = of_rest.scene;
      out.rms_of_rest = of_rest.rms;
      residuals = ResidualsOf(out.scene);
      verdict = Judge(residuals, on_mask, noise);
      if (verdict.odd == odd) break;
    }
    const bool none = TooMany(verdict.odd);
    if (none) out.rms_of_rest = out.rms_of_all;
    out.usual = verdict.usual;
    out.level = verdict.level;
    out.odd = none ? 0 : CountOf(verdict.odd);
    for (std::size_t k = 0; k < residuals.size(); ++k)
      out.frames.push_back(
          {residuals[k], on_mask[k], !none && verdict.odd[k], !none && verdict.odd_mask[k], {}});
    return out;
  }

 private:
  const SmallViews& views_;
  const observe::Observations& all_;
  const model::ModelChoice& choice_;
  const StopFlag* stop_;
};

}  // namespace

FramesJudged JudgeFrames(const SmallViews& views, const observe::Observations& all,
                         const target::Geometry& geometry, const calib::RayGrid& rays,
                         const model::ModelChoice& choice, const StopFlag* stop) {
  if (all.used < kFewestPixels) return {};
  FramesJudged out = Judging(views, all, choice, stop).Run(MasksOnTarget(views, geometry, rays));
  if (out.odd == 0 || StopRequested(stop)) return out;
  const std::vector<cv::Mat1f> models =
      ModelPictures(all, out.scene, views.views[0].radiance.size());
  std::vector<bool> odd;
  for (const FrameJudgement& frame : out.frames) odd.push_back(frame.odd);
  const Oddness oddness(views, models, odd, out.usual);
  for (std::size_t k = 0; k < out.frames.size(); ++k)
    if (odd[k]) out.frames[k].what = oddness.Of(k, out.frames[k]);
  return out;
}

}  // namespace turnlight::estimator::consistency
