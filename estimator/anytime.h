// The estimate while the capture goes on: from the first keyframe there is one, with its error
// bars, and it improves with each that comes. The final answer is not taken from here: it is solved
// again from a canonical start (EstimateScene), so that it does not depend on the order of events.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "estimator/consistency/small_views.h"
#include "estimator/estimate.h"

namespace turnlight::estimator {

class AnytimeEstimator {
 public:
  // Both must outlive the estimator.
  AnytimeEstimator(const target::Geometry& geometry, const calib::RayGrid& rays,
                   const calib::CameraModel& camera)
      : geometry_(geometry), rays_(rays), camera_(camera) {}

  // Takes a keyframe in; traces it, does not solve.
  void Add(const model::Keyframe& keyframe);
  // Keyframes that do not belong to the others, by number from 0 in their order, with what is odd
  // about them; as the last step found. They are left out of its estimate.
  const std::map<std::size_t, std::string>& OddKeyframes() const { return odd_; }
  // Solves with all keyframes so far: from the last estimate, or, whenever their number has doubled
  // since the last time (and while there is no estimate), looking for the lights anew.
  // If there is none without the keyframes that are odd by it, the one with them is kept.
  // Deterministic in the order of calls. Fails with kNoEstimate while nothing usable was seen; the
  // last estimate stays.
  Status Step();
  // The best so far; empty before the first success.
  const std::optional<Estimate>& Current() const { return current_; }
  std::size_t keyframes() const { return parts_.size(); }

 private:
  using OddOnes = std::map<std::size_t, std::string>;
  // The estimate of the keyframes without those; doubtful: some may be odd, by what it leaves.
  Result<Estimate> Solve(const OddOnes& odd, bool cold, bool& doubtful) const;
  OddOnes FindOddKeyframes() const;

  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  const calib::CameraModel camera_;
  std::vector<observe::Observations> parts_;  // one per keyframe, in white
  std::vector<cv::Mat> signatures_;
  std::optional<consistency::SmallViews> small_;
  OddOnes odd_;
  std::optional<Estimate> current_;
  std::size_t next_cold_ = 1;
};

}  // namespace turnlight::estimator
