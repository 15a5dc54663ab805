// The table behind an action.
//   action   move    Move: homes first if the position is unknown, then goes leg by leg
//   out      state   TableState, every poll_ms; while the table does not answer, its fault
//   params   poll_ms (20), home_timeout_s (120)
// Whenever the graph stops, a table that still moves is halted.
#pragma once

#include <memory>
#include <string>

#include "nodes/graph/action.h"
#include "nodes/messages.h"
#include "rig/device.h"

namespace turnlight::nodes {

class TurntableNode : public graph::Node {
 public:
  // The table is open when the graph starts; one that is lost later is opened again.
  explicit TurntableNode(std::shared_ptr<rig::Turntable> table) : table_(std::move(table)) {}
  Status Configure(StrictObject& params) override;
  Status Start() override;
  Status Stop(graph::StopMode mode) override;

 private:
  enum class Step { kBegin, kHoming, kLeg };

  Status OnGoal(const graph::Message<graph::ActionGoal<MoveGoal>>& goal);
  Status OnPoll(graph::Time now);
  rig::TableState Read(graph::Time now);
  void Work(const rig::TableState& state);
  void BeginHoming(const rig::TableState& state);
  void BeginLeg(const rig::TableState& state);
  void Finish(const rig::TableState& state, bool arrived, std::string text);

  graph::Clock clock_{this};
  graph::Timer poll_{this, "poll", &TurntableNode::OnPoll};
  graph::ActionServer<Move> move_{this, "move", &TurntableNode::OnGoal};
  graph::Output<rig::TableState> state_{this, "state"};
  std::shared_ptr<rig::Turntable> table_;
  graph::Duration poll_period_{}, home_timeout_{};
  MoveGoal goal_;
  Step step_ = Step::kBegin;
  std::size_t next_leg_ = 0;
  graph::Time deadline_{};  // of the homing, the leg, or the wait before them
};

}  // namespace turnlight::nodes
