#include "nodes/keyframes_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nodes/frame_proof.h"

namespace turnlight::nodes {
namespace {

// Readings of one controller are further apart than this.
constexpr graph::Duration kNewReading = std::chrono::milliseconds(1);

graph::Duration FromSeconds(double seconds) { return graph::FromMs(seconds * 1e3); }

}  // namespace

Status KeyframesNode::Configure(StrictObject& params) {
  const auto ms = [&](const char* key, double otherwise) {
    return graph::FromMs(
        params.OptionalNumber(key, {.min = 0.0, .max = 3.6e6}).value_or(otherwise));
  };
  still_deg_ = params.OptionalNumber("still_deg", {.min = 0.0, .max = 5.0}).value_or(0.01);
  retry_wait_ = ms("retry_wait_ms", 500.0);
  state_timeout_ = ms("state_timeout_ms", 2000.0);
  home_timeout_ = FromSeconds(
      params.OptionalNumber("home_timeout_s", {.min = 0.0, .max = 3600.0}).value_or(130.0));
  if (const auto lost = params.OptionalNumber("lost_timeout_s", {.min = 0.0, .max = 3600.0}))
    lost_timeout_ = FromSeconds(*lost);
  return {};
}

Status KeyframesNode::Start() {
  frames_ = work_->frames;
  waiting_ = job_.plan.until.has_value();
  return waiting_ ? Status() : BeginKeyframe();
}

// Who decides knows the keyframes in the order of their numbers: a verdict that comes while the
// capture waits is the one that it waits for.
Status KeyframesNode::OnVerdict(const graph::Message<Verdict>& verdict) {
  if (!waiting_) return {};
  waiting_ = false;
  if (verdict->kind == Verdict::Kind::kEnd) {
    RequestStop();
    return {};
  }
  if (verdict->kind == Verdict::Kind::kOneMore)
    frames_.push_back({static_cast<std::size_t>(verdict->keyframes), verdict->angle_deg});
  return BeginKeyframe();
}

Status KeyframesNode::WindDown() {
  stopping_ = true;
  return {};
}

// The time since the last phase began goes to its account.
void KeyframesNode::Enter(Phase phase) {
  const graph::Time now = clock_.Now();
  const double seconds = graph::ToMs(now - entered_) * 1e-3;
  switch (phase_) {
    case Phase::kMoving:
    case Phase::kBefore:
    case Phase::kAfter:
      pace_.stage += seconds;
      break;
    case Phase::kSettling:
      pace_.settling += seconds;
      break;
    case Phase::kExposing:
      pace_.camera += seconds;
      break;
    case Phase::kResting:
      pace_.resting += seconds;
      break;
    case Phase::kIdle:
      break;
  }
  phase_ = phase;
  entered_ = now;
}

Status KeyframesNode::BeginKeyframe() {
  Enter(Phase::kIdle);
  failing_since_.reset();
  if (next_ == frames_.size()) RequestStop();
  if (next_ == frames_.size() || stopping_) return {};
  HoldStop();
  bracket_ = Bracket{};
  bracket_.index = Frame().index;
  bracket_.closure = Frame().closure;
  bracket_.angle_deg = Frame().angle_deg;
  return BeginAttempt();
}

Status KeyframesNode::BeginAttempt() {
  Enter(Phase::kMoving);
  bracket_.exposures.clear();
  levels_now_.clear();
  const MoveGoal goal{rig::MoveLegs(job_.plan, from_deg_, Frame().angle_deg),
                      FromSeconds(job_.plan.move_timeout_s)};
  from_deg_.reset();  // unknown until this attempt was good
  // The turntable's own deadlines fire first; this one is for a turntable that hangs.
  const auto sent =
      move_.Send(goal, clock_.Now(),
                 home_timeout_ + static_cast<int>(goal.legs_deg.size() + 1) * goal.timeout);
  return sent ? Status() : Forward(sent);
}

Status KeyframesNode::OnMoved(const graph::ActionOutcome<Move>& outcome) {
  if (outcome.deadline_passed())
    return Reject(ErrorKind::kDevice, "the turntable did not answer a move");
  if (job_.check_arrival && !outcome.result().arrived)
    return Reject(ErrorKind::kDevice, "no arrival: " + outcome.result().text);
  Enter(Phase::kSettling);
  readings_from_ = clock_.Now();
  rest_deg_.reset();
  timer_.After(job_.settle ? graph::FromMs(job_.plan.settle_ms) : graph::Duration(0));
  return {};
}

Status KeyframesNode::OnTimer(graph::Time now) {
  if (phase_ == Phase::kSettling) return Await(Phase::kBefore, now);
  if (phase_ == Phase::kResting) return BeginAttempt();
  return Reject(ErrorKind::kDevice, "the turntable did not tell where it stands");
}

Status KeyframesNode::Await(Phase phase, graph::Time from) {
  Enter(phase);
  readings_from_ = from;
  readings_deg_.clear();
  if (phase == Phase::kBefore && rest_deg_) readings_deg_.push_back(*rest_deg_);
  timer_.After(state_timeout_);
  return {};
}

Status KeyframesNode::OnState(const graph::Message<rig::TableState>& state) {
  if (phase_ != Phase::kSettling && phase_ != Phase::kBefore && phase_ != Phase::kAfter) return {};
  if (state->time < readings_from_) return {};
  readings_from_ = state->time + kNewReading;  // the same one may be told again
  if (phase_ == Phase::kSettling) {
    rest_deg_.reset();
    if (state->motion == rig::TableMotion::kIdle) rest_deg_ = state->angle_deg;
    return {};
  }
  if (job_.check_arrival) {
    if (const auto why = StandsAt(*state, Frame().angle_deg, job_.plan.tolerance_deg))
      return Reject(ErrorKind::kIncomplete, *why);
    const double reference_deg = phase_ == Phase::kAfter ? bracket_.angle_measured_deg
                                 : readings_deg_.empty() ? state->angle_deg
                                                         : readings_deg_.front();
    if (std::abs(state->angle_deg - reference_deg) > still_deg_)
      return Reject(ErrorKind::kIncomplete, "the table does not stand still: it was at " +
                                                std::to_string(reference_deg) + " deg, then at " +
                                                std::to_string(state->angle_deg));
  }
  readings_deg_.push_back(state->angle_deg);
  if (readings_deg_.size() < 2) return {};
  timer_.Cancel();
  if (phase_ == Phase::kAfter) return Accept();
  bracket_.angle_measured_deg = state->angle_deg;
  return Expose();
}

Status KeyframesNode::Expose() {
  Enter(Phase::kExposing);
  const ExposeGoal goal{{job_.plan.exposures_us[bracket_.exposures.size()], job_.plan.gain_db},
                        FromSeconds(job_.plan.frame_timeout_s)};
  // The camera's own deadline fires first; this one is for a camera node that hangs.
  const auto sent = expose_.Send(
      goal, clock_.Now(),
      graph::FromMs(goal.settings.exposure_us * 1e-3) + 2 * goal.timeout + FromSeconds(1.0));
  return sent ? Status() : Forward(sent);
}

Status KeyframesNode::OnExposed(const graph::ActionOutcome<nodes::Expose>& outcome) {
  if (outcome.deadline_passed())
    return Reject(ErrorKind::kDevice, "the camera did not answer a trigger");
  if (!outcome.result().frame) return Reject(ErrorKind::kDevice, outcome.result().text);
  return Judge(*outcome.result().frame);
}

Status KeyframesNode::Judge(const nodes::Frame& frame) {
  const std::size_t which = bracket_.exposures.size();
  const rig::CameraSettings asked{job_.plan.exposures_us[which], job_.plan.gain_db};
  const auto why = Answers(frame, asked, last_id_);
  if (frame.exposure_begin >= frame.triggered_at) last_id_ = frame.frame_id;
  if (why) return Reject(ErrorKind::kIncomplete, *why);
  // Only the reference exposure is judged by its levels: the others of a bracket are dark or
  // clipped on purpose.
  if (which == 0) {
    const rig::FrameCheck check =
        rig::CheckFrame(frame.image, radiometry_, job_.gate, levels_[which]);
    if (check.verdict != rig::FrameVerdict::kGood)
      return Reject(ErrorKind::kIncomplete, check.text);
    levels_now_.push_back(check.statistics.mean_level);
  }
  bracket_.exposures.push_back(frame);
  if (bracket_.exposures.size() < job_.plan.exposures_us.size()) return Expose();
  return Await(Phase::kAfter, frame.exposure_end);
}

Status KeyframesNode::Accept() {
  for (std::size_t i = 0; i < levels_now_.size(); ++i) levels_[i].push_back(levels_now_[i]);
  from_deg_ = Frame().angle_deg;
  bracket_.utc = clock_.UtcLabel();
  const graph::Time valid_at = bracket_.exposures.front().exposure_begin;
  Enter(Phase::kIdle);
  bracket_out_.Publish(std::move(bracket_), valid_at);
  pace_.storing += graph::ToMs(clock_.Now() - entered_) * 1e-3;
  pace_out_.Publish(std::exchange(pace_, Pace{}), valid_at);
  ++next_;
  ReleaseStop();
  waiting_ = job_.plan.until.has_value();
  return waiting_ ? Status() : BeginKeyframe();
}

// Whether it is tried again: a device for as long as it may be lost, if that was said; all else as
// often as the plan has it.
bool KeyframesNode::TryAgain(ErrorKind kind) {
  const bool lost = kind == ErrorKind::kDevice && lost_timeout_;
  if (!lost) return bracket_.attempts <= job_.plan.retries;
  if (!failing_since_) failing_since_ = clock_.Now();
  return clock_.Now() - *failing_since_ < *lost_timeout_;
}

graph::Duration KeyframesNode::Rest() const {
  const graph::Duration rest = retry_wait_ * (1 << std::min(bracket_.attempts - 1, 6));
  if (!failing_since_) return rest;
  const graph::Duration left = *failing_since_ + *lost_timeout_ - clock_.Now();
  return std::clamp<graph::Duration>(left, retry_wait_, std::min(rest, 4 * retry_wait_));
}

Status KeyframesNode::Reject(ErrorKind kind, const std::string& why) {
  timer_.Cancel();
  bracket_.rejected.push_back(why);
  const std::int64_t allowed = std::max<std::int64_t>(job_.plan.retries + 1, bracket_.attempts);
  const std::string text = rig::Label(Frame()) + ", attempt " + std::to_string(bracket_.attempts) +
                           " of " + std::to_string(allowed) + ": " + why;
  if (!TryAgain(kind))
    return tl::unexpected<Error>(
        Error{kind, text + "; the capture pauses here, all good frames are kept"});
  ReportFault("retry", text);
  Enter(Phase::kResting);
  timer_.After(Rest());
  ++bracket_.attempts;
  return {};
}

}  // namespace turnlight::nodes
