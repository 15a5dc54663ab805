#include "rig/sim/stage/smc100_firmware.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::sim::stage {
namespace {

using std::chrono::milliseconds;

constexpr DeviceTime kBootTime = milliseconds(1000);
constexpr DeviceTime kLineTime = milliseconds(10);
constexpr std::size_t kRxBytes = 256, kXoffAt = 192, kXonAt = 64;
constexpr char kXon = 0x11, kXoff = 0x13;

constexpr int kNegativeEnd = 0x0001, kPositiveEnd = 0x0002, kRmsCurrent = 0x0008,
              kFollowingError = 0x0020, kHomingTimeout = 0x0040;

const std::map<char, const char*>& ErrorTexts() {
  static const std::map<char, const char*> kTexts = {
      {'@', "No error"},
      {'A', "Unknown message code or floating point controller address"},
      {'B', "Controller address not correct"},
      {'C', "Parameter missing or out of range"},
      {'D', "Command not allowed"},
      {'E', "Home sequence already started"},
      {'G', "Displacement out of limits"},
      {'H', "Command not allowed in NOT REFERENCED state"},
      {'I', "Command not allowed in CONFIGURATION state"},
      {'J', "Command not allowed in DISABLE state"},
      {'K', "Command not allowed in READY state"},
      {'L', "Command not allowed in HOMING state"},
      {'M', "Command not allowed in MOVING state"}};
  return kTexts;
}

std::optional<double> Number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Five decimals, those at the end that say nothing left out.
std::string Degrees(double value) {
  std::string text = Format("%.5f", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

}  // namespace

Smc100Firmware::Smc100Firmware(Smc100Config config, std::shared_ptr<MockTurntable> table)
    : config_(config),
      table_(std::move(table)),
      velocity_(table_->config().max_speed_deg_s),
      acceleration_(table_->config().acceleration_deg_s2),
      min_deg_(config.min_deg),
      max_deg_(config.max_deg) {}

bool Smc100Firmware::IsReady() const {
  return state_ >= State::kReadyFromHoming && state_ <= State::kReadyFromDisable;
}
bool Smc100Firmware::IsNotReferenced() const { return state_ <= State::kNotReferencedFromMoving; }
bool Smc100Firmware::IsDisabled() const { return state_ >= State::kDisableFromReady; }

char Smc100Firmware::LetterOfState() const {
  if (IsNotReferenced()) return 'H';
  if (IsDisabled()) return 'J';
  if (IsReady()) return 'K';
  return state_ == State::kHoming ? 'L' : 'M';
}

void Smc100Firmware::PowerOn(DeviceTime now) {
  table_->Cut(now);
  table_->SetCount(0.0, now);
  state_ = State::kNotReferencedFromReset;
  errors_ = 0;
  error_ = '@';
  setpoint_deg_ = 0.0;
  rx_.clear();
  held_off_ = stopped_ = false;
  boots_at_ = now + kBootTime;
}

void Smc100Firmware::StepMotion(DeviceTime now) {
  const MockTurntable::MotorState motor = table_->Motor(now);
  if (motor.moving) return;
  state_ = State::kReadyFromMoving;
  if (std::exchange(stopped_, false) || motor.stopped_by) setpoint_deg_ = motor.counted_deg;
  if (!motor.stopped_by) return;
  switch (*motor.stopped_by) {
    case FaultKind::kReset:
      return PowerOn(now);
    case FaultKind::kStall:
      errors_ |= kFollowingError;
      state_ = State::kDisableFromMoving;
      break;
    case FaultKind::kAlarm:
      errors_ |= kRmsCurrent;
      state_ = State::kDisableFromMoving;
      break;
    case FaultKind::kLimit:
      errors_ |= upwards_ ? kPositiveEnd : kNegativeEnd;
      state_ = State::kNotReferencedFromMoving;
      break;
    default:
      break;
  }
}

void Smc100Firmware::StepHoming(DeviceTime now) {
  const MockTurntable::MotorState motor = table_->Motor(now);
  if (motor.moving && now < home_deadline_) return;
  state_ = State::kNotReferencedFromHoming;
  if (motor.moving) {
    table_->Cut(now);
    errors_ |= kHomingTimeout;
  } else if (motor.stopped_by == FaultKind::kStuckSwitch) {
    errors_ |= kPositiveEnd;
  } else {
    state_ = State::kReadyFromHoming;
    setpoint_deg_ = motor.counted_deg;
  }
}

void Smc100Firmware::Pass(DeviceTime now) {
  if (boots_at_) {
    if (now < *boots_at_) return;
    boots_at_.reset();
  }
  if (state_ == State::kMoving) StepMotion(now);
  if (state_ == State::kHoming) StepHoming(now);
  while (!boots_at_ && now >= free_at_) {
    const std::size_t end = rx_.find('\n');
    if (end == std::string::npos) break;
    std::string line = rx_.substr(0, end);
    rx_.erase(0, end + 1);
    while (!line.empty() && line.back() == '\r') line.pop_back();
    free_at_ = now + kLineTime;
    TakeLine(line, now);
  }
  if (held_off_ && rx_.size() < kXonAt) {
    held_off_ = false;
    Say(MessageKind::kPush, std::string(1, kXon));
  }
}

void Smc100Firmware::Receive(std::string_view bytes, DeviceTime now) {
  Pass(now);
  if (boots_at_) return;
  for (const char byte : bytes)
    if (rx_.size() < kRxBytes) rx_ += byte;
  if (rx_.size() == kRxBytes && rx_.find('\n') == std::string::npos) rx_.clear();
  Pass(now);
  if (held_off_ || rx_.size() < kXoffAt) return;
  held_off_ = true;
  Say(MessageKind::kPush, std::string(1, kXoff));
}

void Smc100Firmware::TakeLine(const std::string& line, DeviceTime now) {
  std::size_t digits = 0;
  while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits]))) ++digits;
  std::string name = line.substr(digits, 2);
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const int address = digits > 0 && digits < 4 ? std::atoi(line.c_str()) : 0;
  if (digits == 0 && name == "ST") return Stop(now);  // all controllers
  if (address != config_.address) return;
  if (name.size() < 2) {
    error_ = 'A';
    return;
  }
  Execute(name, line.substr(digits + 2), now);
}

void Smc100Firmware::Answer(MessageKind kind, const std::string& name, const std::string& value) {
  Say(kind, Format("%d", config_.address) + name + value + "\r\n");
}

double* Smc100Firmware::Parameter(const std::string& name) {
  if (name == "VA") return &velocity_;
  if (name == "AC") return &acceleration_;
  if (name == "SL") return &min_deg_;
  if (name == "SR") return &max_deg_;
  if (name == "OT") return &home_timeout_s_;
  return nullptr;
}

std::optional<std::string> Smc100Firmware::Asked(const std::string& name, const std::string& value,
                                                 DeviceTime now) {
  if (name == "TS") return Format("%04X%02X", errors_, static_cast<int>(state_));
  if (name == "TE") return std::string(1, std::exchange(error_, '@'));
  if (name == "TP") return Degrees(table_->Motor(now).counted_deg);
  if (name == "TH") return Degrees(setpoint_deg_);
  if (name == "VE") return " SMC_CC_1.0.0";
  if (name == "TB") {
    const char letter = value.empty() ? error_ : value.front();
    const auto text = ErrorTexts().find(letter);
    if (text == ErrorTexts().end()) return std::nullopt;
    return std::string(1, letter) + " " + text->second;
  }
  if (value != "?") return std::nullopt;
  if (name == "ID") return "URS100CC_" + table_->config().serial;
  if (name == "PA") return Degrees(setpoint_deg_);
  if (name == "MM") return IsDisabled() ? "0" : "1";
  if (const double* parameter = Parameter(name)) return Degrees(*parameter);
  return std::nullopt;
}

void Smc100Firmware::Execute(const std::string& name, const std::string& value, DeviceTime now) {
  const auto answer = Asked(name, value, now);
  if (!answer) return Command(name, value, now);
  const bool status = name == "TS" || name == "TP";
  Answer(status ? MessageKind::kStatus : MessageKind::kReply, name, *answer);
}

void Smc100Firmware::Command(const std::string& name, const std::string& value, DeviceTime now) {
  if (name == "OR") return BeginHoming(now);
  if (name == "ST") return Stop(now);
  if (name == "RS") return PowerOn(now);
  if (name == "MM") return SetMotor(value, now);
  const auto number = Number(value);
  double* parameter = Parameter(name);
  if (name != "PA" && name != "PR" && !parameter) {
    error_ = 'A';
  } else if (!number) {
    error_ = 'C';
  } else if (parameter) {
    const bool limit = name == "SL" || name == "SR";
    const bool low = name == "SL" && *number > setpoint_deg_;
    const bool high = name == "SR" && *number < setpoint_deg_;
    const bool too_fast = name == "VA" && *number > table_->config().max_speed_deg_s;
    if (low || high || too_fast || (!limit && *number <= 0.0))
      error_ = 'C';
    else
      *parameter = *number;
  } else if (!IsReady()) {
    error_ = LetterOfState();
  } else {
    Move(name == "PR" ? setpoint_deg_ + *number : *number, now);
  }
}

void Smc100Firmware::Move(double to_deg, DeviceTime now) {
  if (to_deg < min_deg_ || to_deg > max_deg_) {
    error_ = 'G';
    return;
  }
  errors_ = 0;
  upwards_ = to_deg >= setpoint_deg_;
  setpoint_deg_ = to_deg;
  state_ = State::kMoving;
  table_->Drive(to_deg, velocity_, acceleration_, now);
}

void Smc100Firmware::BeginHoming(DeviceTime now) {
  if (!IsNotReferenced()) {
    error_ = state_ == State::kHoming ? 'E' : LetterOfState();
    return;
  }
  errors_ = 0;
  state_ = State::kHoming;
  home_deadline_ =
      now + DeviceTime(static_cast<std::int64_t>(std::min(home_timeout_s_, 1e6) * 1e9));
  table_->SearchHome(table_->config().home_speed_deg_s, acceleration_, now);
}

void Smc100Firmware::Stop(DeviceTime now) {
  if (state_ == State::kHoming) {
    table_->Cut(now);
    state_ = State::kNotReferencedFromHoming;
  } else if (state_ == State::kMoving) {
    table_->Brake(now);
    stopped_ = true;
  } else if (!IsReady()) {
    error_ = LetterOfState();
  }
}

void Smc100Firmware::SetMotor(const std::string& value, DeviceTime now) {
  if (value != "0" && value != "1") {
    error_ = 'C';
  } else if (value == "0" && IsReady()) {
    state_ = State::kDisableFromReady;
  } else if (value == "1" && IsDisabled()) {
    errors_ = 0;
    setpoint_deg_ = table_->Motor(now).counted_deg;
    state_ = State::kReadyFromDisable;
  } else {
    error_ = LetterOfState();
  }
}

}  // namespace turnlight::rig::sim::stage
