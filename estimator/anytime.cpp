#include "estimator/anytime.h"

#include <utility>

#include "estimator/consistency/odd_frames.h"
#include "estimator/notes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/views.h"
#include "estimator/residual_maps.h"

namespace turnlight::estimator {
void AnytimeEstimator::Add(const model::Keyframe& keyframe) {
  parts_.push_back(observe::BuildPart(keyframe, geometry_, rays_));
  signatures_.push_back(observe::ViewSignature(keyframe));
  if (!small_) {
    const int block = consistency::BlockFor(camera_, geometry_, {{keyframe.X_WC, keyframe.X_WT}});
    small_.emplace(consistency::SmallViews{camera_.InBlocks(block), block, {}});
  }
  small_->views.push_back(
      consistency::MakeSmallView(keyframe, small_->block, small_->views.size()));
}

Result<Estimate> AnytimeEstimator::Solve(const OddOnes& odd, bool cold, bool& doubtful) const {
  EstimateOptions options;
  if (!cold) options.warm_start = current_->ToScene();
  std::vector<observe::Observations> parts;
  std::vector<cv::Mat> signatures;
  for (std::size_t k = 0; k < parts_.size() && !odd.empty(); ++k) {
    if (odd.contains(k)) continue;
    parts.push_back(parts_[k]);
    signatures.push_back(signatures_[k]);
  }
  observe::Observations all = observe::Concatenate(odd.empty() ? parts_ : parts);
  parts.clear();
  select::Refined refined;
  auto estimate =
      EstimateObservations(all, odd.empty() ? signatures_ : signatures, options, nullptr, &refined);
  if (!estimate) return estimate;
  const std::vector<double> rms =
      RmsByKeyframe(all, refined.solution.scene, refined.options.evaluate);
  // What stood out before and was not odd is not looked at again with every keyframe.
  doubtful =
      StandsOut(rms, rms.size() - 1) ||
      (cold && (!odd.empty() || OneStandsOut(rms) || refined.solution.scene.flickers() ||
                Unexplained(estimate->rms, observe::EstimateNoise(all) * all.radiance_unit)));
  return estimate;
}

AnytimeEstimator::OddOnes AnytimeEstimator::FindOddKeyframes() const {
  if (parts_.size() < consistency::kFewestJudged) return odd_;
  const calib::RayGrid rays(small_->camera);
  const observe::Observations all =
      observe::BuildObservations(consistency::ToKeyframes(*small_), geometry_, rays);
  const consistency::FramesJudged judged =
      consistency::JudgeFrames(*small_, all, geometry_, rays, {}, nullptr);
  OddOnes odd;
  for (std::size_t k = 0; k < judged.frames.size(); ++k)
    if (judged.frames[k].odd) odd.emplace(k, judged.frames[k].what);
  return odd;
}

Status AnytimeEstimator::Step() {
  const bool cold = !current_ || parts_.size() >= next_cold_;
  bool doubtful = false;
  auto estimate = Solve(odd_, cold, doubtful);
  // What is black or upside down can spoil the estimate so that there is none. One that there is
  // stays, with the keyframes that it is of, if there is none without those that are odd now.
  if (OddOnes odd = !estimate || doubtful ? FindOddKeyframes() : odd_; odd != odd_) {
    auto without = Solve(odd, true, doubtful);
    if (without || !estimate) {
      estimate = std::move(without);
      odd_ = std::move(odd);
    }
  }
  if (!estimate) return Forward(estimate);
  if (cold) next_cold_ = 2 * parts_.size();
  current_ = std::move(*estimate);
  return {};
}

}  // namespace turnlight::estimator
