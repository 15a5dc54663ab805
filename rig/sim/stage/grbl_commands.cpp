// The `$` lines and the reports of the simulated GRBL.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/format.h"
#include "rig/sim/stage/grbl_firmware.h"

namespace turnlight::rig::sim::stage {
namespace {

constexpr double kInch = 25.4;
// A field that changes hardly ever is in every so many reports.
constexpr int kWcoIdle = 10, kWcoBusy = 30, kOvIdle = 10, kOvBusy = 20;
// A search for the switch is given up after so much of the travel.
constexpr double kSearchTravels = 1.5;

// Whether a field that comes now and then comes in this report.
bool IsDue(int& counter, int idle, int busy, bool moves) {
  if (counter > 0) {
    --counter;
    return false;
  }
  counter = (moves ? busy : idle) - 1;
  return true;
}

}  // namespace

void GrblFirmware::ExecuteSystem(const std::string& line, DeviceTime now) {
  const std::string command = line.substr(1);
  const bool in_motion = held_ || Moves();
  if (command.empty()) {
    Say(MessageKind::kPush,
        "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n");
    return Answer(std::nullopt);
  }
  if (command == "G") {
    Say(MessageKind::kPush, ParserState());
    return Answer(std::nullopt);
  }
  if (command == "X") {
    if (alarm_) Say(MessageKind::kPush, "[MSG:Caution: Unlocked]\r\n");
    alarm_ = false;
    return Answer(std::nullopt);
  }
  if (in_motion) return Answer(GrblError::kNotIdle);
  if (command == "H") {
    if (const auto error = BeginHoming(now)) Answer(error);
    return;
  }
  if (command == "$") {
    Say(MessageKind::kPush, settings_.Listing());
  } else if (command == "I") {
    Say(MessageKind::kPush, BuildInfo());
  } else if (command == "#") {
    Say(MessageKind::kPush, Parameters());
  } else if (command == "N") {
    for (std::size_t i = 0; i < startup_.size(); ++i)
      Say(MessageKind::kPush, Format("$N%zu=%s\r\n", i, startup_[i].c_str()));
  } else {
    return Answer(StoreSetting(line));
  }
  Answer(std::nullopt);
}

std::optional<GrblError> GrblFirmware::BeginHoming(DeviceTime now) {
  if (!settings_.IsSet(22)) return GrblError::kHomingDisabled;
  homing_ = true;
  const double speed = settings_.Value(25) / 60.0;
  table_->SearchHome(speed, settings_.acceleration(), now);
  const double seconds = std::min(kSearchTravels * settings_.travel() / speed, 1e6);
  homing_deadline_ = now + DeviceTime(static_cast<std::int64_t>(seconds * 1e9));
  return std::nullopt;
}

// `$n=value` or `$Nn=line`.
std::optional<GrblError> GrblFirmware::StoreSetting(const std::string& line) {
  const std::size_t equals = line.find('=');
  const bool startup = line.size() > 1 && line[1] == 'N';
  const std::string number = line.substr(startup ? 2 : 1, equals - (startup ? 2 : 1));
  if (number.empty() || number.find_first_not_of("0123456789.") != std::string::npos)
    return GrblError::kBadNumber;
  if (equals == std::string::npos) return GrblError::kInvalidStatement;
  const double which = std::strtod(number.c_str(), nullptr);
  const std::string value = line.substr(equals + 1);
  if (startup) {
    if (alarm_) return GrblError::kNotIdle;
    if (which != 0.0 && which != 1.0) return GrblError::kInvalidStatement;
    startup_[static_cast<std::size_t>(which)] = value;
    return std::nullopt;
  }
  if (value.empty() || value.find_first_not_of("-.0123456789") != std::string::npos)
    return GrblError::kBadNumber;
  return settings_.Store(which, std::strtod(value.c_str(), nullptr));
}

std::string GrblFirmware::BuildInfo() const {
  if (is_hal())
    return "[VER:1.1f.20240116:" + config_.build_info +
           "]\r\n[OPT:VNZSL,35,1024,4,0]\r\n[AXS:4:XYZA]\r\n[NEWOPT:ENUMS,RT-]\r\n"
           "[FIRMWARE:grblHAL]\r\n";
  return "[VER:1.1h.20190830:" + config_.build_info + "]\r\n[OPT:VZ,15,128]\r\n";
}

std::string GrblFirmware::Parameters() const {
  std::string text;
  for (const char* name : {"G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30", "G92"})
    text += Format("[%s:%s]\r\n", name, Coordinates(0.0).c_str());
  return text + "[TLO:0.000]\r\n[PRB:" + Coordinates(0.0) + ":0]\r\n";
}

std::string GrblFirmware::ParserState() const {
  return Format("[GC:G%d G54 G17 G%d G%d G%d M%d M9 T0 F%.0f S%.0f]\r\n", modes_.motion,
                modes_.inches ? 20 : 21, modes_.relative ? 91 : 90, modes_.inverse_time ? 93 : 94,
                modes_.spindle, modes_.feed, modes_.spindle_speed);
}

std::string GrblFirmware::StateWord(DeviceTime now) const {
  if (alarm_ && !homing_) return "Alarm";
  if (homing_) return "Home";
  if (held_) return table_->Motor(now).moving ? "Hold:1" : "Hold:0";
  return Moves() ? "Run" : "Idle";
}

// Of all axes; the others stand at 0.
std::string GrblFirmware::Coordinates(double turned) const {
  const bool inches = settings_.IsSet(13);
  std::string text;
  for (const char* letter = axes(); *letter != '\0'; ++letter) {
    const double value = *letter == config_.axis ? turned : 0.0;
    if (!text.empty()) text += ',';
    text += inches ? Format("%.4f", value / kInch) : Format("%.3f", value);
  }
  return text;
}

void GrblFirmware::ReportStatus(DeviceTime now) {
  const bool moves = homing_ || held_ || Moves();
  const int mask = static_cast<int>(settings_.Value(10));
  // There are no offsets, so both positions are the same number.
  std::string text =
      "<" + StateWord(now) + ((mask & 1) != 0 ? "|MPos:" : "|WPos:") + Coordinates(Position(now));
  if ((mask & 2) != 0)
    text += Format("|Bf:%zu,%zu", planner_blocks() - planner_.size() - (active_ ? 1 : 0),
                   rx_bytes() - rx_.size());
  const double rate = table_->Motor(now).speed_deg_s * 60.0 * table_->config().steps_per_deg /
                      settings_.steps_per_deg();
  const bool spins = modes_.spindle != 5;
  text += settings_.IsSet(13) ? Format("|FS:%.1f,", rate / kInch) : Format("|FS:%.0f,", rate);
  text += Format("%.0f", spins ? modes_.spindle_speed : 0.0);
  if (on_switch_) text += Format("|Pn:%c", config_.axis);
  if (IsDue(wco_counter_, kWcoIdle, kWcoBusy, moves)) {
    ov_counter_ = std::max(ov_counter_, 1);  // it comes in the next report
    text += "|WCO:" + Coordinates(0.0);
  }
  if (IsDue(ov_counter_, kOvIdle, kOvBusy, moves)) {
    text += "|Ov:100,100,100";
    if (spins) text += modes_.spindle == 3 ? "|A:S" : "|A:C";
  }
  Say(MessageKind::kStatus, text + ">\r\n");
}

}  // namespace turnlight::rig::sim::stage
