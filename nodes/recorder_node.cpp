#include "nodes/recorder_node.h"

namespace turnlight::nodes {

Status RecorderNode::OnKeyframe(const graph::Message<Keyframe>& keyframe) {
  rig::SessionRecorder* recorder = work_->recorder.get();
  if (!recorder) return {};
  const Bracket& bracket = keyframe->bracket;
  rig::RecordedKeyframe record;
  record.index = bracket.index;
  record.angle_measured_deg = bracket.angle_measured_deg;
  record.X_WC = keyframe->X_WC;
  record.X_WT = keyframe->X_WT;
  record.image = keyframe->image;
  record.validity = keyframe->validity;
  record.exposure = keyframe->exposure;
  record.provenance = {bracket.utc,
                       bracket.exposures.front().exposure_begin,
                       bracket.exposures.back().exposure_end,
                       bracket.attempts,
                       bracket.rejected,
                       {},
                       bracket.exposures.back().readings};
  for (const Frame& frame : bracket.exposures)
    record.provenance.counters.push_back(
        {{"frame_id", static_cast<std::int64_t>(frame.frame_id)}, {"drained", frame.drained}});
  if (Status status = recorder->Add(record); !status) return status;
  const std::size_t missing = recorder->Missing().size();
  stored_.Publish({bracket.index, missing}, keyframe.header.valid_at);
  return missing == 0 ? recorder->Finish() : Status();
}

}  // namespace turnlight::nodes
