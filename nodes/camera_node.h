// The camera behind an action.
//   action   expose  Expose: sets, throws away what is queued, triggers, waits a bounded time
//   params   poll_ms (5)
//   faults   note: what the camera has to say, in words
// It judges nothing. After a failure the camera is opened again before the next exposure.
#pragma once

#include <memory>

#include "nodes/graph/action.h"
#include "nodes/messages.h"
#include "rig/device.h"

namespace turnlight::nodes {

class CameraNode : public graph::Node {
 public:
  // The camera is open when the graph starts; one that is lost later is opened again.
  explicit CameraNode(std::shared_ptr<rig::Camera> camera) : camera_(std::move(camera)) {}
  Status Configure(StrictObject& params) override;

 private:
  Status OnGoal(const graph::Message<graph::ActionGoal<ExposeGoal>>& goal);
  Status OnPoll(graph::Time now);
  Status Begin(const ExposeGoal& goal, graph::Time now);
  void TellNotes();
  void Finish(ExposeResult result, graph::Time now);

  graph::Clock clock_{this};
  graph::Timer poll_{this, "poll", &CameraNode::OnPoll};
  graph::ActionServer<Expose> expose_{this, "expose", &CameraNode::OnGoal};
  std::shared_ptr<rig::Camera> camera_;
  graph::Duration poll_period_{};
  bool reopen_ = false;
  std::uint64_t trigger_ = 0;
  std::int64_t drained_ = 0;
  graph::Time triggered_at_{}, deadline_{};
};

}  // namespace turnlight::nodes
