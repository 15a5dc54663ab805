// The part of the conversation that finds out who is there, and whether it may be moved.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "rig/serial/grbl/grbl_protocol.h"

namespace turnlight::rig::serial::grbl {
namespace {

constexpr DeviceTime kAnswerPatience = std::chrono::milliseconds(1500);
constexpr int kAttempts = 3;

}  // namespace

GrblOptions ReadGrblOptions(StrictObject& keys) {
  GrblOptions options;
  const auto axis = keys.OptionalChoice("axis", {"X", "Y", "Z", "A", "B", "C"});
  if (axis) options.axis = axis->front();
  if (const auto home = keys.OptionalChoice("home", {"switch", "here"}))
    options.home = *home == "here" ? Homing::kHere : Homing::kSwitch;
  const bool lamp = keys.OptionalChoice("lamp", {"on", "off"}) == "on";
  const auto power = keys.OptionalNumber("lamp_power", {.max = 1.0, .above = 0.0});
  if (lamp) options.lamp_power = power.value_or(1.0);
  return options;
}

// An empty line is answered by ok whatever came before it. A controller that says nothing at all
// may be held by a critical alarm, which only a reset ends.
void GrblProtocol::Resync() {
  phase_ = Phase::kResync;
  if (++attempts_ > kAttempts)
    return Fail("no answer: is a GRBL controller connected here, and is its baud rate right?",
                false);
  if (attempts_ == kAttempts) {
    unhomed_ = "it was reset, as it did not answer: home it";
    output_ += '\x18';
  }
  Send(Sent::kResync, "", kAnswerPatience);
}

void GrblProtocol::Identify(Sent step) {
  phase_ = Phase::kIdentify;
  const char* const line = step == Sent::kInfo       ? "$I"
                           : step == Sent::kSettings ? "$$"
                           : step == Sent::kStartup  ? "$N"
                                                     : "$#";
  Send(step, line, kAnswerPatience);
}

// Why this controller must not be moved, if so.
std::optional<std::string> GrblProtocol::Objection() const {
  const auto setting = [this](int number) { return SettingNumber(settings_, number); };
  const int axis = AxisIndex();
  const auto positive = [&](int number, double max) {
    const auto value = setting(number + axis);
    return value && *value > 0.0 && *value <= max;
  };
  for (const auto& [number, max] : {std::pair{100, 1e5}, {110, 6e6}, {120, 1e8}})
    if (!positive(number, max)) {
      const auto found = settings_.find(number + axis);
      return Format(
          "$%d=%s, allowed is a number above 0 and at most %g: axis %c is not set up, or the "
          "settings are damaged ($RST=$ restores the defaults)",
          number + axis, found == settings_.end() ? "(missing)" : found->second.c_str(), max,
          options_.axis);
    }
  if (setting(13).value_or(0.0) != 0.0)
    return "$13=1: it reports inches, allowed is $13=0 (send $13=0)";
  if (options_.home == Homing::kSwitch && setting(22).value_or(0.0) == 0.0)
    return "$22=0: homing is off. Allowed is $22=1 with a home switch, or in the config home: "
           "here, "
           "which takes where the table stands for 0 degrees";
  if (refused_startup_)
    return *refused_startup_ + ": a start-up line that moves, allowed is none (send " +
           refused_startup_->substr(0, refused_startup_->find('=') + 1) + ")";
  if (options_.lamp_power && setting(32).value_or(0.0) != 0.0)
    return "$32=1: in laser mode the output is off at rest, allowed with lamp: on is $32=0";
  return std::nullopt;
}

Homing GrblProtocol::HowHomed() const {
  const bool has_switch = SettingNumber(settings_, 22).value_or(0.0) != 0.0;
  return options_.home.value_or(has_switch ? Homing::kSwitch : Homing::kHere);
}

StageTraits GrblProtocol::Traits() const {
  const int axis = AxisIndex();
  StageTraits traits;
  traits.max_speed_deg_s = *SettingNumber(settings_, 110 + axis) / 60.0;
  traits.acceleration_deg_s2 = *SettingNumber(settings_, 120 + axis);
  traits.resolution_deg = StepDeg();
  if (SettingNumber(settings_, 20).value_or(0.0) != 0.0) {  // machine space with soft limits
    traits.min_deg = -SettingNumber(settings_, 130 + axis).value_or(0.0);
    traits.max_deg = 0.0;
  }
  return traits;
}

// The first report after the questions were answered.
void GrblProtocol::Identified(const StatusReport& status) {
  if (status.position.size() <= static_cast<std::size_t>(AxisIndex()))
    return Fail(Format("it has %zu axes, and axis %c is none of them: allowed is another key axis",
                       status.position.size(), options_.axis),
                true);
  if (status.state == State::kCheck)
    return Fail("it is in check mode, where nothing moves: send $C to leave it", true);
  if (auto objection = Objection()) return Fail(std::move(*objection), true);
  identified_ = true;
  phase_ = Phase::kReady;
  if (HowHomed() == Homing::kHere) unhomed_ = "its zero is not set yet: home it";
  const std::string firmware = banner_.firmware.empty() ? "Grbl" : banner_.firmware;
  events_.push_back(
      StageIdentified{{firmware, firmware + " " + version_.version, version_.name}, Traits()});
  if (SettingNumber(settings_, 1).value_or(255.0) != 255.0)
    Note("$1=" + settings_[1] +
         ": the motor is released when it stands, and may lose microsteps; $1=255 keeps it "
         "energised");
  if (!options_.home && HowHomed() == Homing::kHere)
    Note("$22=0: it has no home switch; homing takes where the table stands for 0 degrees");
  if (options_.speed_deg_s > *Traits().max_speed_deg_s * (1.0 + 1e-9))
    Note(Format("speed_deg_s %g is more than the controller allows: it moves at %g ($%d)",
                options_.speed_deg_s, *Traits().max_speed_deg_s, 110 + AxisIndex()));
  LightLamp();
}

// An ok before the answer is that of an earlier line.
void GrblProtocol::AwaitStill(Sent step) {
  sent_ = step;
  line_deadline_ = now_ + kAnswerPatience;
}

void GrblProtocol::OnNoIdentity() {
  if (strange_.empty()) return Fail("the controller does not answer to its identification", false);
  Fail("it answers, but is no GRBL 1.1 or grblHAL: it said \"" + strange_.front() + "\"", true);
}

void GrblProtocol::OnInfo() {
  if (version_.version.empty()) return AwaitStill(Sent::kInfo);
  if (version_.version.substr(0, 3) == "1.1") return Identify(Sent::kSettings);
  Fail("its firmware is version " + version_.version + ", allowed is GRBL 1.1 or grblHAL", true);
}

void GrblProtocol::OnOk() {
  const Sent was = std::exchange(sent_, Sent::kNothing);
  if (was == Sent::kNothing) return;  // a duplicate, or late: it completes nothing
  if (!reset_expected_ && task_ != Task::kHalting) line_deadline_.reset();
  switch (was) {
    case Sent::kResync:
      return Identify(Sent::kInfo);
    case Sent::kInfo:
      return OnInfo();
    case Sent::kSettings:
      if (settings_.empty()) return AwaitStill(Sent::kSettings);
      return Identify(Sent::kStartup);
    case Sent::kStartup:
      return Identify(Sent::kOffsets);
    case Sent::kOffsets:
      line_deadline_ = now_ + kAnswerPatience;
      return Query();
    case Sent::kUnlock:
      return Query();
    case Sent::kHome:
      alarm_ = -1;
      return Query();
    case Sent::kMove:
      still_ = 0;
      Send(Sent::kDwell, "G4 P0.01", std::chrono::hours(24));
      return;
    case Sent::kDwell:
      return Query();
    case Sent::kLamp:
    case Sent::kNothing:
      return;
  }
}

void GrblProtocol::OnError(int code) {
  const Sent was = std::exchange(sent_, Sent::kNothing);
  if (was == Sent::kNothing) return;
  if (!reset_expected_ && task_ != Task::kHalting) line_deadline_.reset();
  switch (was) {
    case Sent::kResync:  // the end of a line that somebody else began
      return Identify(Sent::kInfo);
    case Sent::kInfo:
    case Sent::kSettings:
      return Fail(
          "it refuses to say who it is: " + ErrorWords(code) +
              (code == 8 ? ": it was moving; try again" : ", allowed is GRBL 1.1 or grblHAL"),
          code != 8);
    case Sent::kStartup:
      return Identify(Sent::kOffsets);
    case Sent::kOffsets:
      line_deadline_ = now_ + kAnswerPatience;
      return Query();
    case Sent::kLamp:
      return Note("the lamp was refused: " + ErrorWords(code));
    case Sent::kDwell:
      return Query();
    default:
      break;
  }
  if (code == 9 || was == Sent::kHome) unhomed_ = ErrorWords(code);
  EndTask(ErrorWords(code));
}

}  // namespace turnlight::rig::serial::grbl
