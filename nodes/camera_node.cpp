#include "nodes/camera_node.h"

#include <utility>

#include "base/format.h"

namespace turnlight::nodes {

Status CameraNode::Configure(StrictObject& params) {
  poll_period_ =
      graph::FromMs(params.OptionalNumber("poll_ms", {.max = 1000.0, .above = 0.0}).value_or(5.0));
  return {};
}

Status CameraNode::OnGoal(const graph::Message<graph::ActionGoal<ExposeGoal>>& goal) {
  const graph::Time now = clock_.Now();
  if (const Status status = Begin(goal->goal, now); !status) {
    Finish({std::nullopt, status.error().text}, now);
    return {};
  }
  expose_.SendFeedback({trigger_, now}, now);
  poll_.Every(poll_period_);
  return {};
}

Status CameraNode::Begin(const ExposeGoal& goal, graph::Time now) {
  if (reopen_) {
    if (const auto opened = camera_->Open(now); !opened) return Forward(opened);
    reopen_ = false;
  }
  if (const auto set = camera_->Set(goal.settings, now); !set) return Forward(set);
  const auto drained = camera_->Drain(now);
  if (!drained) return Forward(drained);
  const auto trigger = camera_->Trigger(now);
  if (!trigger) return Forward(trigger);
  drained_ = *drained;
  trigger_ = *trigger;
  triggered_at_ = now;
  deadline_ = now + graph::FromMs(goal.settings.exposure_us * 1e-3) + goal.timeout;
  return {};
}

Status CameraNode::OnPoll(graph::Time now) {
  auto polled = camera_->Poll(now);
  if (!polled) {
    Finish({std::nullopt, polled.error().text}, now);
  } else if (*polled) {
    rig::RawFrame& raw = **polled;
    Finish({Frame{std::move(raw.image), raw.frame_id, raw.trigger, trigger_, triggered_at_,
                  raw.exposure_begin, raw.exposure_end, raw.actual, raw.complete, drained_,
                  camera_->Readings()},
            ""},
           now);
  } else if (now >= deadline_) {
    Finish({std::nullopt, Format("no picture came in answer to trigger %llu within %.3g s, the "
                                 "exposure and capture/frame_timeout_s",
                                 static_cast<unsigned long long>(trigger_),
                                 graph::ToMs(deadline_ - triggered_at_) * 1e-3)},
           now);
  }
  return {};
}

void CameraNode::TellNotes() {
  for (std::string& note : camera_->TakeNotes()) ReportFault("note", std::move(note));
}

void CameraNode::Finish(ExposeResult result, graph::Time now) {
  poll_.Cancel();
  TellNotes();
  if (!result.frame) reopen_ = true;
  expose_.Finish(expose_.active(), std::move(result), now);
}

}  // namespace turnlight::nodes
