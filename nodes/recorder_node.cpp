#include "nodes/recorder_node.h"

namespace turnlight::nodes {

Status RecorderNode::OnKeyframe(const graph::Message<Keyframe>& keyframe) {
  rig::SessionRecorder* recorder = work_->recorder.get();
  if (!recorder) return {};
  const Bracket& bracket = keyframe->bracket;
  rig::RecordedKeyframe record;
  record.index = bracket.index;
  record.angle_deg = bracket.angle_deg;
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
  if (until_) return FinishIfEnded();
  return missing == 0 ? recorder->Finish() : Status();
}

Status RecorderNode::OnVerdict(const graph::Message<Verdict>& verdict) {
  if (!until_ || verdict->kind != Verdict::Kind::kEnd || !work_->recorder) return {};
  end_ = *verdict;
  return FinishIfEnded();
}

// The last keyframe may come after the verdict that follows from it.
Status RecorderNode::FinishIfEnded() {
  rig::SessionRecorder& recorder = *work_->recorder;
  if (!end_) return {};
  for (std::size_t index = 0; index < end_->keyframes; ++index)
    if (!recorder.entries().contains(index)) return {};
  recorder.End({end_->code, end_->words});
  return recorder.Finish();
}

}  // namespace turnlight::nodes
