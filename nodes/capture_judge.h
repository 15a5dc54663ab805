// What follows from the keyframes of a capture that goes on until the lights are known: the same
// verdicts for the same pictures, whether they come from the camera or from an earlier run's files.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calib/rig_geometry.h"
#include "estimator/until_known.h"
#include "nodes/capture_work.h"
#include "nodes/messages.h"
#include "rig/capture/capture_plan.h"

namespace turnlight::nodes {

struct JudgeParts {
  rig::CapturePlan plan;  // with until
  calib::RigGeometry geometry;
  estimator::Sensor sensor;                 // of what is stored
  std::shared_ptr<const CaptureWork> work;  // for the frames that are kept
};

class CaptureJudge {
 public:
  explicit CaptureJudge(JudgeParts parts);

  // Frames of this plan, in the order of their numbers. estimate: null if none was made, or none
  // came of it.
  void Took(double angle_deg, const calib::Exposure& exposure, bool looked,
            const estimator::Estimate* estimate);
  // How many there were.
  std::size_t taken() const { return known_.taken(); }
  // Whether an estimate is needed of the keyframes with the next one.
  bool NeedsEstimate() const;
  // The next frame, if an earlier run has stored it.
  const rig::JournalEntry* NextKept() const;
  const JudgeParts& parts() const { return parts_; }

  // What follows. estimate: as of the last keyframe.
  Verdict Decide(const estimator::Estimate* estimate, const estimator::target::Geometry& target,
                 const calib::RayGrid& rays) const;

 private:
  std::vector<estimator::CandidateView> Candidates() const;

  JudgeParts parts_;
  estimator::UntilKnown known_;
  std::vector<double> angles_deg_;  // of the frames taken
  calib::Exposure exposure_;        // of the last
};

}  // namespace turnlight::nodes
