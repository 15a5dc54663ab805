// Puts every keyframe safely on disk, and ends the session when the last one is.
//   in       keyframe  Keyframe
//   out      stored    Stored, once it is safe on disk
#pragma once

#include <memory>
#include <utility>

#include "nodes/graph/node.h"
#include "nodes/messages.h"
#include "rig/capture/session_recorder.h"

namespace turnlight::nodes {

class RecorderNode : public graph::Node {
 public:
  // Null: nothing is stored; for drawing a graph.
  explicit RecorderNode(std::shared_ptr<rig::SessionRecorder> recorder)
      : recorder_(std::move(recorder)) {}

 private:
  Status OnKeyframe(const graph::Message<Keyframe>& keyframe);

  graph::Input<Keyframe> keyframe_{this, "keyframe", &RecorderNode::OnKeyframe};
  graph::Output<Stored> stored_{this, "stored"};
  std::shared_ptr<rig::SessionRecorder> recorder_;
};

}  // namespace turnlight::nodes
