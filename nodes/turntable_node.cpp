#include "nodes/turntable_node.h"

#include <cstdio>
#include <utility>

namespace turnlight::nodes {
namespace {

std::string Seconds(graph::Duration duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g s", graph::ToMs(duration) * 1e-3);
  return text;
}

}  // namespace

Status TurntableNode::Configure(StrictObject& params) {
  poll_period_ =
      graph::FromMs(params.OptionalNumber("poll_ms", {.max = 1000.0, .above = 0.0}).value_or(20.0));
  home_timeout_ = graph::FromMs(
      1e3 * params.OptionalNumber("home_timeout_s", {.max = 3600.0, .above = 0.0}).value_or(120.0));
  return {};
}

Status TurntableNode::Start() {
  poll_.Every(poll_period_);
  return {};
}

Status TurntableNode::Stop(graph::StopMode) {
  const auto state = table_->State(clock_.Now());
  return state && state->motion == rig::TableMotion::kMoving ? table_->Halt(clock_.Now())
                                                             : Status();
}

Status TurntableNode::OnGoal(const graph::Message<graph::ActionGoal<MoveGoal>>& goal) {
  goal_ = goal->goal;
  step_ = Step::kBegin;
  next_leg_ = 0;
  deadline_ = clock_.Now() + goal_.timeout;
  Work(Read(clock_.Now()));
  return {};
}

Status TurntableNode::OnPoll(graph::Time now) {
  const rig::TableState state = Read(now);
  for (const std::string& note : table_->TakeNotes()) ReportFault("note", note);
  state_.Publish(state, state.time);
  move_.SendFeedback(state, state.time);
  if (move_.active() != 0) Work(state);
  return {};
}

rig::TableState TurntableNode::Read(graph::Time now) {
  auto state = table_->State(now);
  if (state) return std::move(*state);
  // Reopened now for the next time; this reading stays a fault.
  const auto opened = table_->Open(now);
  return {now, rig::TableMotion::kFault, 0.0,
          state.error().text + (opened ? "" : "; opening it again: " + opened.error().text)};
}

void TurntableNode::Work(const rig::TableState& state) {
  const bool lost =
      state.motion == rig::TableMotion::kUnhomed || state.motion == rig::TableMotion::kFault;
  if (state.motion == rig::TableMotion::kMoving) {
    if (state.time < deadline_) return;
    const Status halted = table_->Halt(state.time);
    return Finish(state, false,
                  (step_ == Step::kHoming ? "homing did not end within " + Seconds(home_timeout_)
                                          : "no arrival within " + Seconds(goal_.timeout)) +
                      ", the motor was stopped" + (halted ? "" : ": " + halted.error().text));
  }
  if (step_ == Step::kBegin && lost) return BeginHoming(state);
  if (lost) return Finish(state, false, state.fault.empty() ? "position unknown" : state.fault);
  if (next_leg_ < goal_.legs_deg.size()) return BeginLeg(state);
  Finish(state, true, "");
}

void TurntableNode::BeginHoming(const rig::TableState& state) {
  step_ = Step::kHoming;
  deadline_ = state.time + home_timeout_;
  if (const Status status = table_->Home(state.time); !status)
    Finish(state, false, status.error().text);
}

void TurntableNode::BeginLeg(const rig::TableState& state) {
  step_ = Step::kLeg;
  deadline_ = state.time + goal_.timeout;
  if (const Status status = table_->MoveTo(goal_.legs_deg[next_leg_++], state.time); !status)
    Finish(state, false, status.error().text);
}

void TurntableNode::Finish(const rig::TableState& state, bool arrived, std::string text) {
  move_.Finish(move_.active(), {arrived, state.angle_deg, std::move(text)}, state.time);
}

}  // namespace turnlight::nodes
