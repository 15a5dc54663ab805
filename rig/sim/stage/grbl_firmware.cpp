#include "rig/sim/stage/grbl_firmware.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::sim::stage {
namespace {

using std::chrono::milliseconds;

// The bootloader's silence, and the pause after an alarm's message in which nothing is looked at.
constexpr DeviceTime kBootSilence = milliseconds(500);
constexpr DeviceTime kAlarmDelay = milliseconds(500);
constexpr std::size_t kLineBytes = 80;
constexpr double kSecondsPerMinute = 60.0;
constexpr char kSoftReset = 0x18;

DeviceTime AfterSeconds(DeviceTime now, double seconds) {
  return now + DeviceTime(static_cast<std::int64_t>(std::min(seconds, 1e8) * 1e9));
}

}  // namespace

GrblFirmware::GrblFirmware(GrblConfig config, std::shared_ptr<MockTurntable> table)
    : config_(std::move(config)),
      table_(std::move(table)),
      settings_(table_->config(), axes(), config_.axis == 'A' ? 3 : 0, config_.settings),
      startup_(config_.startup) {}

double GrblFirmware::Position(DeviceTime now) const {
  return std::round(table_->Motor(now).counted_deg * table_->config().steps_per_deg) /
         settings_.steps_per_deg();
}

// What the motor turns when these steps are counted; not the same if $100 is wrong.
double GrblFirmware::TableDeg(double position) const {
  return std::round(position * settings_.steps_per_deg()) / table_->config().steps_per_deg;
}

void GrblFirmware::PowerOn(DeviceTime now) {
  table_->Cut(now);
  table_->SetCount(0.0, now);
  alarm_ = settings_.IsSet(22);
  locked_ = line_open_ = false;
  after_delay_ = AfterAlarm::kNothing;
  boots_at_ = now + kBootSilence;
}

// Where a reset of any kind ends: everything volatile is new, the count and an alarm stay.
void GrblFirmware::Restart(DeviceTime now) {
  if (std::exchange(line_open_, false)) Answer(std::nullopt);
  rx_.clear();
  line_.clear();
  overflow_ = parentheses_ = comment_ = false;
  block_.reset();
  dwell_until_.reset();
  modes_ = {};
  planner_.clear();
  active_.reset();
  planned_ = Position(now);
  held_ = homing_ = soft_limit_ = locked_ = on_switch_ = status_wanted_ = false;
  after_delay_ = AfterAlarm::kNothing;
  wco_counter_ = ov_counter_ = 0;
  Say(MessageKind::kPush, is_hal() ? "\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n"
                                   : "\r\nGrbl 1.1h ['$' for help]\r\n");
  if (alarm_)
    Say(MessageKind::kPush, "[MSG:'$H'|'$X' to unlock]\r\n");
  else
    RunStartupLines(now);
}

void GrblFirmware::Reset(DeviceTime now) {
  modes_.spindle = 5;
  const bool turns = held_ ? table_->Motor(now).moving : Moves();
  if (homing_ || turns) {
    table_->Cut(now);
    Alarm(homing_ ? 6 : 3, AfterAlarm::kRestart, now);
  } else {
    Restart(now);
  }
}

void GrblFirmware::Alarm(int code, AfterAlarm after, DeviceTime now) {
  alarm_ = true;
  homing_ = held_ = soft_limit_ = false;
  block_.reset();
  planner_.clear();
  active_.reset();
  modes_.spindle = 5;
  Say(MessageKind::kPush, Format("ALARM:%d\r\n", code));
  delay_until_ = now + kAlarmDelay;
  after_delay_ = after;
}

void GrblFirmware::RealTime(char byte, DeviceTime now) {
  if (byte == kSoftReset) {
    // In the pause before a lock it is forgotten.
    if (now >= delay_until_) Reset(now);
  } else if (byte == '?') {
    status_wanted_ = true;
  } else if (byte == '!') {
    Hold(now);
  } else if (byte == '~') {
    Resume(now);
  }
}

void GrblFirmware::Hold(DeviceTime now) {
  if (alarm_ || homing_ || held_) return;
  held_ = true;
  if (active_) table_->Brake(now);
}

void GrblFirmware::Resume(DeviceTime now) {
  if (!held_ || table_->Motor(now).moving) return;
  held_ = false;
  if (active_) Start(*active_, now);
}

void GrblFirmware::Start(const Move& move, DeviceTime now) {
  active_ = move;
  const double per_table_deg = settings_.steps_per_deg() / table_->config().steps_per_deg;
  table_->Drive(TableDeg(move.target), move.rate / kSecondsPerMinute * per_table_deg,
                settings_.acceleration() * per_table_deg, now);
}

void GrblFirmware::StepMotion(DeviceTime now) {
  const MockTurntable::MotorState motor = table_->Motor(now);
  if (motor.moving) return;
  if (active_ && motor.stopped_by == FaultKind::kReset) return PowerOn(now);
  if (active_ && (motor.stopped_by == FaultKind::kAlarm || motor.stopped_by == FaultKind::kLimit)) {
    on_switch_ = motor.stopped_by == FaultKind::kLimit;
    return Alarm(1, AfterAlarm::kLock, now);
  }
  if (soft_limit_) return Alarm(2, AfterAlarm::kLock, now);
  if (held_) return;
  active_.reset();
  if (planner_.empty()) return;
  const Move next = planner_.front();
  planner_.pop_front();
  Start(next, now);
}

void GrblFirmware::StepHoming(DeviceTime now) {
  const MockTurntable::MotorState motor = table_->Motor(now);
  if (motor.moving && now < homing_deadline_) return;
  if (motor.moving) {
    table_->Cut(now);
    return Alarm(9, AfterAlarm::kRestart, now);
  }
  if (motor.stopped_by == FaultKind::kStuckSwitch) {
    on_switch_ = true;
    return Alarm(8, AfterAlarm::kRestart, now);
  }
  if (std::exchange(status_wanted_, false)) ReportStatus(now);
  homing_ = alarm_ = false;
  planned_ = Position(now);
  RunStartupLines(now);
  Answer(std::nullopt);
}

void GrblFirmware::Pass(DeviceTime now) {
  if (boots_at_) {
    if (now < *boots_at_) return;
    boots_at_.reset();
    Restart(now);
  }
  if (now < delay_until_) return;
  const AfterAlarm after = std::exchange(after_delay_, AfterAlarm::kNothing);
  if (after == AfterAlarm::kRestart) Restart(now);
  if (after == AfterAlarm::kLock) {
    locked_ = true;
    Say(MessageKind::kPush, "[MSG:Reset to continue]\r\n");
  }
  if (locked_) return;
  if (homing_) {
    StepHoming(now);
  } else if (Moves()) {
    StepMotion(now);
  }
  if (boots_at_ || homing_ || now < delay_until_) return;
  StepBlock(now);
  if (std::exchange(status_wanted_, false)) ReportStatus(now);
  ReadLines(now);
}

void GrblFirmware::Receive(std::string_view bytes, DeviceTime now) {
  Pass(now);
  for (const char byte : bytes) {
    if (boots_at_) return;
    const bool real_time = byte == '?' || byte == '!' || byte == '~' || byte == kSoftReset;
    if (real_time) {
      RealTime(byte, now);
    } else if ((byte & 0x80) == 0 && rx_.size() < rx_bytes()) {  // 0x80 and up: overrides
      rx_ += byte;
      ReadLines(now);
    }
  }
  Pass(now);
}

void GrblFirmware::ReadLines(DeviceTime now) {
  std::size_t taken = 0;
  while (taken < rx_.size() && !line_open_ && !held_ && !locked_ && now >= delay_until_) {
    const char byte = rx_[taken++];
    if (byte != '\r' && byte != '\n') {
      TakeCharacter(byte);
      continue;
    }
    const std::string line = std::exchange(line_, {});
    const bool overflow = std::exchange(overflow_, false);
    parentheses_ = comment_ = false;
    line_open_ = true;
    if (overflow)
      Answer(GrblError::kLineOverflow);
    else
      Execute(line, now);
  }
  rx_.erase(0, taken);
}

void GrblFirmware::TakeCharacter(char byte) {
  if (overflow_ || comment_) return;
  if (parentheses_) {
    parentheses_ = byte != ')';
  } else if (byte == '(') {
    parentheses_ = true;
  } else if (byte == ';') {
    comment_ = true;
  } else if (byte > ' ' && byte != '/') {
    overflow_ = line_.size() >= kLineBytes - 1;
    if (!overflow_)
      line_ += byte >= 'a' && byte <= 'z' ? static_cast<char>(byte - 'a' + 'A') : byte;
  }
}

void GrblFirmware::Execute(const std::string& line, DeviceTime now) {
  if (line.empty()) return Answer(std::nullopt);
  if (line.front() == '$') return ExecuteSystem(line, now);
  if (alarm_) return Answer(GrblError::kLocked);
  if (const auto error = BeginBlock(line)) return Answer(error);
  StepBlock(now);
}

std::optional<GrblError> GrblFirmware::BeginBlock(const std::string& line) {
  const auto read = ReadGcode(line, modes_, config_.axis, axes(), planned_);
  if (const auto* error = std::get_if<GrblError>(&read)) return *error;
  block_ = std::get<GcodeBlock>(read);
  return std::nullopt;
}

// Goes on with the block of the open line as far as it can now; answers when it is through.
void GrblFirmware::StepBlock(DeviceTime now) {
  if (!block_ || held_ || soft_limit_) return;
  const bool laser = settings_.IsSet(32);
  if (block_->spindle_changes && !laser && !IsStill(now)) return;
  block_->spindle_changes = false;
  if (block_->dwell_s) {
    if (!dwell_until_) {
      if (!IsStill(now)) return;
      dwell_until_ = AfterSeconds(now, *block_->dwell_s);
    }
    if (now < *dwell_until_) return;
    dwell_until_.reset();
    block_->dwell_s.reset();
  }
  if (block_->target) {
    const double fastest = settings_.max_rate();
    const double rate = std::min(block_->feed.value_or(fastest), fastest);
    if (!Plan({*block_->target, std::max(rate, 1e-3)}, now)) return;
  }
  modes_ = block_->modes;
  block_.reset();
  if (line_open_) Answer(std::nullopt);
}

// False: there is no room yet, or the target is outside and the line stays open until a reset.
bool GrblFirmware::Plan(const Move& move, DeviceTime now) {
  if (settings_.IsSet(20)) {
    const int bit = is_hal() ? 8 : 1;
    const bool upwards = (static_cast<int>(settings_.Value(23)) & bit) != 0;
    const double low = upwards ? 0.0 : -settings_.travel(), high = low + settings_.travel();
    if (move.target < low || move.target > high) {
      soft_limit_ = true;
      planner_.clear();
      block_.reset();
      if (active_)
        table_->Brake(now);
      else
        Alarm(2, AfterAlarm::kLock, now);
      return false;
    }
  }
  if (planner_.size() + (active_ ? 1 : 0) >= planner_blocks()) return false;
  planned_ = move.target;
  if (Moves())
    planner_.push_back(move);
  else
    Start(move, now);
  return true;
}

void GrblFirmware::RunStartupLines(DeviceTime now) {
  for (const std::string& line : startup_) {
    if (line.empty()) continue;
    const auto error = BeginBlock(line);
    const std::string result = error ? Format("error:%d", static_cast<int>(*error)) : "ok";
    const bool open = std::exchange(line_open_, false);
    StepBlock(now);
    line_open_ = open;
    block_.reset();
    dwell_until_.reset();
    Say(MessageKind::kPush, ">" + line + ":" + result + "\r\n");
  }
}

void GrblFirmware::Answer(std::optional<GrblError> error) {
  line_open_ = false;
  Say(MessageKind::kReply,
      error ? Format("error:%d\r\n", static_cast<int>(*error)) : std::string("ok\r\n"));
}

}  // namespace turnlight::rig::sim::stage
