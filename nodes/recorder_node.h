// Puts every keyframe safely on disk, and ends the session when the last one is.
//   in       keyframe  Keyframe
//   out      stored    Stored, once it is safe on disk
#pragma once

#include <memory>
#include <utility>

#include "nodes/capture_work.h"
#include "nodes/graph/node.h"
#include "nodes/messages.h"

namespace turnlight::nodes {

class RecorderNode : public graph::Node {
 public:
  explicit RecorderNode(std::shared_ptr<const CaptureWork> work) : work_(std::move(work)) {}

 private:
  Status OnKeyframe(const graph::Message<Keyframe>& keyframe);

  graph::Input<Keyframe> keyframe_{this, "keyframe", &RecorderNode::OnKeyframe};
  graph::Output<Stored> stored_{this, "stored"};
  std::shared_ptr<const CaptureWork> work_;
};

}  // namespace turnlight::nodes
