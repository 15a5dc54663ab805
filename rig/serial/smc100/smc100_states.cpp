// What the states of a controller lead to.
#include <cmath>
#include <utility>

#include "base/format.h"
#include "rig/serial/smc100/smc100_protocol.h"

namespace turnlight::rig::serial::smc100 {
namespace {

// Well below what a capture allows (0.05 degrees), above a servo's play.
constexpr double kArrivalToleranceDeg = 0.02;
// A stage that stands elsewhere for so long does not go on by itself.
constexpr DeviceTime kAstrayWait = std::chrono::milliseconds(500);
// Until the state must show what was taken.
constexpr DeviceTime kBeginWait = std::chrono::milliseconds(500);
// After it a reset that cannot be seen has not been.
constexpr DeviceTime kResetBegin = std::chrono::seconds(2);
// A stop that may have been lost is sent again, which does no harm.
constexpr DeviceTime kStopAgain = std::chrono::seconds(1);

}  // namespace

void Smc100Protocol::HandleState(const ControllerState& state, DeviceTime asked) {
  state_ = state.state;
  const StateKind kind = KindOf(state.state);
  if ((state.errors & kEndOfRunErrors) != 0 && kind == StateKind::kReady) {
    const std::string words = ErrorsInWords(state.errors & kEndOfRunErrors);
    if (noted_.insert(words).second) Note("the stage stands at a limit switch: " + words);
  }
  const unsigned errors = state.errors & ~kEndOfRunErrors;
  if (errors != 0 && kind != StateKind::kUnreferenced) {
    // They may be told once only, so they count at once.
    in_doubt_ = true;
    SetFault(TableMotion::kFault, ErrorsInWords(errors) + ", state " + StateInWords(state.state));
    return ReportFault(asked);
  }
  if (kind == StateKind::kReady || kind == StateKind::kMoving || kind == StateKind::kHoming) {
    doubtful_.reset();
    return kind == StateKind::kReady ? HandleReady(asked) : HandleGoing(asked);
  }
  ready_before_ = false;
  const unsigned whole = state.errors << 8 | state.state;
  if (std::exchange(doubtful_, whole) != whole) return Ask("TS");
  HandleTrouble(whole, asked);
}

void Smc100Protocol::HandleGoing(DeviceTime asked) {
  ready_before_ = false;
  astray_since_.reset();
  if (taken_) was_going_ = true;
  if (goal_ == Goal::kStop && now() - stopped_at_ > kStopAgain) {
    stopped_at_ = now();
    Set(Act::kStop, "ST");
  }
  if (!fault_.empty()) return ReportFault(asked);
  Report(TableMotion::kMoving, position_deg_, "", asked);
}

void Smc100Protocol::HandleReady(DeviceTime asked) {
  if (!fault_.empty()) {
    goal_ = Goal::kRest;
    ready_before_ = true;  // the position is read on
    return ReportFault(asked);
  }
  if (resetting_since_) {
    if (now() - *resetting_since_ < kResetBegin) return;
    Note("the controller does not take RS: it goes to 0 by the reference that it has");
    resetting_since_.reset();
  }
  if ((goal_ == Goal::kMove || goal_ == Goal::kHome) && !taken_) return AdvanceReady();
  if (!std::exchange(ready_before_, true)) position_asked_.reset();
  if (!position_asked_) return Ask("TP");
  Arrive();
}

// Ready, a position, ready.
void Smc100Protocol::Arrive() {
  const DeviceTime asked = *std::exchange(position_asked_, std::nullopt);
  const double off_deg = position_deg_ - target_deg_;
  const bool to_target = goal_ == Goal::kMove || (goal_ == Goal::kHome && to_zero_);
  if (to_target && std::abs(off_deg) > kArrivalToleranceDeg) {
    if (!astray_since_) astray_since_ = now();
    if (now() - *astray_since_ < kAstrayWait)
      return Report(TableMotion::kMoving, position_deg_, "", asked);
    if (!was_going_ && !std::exchange(sent_again_, true)) {
      Note("the stage did not set out: sent again");
      astray_since_.reset();
      return AdvanceReady();
    }
    in_doubt_ = true;
    SetFault(TableMotion::kFault,
             Format("stands at %.3f degrees instead of %.3f; is that out of its range?",
                    position_deg_, target_deg_));
    return ReportFault(asked);
  }
  if (goal_ == Goal::kHome && !to_zero_) in_doubt_ = false;
  goal_ = Goal::kRest;
  referenced_ = true;
  Report(TableMotion::kIdle, position_deg_, "", asked);
}

// Two replies have said the same.
void Smc100Protocol::HandleTrouble(unsigned whole, DeviceTime asked) {
  const unsigned state = whole & 0xff;
  const std::string errors = ErrorsInWords(whole >> 8);
  const std::string words = StateInWords(state) + (errors.empty() ? "" : " (" + errors + ")");
  if (KindOf(state) == StateKind::kUnreferenced) {
    resetting_since_.reset();
    if (goal_ == Goal::kHome && !taken_) return Advance(state);
    if (goal_ == Goal::kHome && now() - taken_at_ < kBeginWait && !was_going_)
      return Report(TableMotion::kMoving, position_deg_, "", asked);
    if (fault_.empty() || fault_motion_ != TableMotion::kUnhomed)
      SetFault(TableMotion::kUnhomed,
               goal_ == Goal::kHome ? "the homing failed: " + words
               : referenced_        ? words + ": the controller was reset, or lost its reference"
                                    : words + ": home it first");
    referenced_ = in_doubt_ = false;
    return ReportFault(asked);
  }
  const bool wanted = goal_ == Goal::kHome || goal_ == Goal::kMove;
  if (wanted && !taken_ && fault_.empty()) return Advance(state);
  // A motor without current may have been turned.
  if (KindOf(state) == StateKind::kDisabled && referenced_) in_doubt_ = true;
  if (fault_.empty()) SetFault(TableMotion::kFault, "it cannot move in state " + words);
  ReportFault(asked);
}

void Smc100Protocol::HandlePosition(const std::string& value, DeviceTime asked) {
  const auto position = ParseValue(value);
  if (!position) return BadLine(value);
  query_.reset();
  position_deg_ = *position;
  position_asked_ = asked;
  Ask("TS");
}

void Smc100Protocol::SetFault(TableMotion motion, std::string text) {
  fault_motion_ = motion;
  fault_ = std::move(text);
  if (goal_ == Goal::kHome || goal_ == Goal::kMove) {
    const StateKind kind = KindOf(state_);
    const bool going = kind == StateKind::kMoving || kind == StateKind::kHoming;
    goal_ = going ? Goal::kStop : Goal::kRest;
    stopped_at_ = now();
    if (going) Set(Act::kStop, "ST");
  }
}

void Smc100Protocol::ReportFault(DeviceTime asked) {
  Report(fault_motion_, position_deg_, fault_, asked);
}

}  // namespace turnlight::rig::serial::smc100
