// The part of the conversation that moves: homing, moves, halts, and what the reports say of them.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "rig/serial/grbl/grbl_protocol.h"

namespace turnlight::rig::serial::grbl {
namespace {

constexpr DeviceTime kQueryEvery = std::chrono::milliseconds(200);
constexpr DeviceTime kQueryInMotion = std::chrono::milliseconds(1000);
constexpr DeviceTime kQueryInHalt = std::chrono::milliseconds(100);
constexpr DeviceTime kOkPatience = std::chrono::milliseconds(1000);
constexpr DeviceTime kUnlockPatience = std::chrono::milliseconds(1500);
constexpr DeviceTime kHoldPatience = std::chrono::milliseconds(3000);
constexpr DeviceTime kQuietAfterLate = std::chrono::milliseconds(700);
constexpr int kStillReports = 4;  // about 0.8 s at rest: whatever was asked for is over

bool Moves(State state) {
  return state == State::kRun || state == State::kJog || state == State::kHome;
}
bool BlockedByAlarm(int alarm) { return alarm == 1 || alarm == 2; }

}  // namespace

void GrblProtocol::Home() {
  if (phase_ != Phase::kReady) return;
  task_ = Task::kHoming;
  fault_.clear();
  pending_move_.reset();
  if (HowHomed() == Homing::kHere && here_taken_)
    return EndTask(
        "the position is lost, and without a switch only a person can find it: turn the table to "
        "its mark and begin again");
  const bool in_motion = sent_ == Sent::kMove || sent_ == Sent::kDwell || Moves(state_);
  if (!in_motion &&
      (state_ == State::kIdle || (state_ == State::kAlarm && !BlockedByAlarm(alarm_)))) {
    pending_home_ = true;
    return Continue();
  }
  // What holds it, an alarm or a feed hold, ends with a reset only.
  home_after_reset_ = true;
  SoftReset(!in_motion);
}

void GrblProtocol::BeginHoming() {
  task_ = Task::kHoming;
  if (HowHomed() == Homing::kHere) return Send(Sent::kUnlock, "$X", kUnlockPatience);
  // H among the build's options: an axis may be homed by itself.
  const bool single =
      options_text_.substr(0, options_text_.find(',')).find('H') != std::string::npos;
  Send(Sent::kHome, single ? std::string("$H") + options_.axis : "$H", std::chrono::hours(1));
  next_query_ = now_ + kQueryInMotion;
}

void GrblProtocol::MoveTo(double position_deg) {
  pending_move_ = position_deg;
  if (task_ == Task::kNone) task_ = Task::kMoving;
  Continue();
}

void GrblProtocol::BeginMove(double position_deg) {
  fault_.clear();
  target_deg_ = position_deg;
  task_ = Task::kMoving;
  resent_ = false;
  SendMove();
}

void GrblProtocol::SendMove() {
  still_ = 0;
  ok_missing_ = false;
  // A work offset would shift the target; machine coordinates do not know it.
  Send(Sent::kMove,
       Format("G21 G90 G94 %sG1 %c%.3f F%.1f", offset_in_use_ ? "G53 " : "", options_.axis,
              target_deg_ + zero_deg_, options_.speed_deg_s * 60.0),
       kOkPatience);
  if (!query_sent_) next_query_ = now_ + kQueryInMotion;
}

void GrblProtocol::Resend() {
  resent_ = true;
  Note(Format("the move to %.3f deg was sent again: the controller stands still elsewhere",
              target_deg_));
  SendMove();
}

void GrblProtocol::Halt() {
  pending_move_.reset();
  pending_home_ = home_after_reset_ = false;
  if (phase_ != Phase::kReady) return;
  const bool moving = task_ == Task::kMoving || task_ == Task::kHoming || Moves(state_);
  if (!moving) return;
  const bool homing = task_ == Task::kHoming;
  task_ = Task::kHalting;
  sent_ = Sent::kNothing;
  if (homing) {
    unhomed_ = "homing was stopped";
    return SoftReset(false);
  }
  output_ += '!';
  line_deadline_ = now_ + kHoldPatience;
  Query();
}

void GrblProtocol::OnAlarm(int code) {
  alarm_ = code;
  state_ = State::kAlarm;
  const std::string words = AlarmWords(code);
  if (code != 2) unhomed_ = words;
  if (phase_ != Phase::kReady) return;  // the banner of a reset follows
  if (task_ == Task::kHalting && code == 3) return;
  sent_ = Sent::kNothing;
  line_deadline_.reset();
  pending_move_.reset();
  // The controller starts anew by itself after a homing that failed.
  if (task_ == Task::kHoming) reset_expected_ = true;
  EndTask(words);
  // Some alarms let no report through: the state is told now.
  events_.push_back(
      StageReport{code == 2 ? TableMotion::kFault : TableMotion::kUnhomed, 0.0, words, {}});
  ForgetQueries();
  next_query_ = now_ + kQueryInMotion;
}

// The task is over; a fault stays until the next one.
void GrblProtocol::EndTask(const std::string& fault) {
  task_ = Task::kNone;
  if (sent_ == Sent::kMove || sent_ == Sent::kDwell || sent_ == Sent::kHome) sent_ = Sent::kNothing;
  fault_ = fault;
  if (!query_sent_)
    next_query_ = std::min(next_query_.value_or(now_ + kQueryEvery), now_ + kQueryEvery);
}

std::optional<double> GrblProtocol::Position(const StatusReport& status) const {
  const auto axis = static_cast<std::size_t>(AxisIndex());
  if (axis >= status.position.size()) return std::nullopt;
  if (status.machine) return status.position[axis];
  if (!work_offset_ || axis >= work_offset_->size()) return std::nullopt;
  return status.position[axis] + (*work_offset_)[axis];
}

bool GrblProtocol::AtTarget(double position) const {
  return std::abs(position - zero_deg_ - target_deg_) <= 0.5 * StepDeg() + 0.0016;
}

void GrblProtocol::OnStatus(const StatusReport& status) {
  state_ = status.state;
  if (status.work_offset) {
    work_offset_ = status.work_offset;
    offset_in_use_ = std::any_of(work_offset_->begin(), work_offset_->end(),
                                 [](double value) { return value != 0.0; });
  }
  reset_expected_ = reset_expected_ && phase_ == Phase::kBanner;
  // One that nobody asked for is late, or sent by itself: when it was true is not known.
  if (!query_sent_) return;
  const bool late = missed_ > 0;
  const bool again = query_again_;
  ForgetQueries();
  if (phase_ == Phase::kIdentify && sent_ == Sent::kNothing) {
    line_deadline_.reset();
    Identified(status);
  }
  if (phase_ != Phase::kReady) return;
  next_query_ = now_ + NextQueryAfter(late, again);
  const auto position = Position(status);
  // Without the work offset, which comes now and then, WPos says nothing.
  if (!position) {
    next_query_ = now_ + kQueryEvery;
    return;
  }
  if (task_ == Task::kMoving) WatchMove(status, *position);
  if (task_ == Task::kHoming) WatchHoming(status, *position);
  if (task_ == Task::kHalting) WatchHalt(status);
  if (phase_ == Phase::kReady) Report(status, *position, now_ - asked_at_);
}

DeviceTime GrblProtocol::NextQueryAfter(bool late, bool again) const {
  if (late) return kQuietAfterLate;  // whatever still comes is past before the next
  if (again) return DeviceTime(0);
  if (task_ == Task::kHalting) return kQueryInHalt;
  const bool in_motion = task_ == Task::kHoming || (sent_ == Sent::kDwell && still_ == 0);
  return in_motion ? kQueryInMotion : kQueryEvery;
}

void GrblProtocol::WatchMove(const StatusReport& status, double position) {
  if (sent_ == Sent::kMove || pending_move_) return;
  if (status.state == State::kAlarm) {
    if (unhomed_.empty()) unhomed_ = "it is locked by an alarm";
    return EndTask(unhomed_);
  }
  if (status.state == State::kHold || status.state == State::kDoor ||
      status.state == State::kSleep || status.state == State::kCheck ||
      status.state == State::kTool)
    return EndTask("the controller stopped the move: it reports " + status.state_word);
  if (Moves(status.state)) {
    still_ = 0;
    if (std::exchange(ok_missing_, false)) {
      Note("the ok of a move was missing; it moves nevertheless");
      Send(Sent::kDwell, "G4 P0.01", std::chrono::hours(24));
    }
    return;
  }
  ++still_;
  const bool there = AtTarget(position);
  if (there && (sent_ == Sent::kNothing || still_ >= kStillReports)) {
    if (sent_ == Sent::kDwell || ok_missing_)
      Note("an ok was missing; the reports say that it arrived");
    sent_ = Sent::kNothing;
    line_deadline_.reset();
    return EndTask("");
  }
  if (there || still_ < kStillReports) {
    next_query_ = now_ + kQueryEvery;
    return;
  }
  if (!resent_) return Resend();
  EndTask(
      Format("it stands at %.3f deg and does not go to %.3f", position - zero_deg_, target_deg_));
}

void GrblProtocol::WatchHoming(const StatusReport& status, double position) {
  if (sent_ != Sent::kNothing || reset_expected_ || pending_home_) return;
  if (status.state == State::kAlarm) {
    unhomed_ = "homing failed: it is locked by an alarm";
    return EndTask(unhomed_);
  }
  if (status.state != State::kIdle) return;
  if (HowHomed() == Homing::kHere) {
    zero_deg_ = position;
    here_taken_ = true;
    Note("where the table stands is taken for 0 degrees");
  }
  unhomed_.clear();
  alarm_ = -1;
  EndTask("");
}

// Position is kept when the reset comes at rest.
void GrblProtocol::WatchHalt(const StatusReport& status) {
  const bool held = status.state == State::kHold && status.substate.value_or(0) == 0;
  if (!held && status.state != State::kIdle && status.state != State::kAlarm) return;
  if (status.state == State::kAlarm && unhomed_.empty()) unhomed_ = "it is locked by an alarm";
  SoftReset(true);
}

void GrblProtocol::Report(const StatusReport& status, double position, DeviceTime age) {
  StageReport report;
  report.position_deg = position - zero_deg_;
  report.age = age;
  if (task_ != Task::kNone || pending_move_ || (Moves(status.state) && fault_.empty())) {
    report.motion = TableMotion::kMoving;
  } else if (!unhomed_.empty()) {
    report.motion = TableMotion::kUnhomed;
    report.fault = unhomed_;
  } else if (status.state == State::kAlarm) {
    report.motion = TableMotion::kUnhomed;
    report.fault = alarm_ >= 0 ? AlarmWords(alarm_) : "it is locked (Alarm): home it";
  } else if (!fault_.empty()) {
    report.motion = TableMotion::kFault;
    report.fault = fault_;
  } else if (status.state != State::kIdle) {
    report.motion = TableMotion::kFault;
    report.fault = "the controller reports " + status.state_word;
  }
  events_.push_back(std::move(report));
}

}  // namespace turnlight::rig::serial::grbl
