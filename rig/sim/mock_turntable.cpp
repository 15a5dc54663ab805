#include "rig/sim/mock_turntable.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "base/format.h"
#include "rig/sim/turntable_segment.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMaxCommandDeg = 36000.0;
constexpr std::size_t kSegmentsKept = 64;
// Of a displacement by hand, after the arrival.
constexpr DeviceTime kUntilDisplaced = std::chrono::milliseconds(50);
// Of a homing that never ends: the motor is stopped long before.
constexpr double kEndlessSeconds = 1e6;

DeviceTime TruncatedFromMs(double ms) { return DeviceTime(static_cast<std::int64_t>(ms * 1e6)); }

}  // namespace

TrapezoidalProfile::TrapezoidalProfile(double distance, double speed, double acceleration)
    : distance_(distance), acceleration_(acceleration) {
  const double full_ramps = speed * speed / acceleration;
  ramp_s_ = distance < full_ramps ? std::sqrt(distance / acceleration) : speed / acceleration;
  cruise_s_ = distance < full_ramps ? 0.0 : (distance - full_ramps) / speed;
}

double TrapezoidalProfile::At(double t) const {
  if (!(t > 0.0)) return 0.0;
  if (t < ramp_s_) return 0.5 * acceleration_ * t * t;
  if (t < ramp_s_ + cruise_s_) return acceleration_ * ramp_s_ * (t - 0.5 * ramp_s_);
  const double left = Duration() - t;
  return left > 0.0 ? distance_ - 0.5 * acceleration_ * left * left : distance_;
}

MockTurntable::MockTurntable(MockTurntableConfig config, std::shared_ptr<FaultScript> faults)
    : config_(std::move(config)), faults_(std::move(faults)) {
  Segment power_on;
  power_on.outcome = TableMotion::kUnhomed;
  power_on.fault = "not homed since power-on";
  power_on.motor_from_deg = power_on.motor_to_deg = power_on.platter_from_deg =
      config_.power_on_deg;
  segments_.push_back(power_on);
}

MockTurntable::~MockTurntable() = default;

double MockTurntable::TrueOfSteps(std::int64_t steps) const {
  const auto home =
      static_cast<std::int64_t>(std::llround(config_.home_switch_deg * config_.steps_per_deg));
  return (static_cast<double>(home) + config_.scale * static_cast<double>(steps - home)) /
         config_.steps_per_deg;
}

const MockTurntable::Segment& MockTurntable::SegmentAt(DeviceTime time) const {
  for (std::size_t i = segments_.size(); i-- > 0;)
    if (segments_[i].begin <= time) return segments_[i];
  return segments_.front();
}

// At rest where the last segment ends.
MockTurntable::Segment MockTurntable::BeginSegment(DeviceTime begin) const {
  const Segment& last = segments_.back();
  Segment segment;
  segment.begin = segment.end = begin;
  segment.count_from = last.CountTo();
  segment.motor_from = last.MotorTo();
  segment.motor_from_deg = segment.motor_to_deg = last.motor_to_deg;
  segment.platter_from_deg = last.PlatterDeg(last.end, config_.backlash_deg);
  segment.scale = config_.scale;
  segment.commanded_deg = last.commanded_deg;
  return segment;
}

void MockTurntable::SetLeg(Segment& segment, std::int64_t to_steps,
                           const TrapezoidalProfile& profile) const {
  segment.profile = profile;
  segment.direction = to_steps < segment.count_from ? -1.0 : 1.0;
  segment.count_steps = segment.motor_steps = std::abs(to_steps - segment.count_from);
  segment.end = segment.begin + RoundUp(profile.Duration());
}

// An encoder knows where the motor really got to.
void MockTurntable::Finish(Segment& segment) const {
  if (config_.feedback == TableFeedback::kEncoder) segment.count_steps = segment.motor_steps;
  segment.motor_to_deg = TrueOfSteps(segment.MotorTo());
}

void MockTurntable::Append(Segment segment) {
  if (segments_.size() >= kSegmentsKept) segments_.erase(segments_.begin());
  segments_.push_back(std::move(segment));
}

void MockTurntable::StopMotor(DeviceTime now, TableMotion outcome, const std::string& fault) {
  while (segments_.size() > 1 && segments_.back().begin > now) segments_.pop_back();
  Segment& last = segments_.back();
  if (now < last.end) {
    if (last.homing) {
      last.motor_to_deg = last.MotorDeg(now);
    } else {
      const auto covered =
          static_cast<std::int64_t>(std::floor(last.Covered(now) * config_.steps_per_deg));
      last.count_steps = std::min(last.count_steps, covered);
      last.motor_steps = std::min(last.motor_steps, covered);
      Finish(last);
    }
    last.end = now;
    last.stopped_by.reset();
  }
  last.outcome = outcome;
  last.fault = fault;
}

Status MockTurntable::CheckLink(DeviceTime now) {
  const bool unplugged = now < unplugged_until_;
  if (faults_ && !unplugged) {
    if (const auto fault = faults_->Strike(FaultKind::kUnplugged, FaultDevice::kTable,
                                           SegmentAt(now).commanded_deg, now)) {
      open_ = false;
      unplugged_until_ = now + TruncatedFromMs(fault->amount);
      StopMotor(now, TableMotion::kUnhomed, "not homed since it was plugged in again");
    }
  }
  if (now < unplugged_until_) return DeviceError(config_.serial + ": unplugged");
  return {};
}

Result<DeviceIdentity> MockTurntable::Open(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (Status status = CheckLink(now); !status) return Forward(status);
  open_ = true;
  return DeviceIdentity{"turnlight", "mock turntable", config_.serial};
}

Status MockTurntable::Home(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (Status status = CheckLink(now); !status) return status;
  if (!open_) return DeviceError(config_.serial + ": not open");
  if (now < segments_.back().end) return DeviceError(config_.serial + ": it is moving already");
  BeginHoming(config_.home_speed_deg_s, config_.acceleration_deg_s2, now);
  return {};
}

void MockTurntable::BeginHoming(double speed_deg_s, double acceleration_deg_s2, DeviceTime now) {
  Segment segment = BeginSegment(now);
  const bool endless = faults_ && faults_->Strike(FaultKind::kNeverHomes, FaultDevice::kTable,
                                                  segment.commanded_deg, now);
  const double slack = segment.platter_from_deg - segment.motor_from_deg;
  segment.homing = true;
  segment.scale = segment.direction = 1.0;
  segment.count_from = segment.motor_from =
      static_cast<std::int64_t>(std::llround(config_.home_switch_deg * config_.steps_per_deg));
  const double home_deg = TrueOfSteps(segment.count_from);
  double way_deg = std::fmod(home_deg - segment.platter_from_deg, 360.0);
  if (way_deg < 0.0) way_deg += 360.0;
  way_deg = endless ? kEndlessSeconds * speed_deg_s : way_deg + slack;
  segment.profile = TrapezoidalProfile(way_deg, speed_deg_s, acceleration_deg_s2);
  segment.end = endless ? DeviceTime::max() : now + RoundUp(segment.profile.Duration());
  if (endless) {
    segment.motor_to_deg = segment.motor_from_deg + way_deg;
  } else {  // Whole turns are taken off at the start, so that the switch is at its own angle.
    segment.motor_to_deg = home_deg;
    segment.motor_from_deg = home_deg - way_deg;
    segment.platter_from_deg = segment.motor_from_deg + slack;
  }
  if (faults_ &&
      faults_->Strike(FaultKind::kStuckSwitch, FaultDevice::kTable, segment.commanded_deg, now)) {
    segment.stopped_by = FaultKind::kStuckSwitch;
    segment.outcome = TableMotion::kUnhomed;
    segment.fault = "the homing switch does not clear";
  }
  Append(segment);
}

Status MockTurntable::MoveTo(double angle_deg, DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (Status status = CheckLink(now); !status) return status;
  if (!open_) return DeviceError(config_.serial + ": not open");
  if (!(std::abs(angle_deg) <= kMaxCommandDeg))
    return DeviceError(config_.serial + ": move to " + NumberText(angle_deg) +
                       " degrees, allowed are " + NumberText(-kMaxCommandDeg) + " to " +
                       NumberText(kMaxCommandDeg));
  const Segment& last = segments_.back();
  if (now < last.end) return DeviceError(config_.serial + ": it is moving already");
  if (last.outcome != TableMotion::kIdle)
    return DeviceError(config_.serial + ": home it first: " + last.fault);
  BeginMove(angle_deg, config_.max_speed_deg_s, config_.acceleration_deg_s2, now);
  return {};
}

void MockTurntable::BeginMove(double angle_deg, double speed_deg_s, double acceleration_deg_s2,
                              DeviceTime now) {
  ++moves_;
  Segment segment = BeginSegment(now);
  segment.commanded_deg = angle_deg;
  const auto to_steps = static_cast<std::int64_t>(std::llround(angle_deg * config_.steps_per_deg));
  const double way_deg =
      static_cast<double>(std::abs(to_steps - segment.count_from)) / config_.steps_per_deg;
  SetLeg(segment, to_steps, TrapezoidalProfile(way_deg, speed_deg_s, acceleration_deg_s2));
  if (faults_) StrikeMove(segment, now);
  Finish(segment);
  Append(segment);
  if (!faults_ || segment.stopped_by) return;
  if (const auto hand = faults_->Strike(FaultKind::kDisplaced, FaultDevice::kTable, angle_deg, now))
    AppendDisplacement(hand->amount, segment.end + kUntilDisplaced);
}

void MockTurntable::StrikeMove(Segment& segment, DeviceTime now) {
  const auto strike = [&](FaultKind kind) {
    return faults_->Strike(kind, FaultDevice::kTable, segment.commanded_deg, now);
  };
  const std::int64_t all_steps = segment.count_steps;
  if (const auto late = strike(FaultKind::kLateArrival)) {
    segment.pause = TruncatedFromMs(late->amount);
    segment.end += segment.pause;
  }
  // A motor that does not turn loses no steps: these wait for a move that is one.
  if (all_steps > 0) {
    if (const auto lost = strike(FaultKind::kLostSteps))
      segment.motor_steps =
          std::max<std::int64_t>(0, all_steps - std::llround(lost->amount * config_.steps_per_deg));
    if (strike(FaultKind::kStall)) {
      segment.motor_steps = std::min(segment.motor_steps, all_steps / 2);
      if (config_.feedback == TableFeedback::kEncoder) {
        segment.end = segment.begin + segment.HalfTime();
        segment.outcome = TableMotion::kUnhomed;
        segment.stopped_by = FaultKind::kStall;
        segment.fault = "the motor stalled";
      }
    }
  }
  if (const auto wrong = strike(FaultKind::kWrongPosition))
    segment.report_error_deg = wrong->amount;
  const bool alarm = strike(FaultKind::kAlarm).has_value();
  const bool reset = strike(FaultKind::kReset).has_value();
  const bool limit = strike(FaultKind::kLimit).has_value();
  if (!alarm && !reset && !limit) return;
  segment.end = segment.begin + segment.HalfTime();
  segment.count_steps = all_steps / 2;
  segment.motor_steps = std::min(segment.motor_steps, all_steps / 2);
  segment.stopped_by = reset ? FaultKind::kReset : alarm ? FaultKind::kAlarm : FaultKind::kLimit;
  segment.outcome = reset ? TableMotion::kUnhomed : TableMotion::kFault;
  segment.fault = reset ? "the controller restarted: \"Mock 1.0 ready\"" : "ALARM: limit switch";
}

double MockTurntable::CountedDeg(const Segment& segment, DeviceTime now) const {
  if (now >= segment.end)
    return static_cast<double>(segment.CountTo()) / config_.steps_per_deg +
           segment.report_error_deg;
  const auto covered =
      static_cast<std::int64_t>(std::floor(segment.Covered(now) * config_.steps_per_deg));
  const std::int64_t counted = std::min(segment.count_steps, covered);
  return static_cast<double>(segment.count_from + (segment.direction < 0.0 ? -counted : counted)) /
         config_.steps_per_deg;
}

Result<TableState> MockTurntable::State(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  const Segment& segment = SegmentAt(now);
  TableState state;
  state.time = now;
  if (now < segment.end) {
    state.motion = TableMotion::kMoving;
    state.angle_deg = CountedDeg(segment, now);
    return state;
  }
  state.motion = segment.outcome;
  state.fault = segment.fault;
  state.angle_deg = CountedDeg(segment, now);
  return state;
}

Status MockTurntable::Halt(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (Status status = CheckLink(now); !status) return status;
  if (!open_) return DeviceError(config_.serial + ": not open");
  const Segment& segment = SegmentAt(now);
  if (now >= segment.end) {
    StopMotor(now, segment.outcome, std::string(segment.fault));
  } else if (segment.homing || config_.feedback == TableFeedback::kOpenLoop) {
    StopMotor(now, TableMotion::kUnhomed, "halted in motion");
  } else {
    StopMotor(now, TableMotion::kIdle, "");
  }
  return {};
}

double MockTurntable::TrueAngleDeg(DeviceTime time) const {
  const std::lock_guard lock(mutex_);
  const Segment& segment = SegmentAt(time);
  double angle_deg = segment.PlatterDeg(time, config_.backlash_deg);
  const double since_s = Seconds(time - std::min(segment.end, time));
  const double settle_s = config_.settle_ms * 1e-3;
  const bool moved = segment.motor_to_deg != segment.motor_from_deg;
  if (moved && since_s > 0.0 && since_s < settle_s) {
    const double fade = 1.0 - since_s / settle_s;
    angle_deg += config_.settle_amplitude_deg * fade * fade *
                 std::sin(2.0 * std::numbers::pi * config_.settle_frequency_hz * since_s);
  }
  return angle_deg;
}

std::uint64_t MockTurntable::moves() const {
  const std::lock_guard lock(mutex_);
  return moves_;
}

double MockTurntable::CommandedAngleDeg(DeviceTime time) const {
  const std::lock_guard lock(mutex_);
  return SegmentAt(time).commanded_deg;
}

void MockTurntable::Creep(double by_deg, DeviceTime begin, DeviceTime duration) {
  const std::lock_guard lock(mutex_);
  if (begin < segments_.back().end || segments_.back().outcome != TableMotion::kIdle) return;
  Segment segment = BeginSegment(begin);
  const auto by_steps = static_cast<std::int64_t>(std::llround(by_deg * config_.steps_per_deg));
  const double way_deg = static_cast<double>(std::abs(by_steps)) / config_.steps_per_deg;
  const double seconds = std::max(Seconds(duration), 1e-6);
  if (by_steps == 0) return;
  // Half of the time speeding up, half slowing down.
  SetLeg(segment, segment.count_from + by_steps,
         TrapezoidalProfile(way_deg, 2.0 * way_deg / seconds, 4.0 * way_deg / (seconds * seconds)));
  Finish(segment);
  Append(segment);
}

}  // namespace turnlight::rig::sim
