#include "rig/sim/stage/zaber_firmware.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::sim::stage {
namespace {

using std::chrono::milliseconds;

constexpr DeviceTime kBoot = milliseconds(200);
constexpr DeviceTime kDriverCools = milliseconds(1000);
constexpr std::size_t kMaxLine = 120;
// Speeds are data / 1.6384 microsteps a second, accelerations 1e4 times as much a second.
constexpr double kSpeedUnit = 1.6384;
constexpr double kAccelerationUnit = 1.6384e-4;
// The gravest first; the others follow in this order.
constexpr const char* kFlagOrder[] = {"FD", "FS", "FE", "WM", "WR", "WH", "NI"};
// What is the controller's and not an axis's.
constexpr const char* kOfDevice[] = {"device.id",        "deviceid",       "version",
                                     "version.build",    "system.serial",  "comm.address",
                                     "system.axiscount", "comm.alert",     "comm.checksum",
                                     "system.access",    "system.voltage", "system.temperature"};

bool IsOfDevice(const std::string& name) {
  return std::find(std::begin(kOfDevice), std::end(kOfDevice), name) != std::end(kOfDevice);
}

std::optional<std::int64_t> WholeNumber(const std::string& word) {
  char* end = nullptr;
  const long long value = std::strtoll(word.c_str(), &end, 10);
  if (word.empty() || word.size() > 15 || *end != '\0') return std::nullopt;
  return value;
}

}  // namespace

ZaberFirmware::ZaberFirmware(ZaberConfig config, std::shared_ptr<MockTurntable> table)
    : config_(config), table_(std::move(table)) {
  const MockTurntableConfig& motor = table_->config();
  const double steps = motor.steps_per_deg;
  const auto acceleration = std::llround(motor.acceleration_deg_s2 * steps * kAccelerationUnit);
  settings_ = {
      {"maxspeed", std::llround(motor.max_speed_deg_s * steps * kSpeedUnit)},
      {"accel", std::max<long long>(1, acceleration)},
      {"limit.approach.maxspeed", std::llround(motor.home_speed_deg_s * steps * kSpeedUnit)},
      {"limit.min", std::llround(config_.min_deg * steps)},
      {"limit.max", std::llround(config_.max_deg * steps)},
      {"limit.cycle.dist", std::llround(360.0 * steps)},
      {"resolution", 64},
      {"knob.enable", 1},
      {"system.access", 1},
      {"comm.alert", 0},
      {"comm.checksum", config_.checksum ? 1 : 0}};
}

void ZaberFirmware::PowerOn(DeviceTime now) {
  table_->Cut(now);
  table_->SetCount(0.0, now);
  flags_ = {"WR", "WH"};
  line_.clear();
  driver_off_until_.reset();
  moving_ = homing_ = displaced_ = false;
  boots_at_ = now + kBoot;
}

std::int64_t ZaberFirmware::Position(DeviceTime now) const {
  return std::llround(table_->Motor(now).counted_deg * table_->config().steps_per_deg);
}

std::vector<std::string> ZaberFirmware::Flags(DeviceTime now) const {
  std::vector<std::string> flags;
  for (const char* flag : kFlagOrder) {
    const bool driver_off = driver_off_until_ && now < *driver_off_until_;
    if (std::string(flag) == "FD" ? driver_off : flags_.contains(flag)) flags.emplace_back(flag);
  }
  return flags;
}

std::string ZaberFirmware::Header(DeviceTime now, bool reply_accepted, bool is_reply) const {
  const std::vector<std::string> flags = Flags(now);
  return std::string(is_reply ? (reply_accepted ? "OK " : "RJ ") : "") +
         (IsBusy(now) ? "BUSY " : "IDLE ") + (flags.empty() ? "--" : flags.front());
}

std::string ZaberFirmware::Packed(char marker, const std::string& text) const {
  const std::string sum = settings_.at("comm.checksum") == 1 ? ":" + ZaberChecksum(text) : "";
  return marker + text + sum + "\r\n";
}

void ZaberFirmware::EndMotion(DeviceTime now) {
  const MockTurntable::MotorState motor = table_->Motor(now);
  if (motor.moving) return;
  // Also of one that stands: it is moved by hand.
  if (motor.stopped_by == FaultKind::kDisplaced && !moving_ && !displaced_ &&
      table_->config().feedback == TableFeedback::kEncoder) {
    displaced_ = true;
    flags_.insert("WM");
  }
  if (!moving_) return;
  if (motor.stopped_by == FaultKind::kReset) return PowerOn(now);
  moving_ = false;
  if (motor.stopped_by == FaultKind::kStall) flags_.insert("FS");
  if (motor.stopped_by == FaultKind::kLimit) flags_.insert("FE");
  if (motor.stopped_by == FaultKind::kAlarm) {
    driver_off_until_ = now + kDriverCools;
    flags_.insert("WR");
  }
  if (std::exchange(homing_, false) && motor.stopped_by != FaultKind::kStuckSwitch) {
    flags_.erase("WR");
    flags_.erase("WH");
  }
  if (settings_.at("comm.alert") == 1)
    Say(MessageKind::kPush,
        Packed('!', Format("%02d 1 ", config_.device) + Header(now, true, false)));
}

void ZaberFirmware::Pass(DeviceTime now) {
  if (boots_at_) {
    if (now < *boots_at_) return;
    boots_at_.reset();
  }
  EndMotion(now);
}

void ZaberFirmware::Receive(std::string_view bytes, DeviceTime now) {
  Pass(now);
  for (const char byte : bytes) {
    if (boots_at_) return;
    if (byte == '\r' || byte == '\n') {
      const std::string line = std::exchange(line_, {});
      if (!line.empty() && line.size() <= kMaxLine) TakeLine(line, now);
    } else if (byte == '/') {  // begins a command wherever it comes
      line_ = byte;
    } else if (line_.size() <= kMaxLine) {
      line_ += byte;
    }
  }
}

void ZaberFirmware::TakeLine(const std::string& line, DeviceTime now) {
  const auto command = ReadZaberCommand(line);
  if (!command || (command->device != 0 && command->device != config_.device)) return;
  const bool poll = command->words.empty() || command->words.front() == "get";
  const Outcome outcome = command->axis > 1 ? Rejected("BADAXIS") : Execute(*command, now);
  if (boots_at_) return;
  std::string text = Format("%02d %d ", config_.device, command->axis);
  if (command->id) text += Format("%02d ", *command->id);
  text += Header(now, outcome.accepted, true) + " " + outcome.data;
  Say(poll ? MessageKind::kStatus : MessageKind::kReply, Packed('@', text));
}

ZaberFirmware::Outcome ZaberFirmware::Execute(const ZaberCommand& command, DeviceTime now) {
  const std::vector<std::string>& words = command.words;
  if (words.empty()) return {};
  const std::string& verb = words.front();
  if (verb == "home" && words.size() == 1) return Home(now);
  if (verb == "move") return Move(words, now);
  if (verb == "stop" && words.size() == 1) return Stop(false, now);
  if (verb == "estop" && words.size() == 1) return Stop(true, now);
  if (verb == "warnings") return Warnings(words, now);
  if (verb == "get" && words.size() == 2) return Get(command, now);
  if (verb == "set" && words.size() == 3) return Set(command);
  if (verb == "driver" && words.size() == 2 && words[1] == "enable") return {};
  if (verb == "tools" && words.size() >= 2 && words[1] == "echo") {
    std::string data;
    for (std::size_t i = 2; i < words.size(); ++i) data += (i == 2 ? "" : " ") + words[i];
    return {true, data.empty() ? "0" : data};
  }
  if (verb == "system" && words.size() == 2 && words[1] == "reset") {
    if (command.axis != 0) return Rejected("DEVICEONLY");
    const std::string text = Format("%02d 0 ", config_.device) +
                             (command.id ? Format("%02d ", *command.id) : std::string());
    Say(MessageKind::kReply, Packed('@', text + Header(now, true, true) + " 0"));
    PowerOn(now);
    return {};
  }
  return Rejected("BADCOMMAND");
}

bool ZaberFirmware::Preempt(DeviceTime now) {
  if (driver_off_until_ && now < *driver_off_until_) return false;
  if (IsBusy(now))
    flags_.insert("NI");
  else
    flags_.erase("NI");
  homing_ = displaced_ = false;
  moving_ = true;
  return true;
}

ZaberFirmware::Outcome ZaberFirmware::Home(DeviceTime now) {
  if (!Preempt(now)) return Rejected("DRIVERDISABLED");
  const double steps = table_->config().steps_per_deg;
  homing_ = true;
  table_->SearchHome(
      static_cast<double>(settings_.at("limit.approach.maxspeed")) / kSpeedUnit / steps,
      static_cast<double>(settings_.at("accel")) / kAccelerationUnit / steps, now);
  return {};
}

ZaberFirmware::Outcome ZaberFirmware::Move(const std::vector<std::string>& words, DeviceTime now) {
  std::int64_t target = 0;
  if (words.size() == 2 && (words[1] == "min" || words[1] == "max")) {
    target = settings_.at("limit." + words[1]);
  } else if (words.size() == 3 && (words[1] == "abs" || words[1] == "rel")) {
    const auto number = WholeNumber(words[2]);
    if (!number) return Rejected("BADDATA");
    target = words[1] == "rel" ? Position(now) + *number : *number;
  } else {
    return Rejected("BADCOMMAND");
  }
  const bool relative = words[1] == "rel";
  if (!relative && flags_.contains("WR")) return Rejected("BADDATA");
  if (target < settings_.at("limit.min") || target > settings_.at("limit.max"))
    return Rejected("BADDATA");
  if (!Preempt(now)) return Rejected("DRIVERDISABLED");
  const double steps = table_->config().steps_per_deg;
  table_->Drive(static_cast<double>(target) / steps,
                static_cast<double>(settings_.at("maxspeed")) / kSpeedUnit / steps,
                static_cast<double>(settings_.at("accel")) / kAccelerationUnit / steps, now);
  return {};
}

ZaberFirmware::Outcome ZaberFirmware::Stop(bool at_once, DeviceTime now) {
  if (!IsBusy(now)) return {};
  flags_.insert("NI");
  homing_ = false;
  if (at_once)
    table_->Cut(now);
  else
    table_->Brake(now);
  return {};
}

ZaberFirmware::Outcome ZaberFirmware::Warnings(const std::vector<std::string>& words,
                                               DeviceTime now) {
  const bool clear = words.size() == 2 && words[1] == "clear";
  if (words.size() > 1 && !clear) return Rejected("BADCOMMAND");
  const std::vector<std::string> flags = Flags(now);
  std::string data = Format("%02zu", flags.size());
  for (const std::string& flag : flags) data += " " + flag;
  if (clear)
    for (const char* flag : {"FS", "FE", "WM", "NI"}) flags_.erase(flag);
  return {true, data};
}

std::optional<std::string> ZaberFirmware::Measured(const std::string& name, DeviceTime now) const {
  if (name == "pos") return std::to_string(Position(now));
  if (name == "encoder.pos" && table_->config().feedback == TableFeedback::kEncoder)
    return std::to_string(Position(now));
  if (name == "device.id" || name == "deviceid") return "50926";
  if (name == "version") return "7.35";
  if (name == "version.build") return "16472";
  if (name == "system.serial") return table_->config().serial;
  if (name == "comm.address") return std::to_string(config_.device);
  if (name == "system.axiscount") return "1";
  if (name == "system.voltage") return "48.0";
  if (name == "system.temperature") return "31.5";
  if (name == "driver.temperature") return "36.2";
  return std::nullopt;
}

ZaberFirmware::Outcome ZaberFirmware::Get(const ZaberCommand& command, DeviceTime now) {
  const std::string& name = command.words[1];
  const auto measured = Measured(name, now);
  const auto setting = settings_.find(name);
  if (!measured && setting == settings_.end()) return Rejected("BADCOMMAND");
  if (command.axis != 0 && IsOfDevice(name)) return Rejected("DEVICEONLY");
  return {true, measured ? *measured : std::to_string(setting->second)};
}

ZaberFirmware::Outcome ZaberFirmware::Set(const ZaberCommand& command) {
  const std::string& name = command.words[1];
  const auto setting = settings_.find(name);
  if (setting == settings_.end()) return Rejected("BADCOMMAND");
  if (command.axis != 0 && IsOfDevice(name)) return Rejected("DEVICEONLY");
  const auto value = WholeNumber(command.words[2]);
  const bool one_bit = name == "comm.alert" || name == "comm.checksum" || name == "knob.enable";
  const bool positive = name == "maxspeed" || name == "accel" || name == "limit.approach.maxspeed";
  if (!value || (one_bit && *value != 0 && *value != 1) || (positive && *value <= 0))
    return Rejected("BADDATA");
  setting->second = *value;
  return {};
}

}  // namespace turnlight::rig::sim::stage
