// Puts every keyframe safely on disk, and ends the session when the last one is.
//   in       keyframe  Keyframe
//   in       verdict   Verdict, if the plan has `until`: says which one is the last, and why
//   out      stored    Stored, once it is safe on disk
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "nodes/capture_work.h"
#include "nodes/graph/node.h"
#include "nodes/messages.h"

namespace turnlight::nodes {

class RecorderNode : public graph::Node {
 public:
  // until: the end is not that of the plan, but what a verdict says.
  RecorderNode(std::shared_ptr<const CaptureWork> work, bool until)
      : work_(std::move(work)), until_(until) {}

 private:
  Status OnKeyframe(const graph::Message<Keyframe>& keyframe);

  Status OnVerdict(const graph::Message<Verdict>& verdict);
  Status FinishIfEnded();

  graph::Input<Keyframe> keyframe_{this, "keyframe", &RecorderNode::OnKeyframe};
  graph::Input<Verdict> verdict_{this, "verdict", &RecorderNode::OnVerdict, graph::Need::kOptional};
  graph::Output<Stored> stored_{this, "stored"};
  std::shared_ptr<const CaptureWork> work_;
  bool until_;
  std::optional<Verdict> end_;
};

}  // namespace turnlight::nodes
