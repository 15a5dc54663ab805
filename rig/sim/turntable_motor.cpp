// The mock turntable's motor as a simulated controller drives it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "rig/sim/mock_turntable.h"
#include "rig/sim/turntable_segment.h"

namespace turnlight::rig::sim {
namespace {

// Over which the speed is taken.
constexpr DeviceTime kSpeedWindow = std::chrono::microseconds(10);
constexpr double kDisplacementS = 1e-3;

}  // namespace

void MockTurntable::Drive(double to_deg, double speed_deg_s, double acceleration_deg_s2,
                          DeviceTime now) {
  const std::lock_guard lock(mutex_);
  StopMotor(now, TableMotion::kIdle, "");
  BeginMove(to_deg, speed_deg_s, acceleration_deg_s2, now);
}

void MockTurntable::SearchHome(double speed_deg_s, double acceleration_deg_s2, DeviceTime now) {
  const std::lock_guard lock(mutex_);
  StopMotor(now, TableMotion::kIdle, "");
  BeginHoming(speed_deg_s, acceleration_deg_s2, now);
}

void MockTurntable::Cut(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  StopMotor(now, TableMotion::kIdle, "");
}

void MockTurntable::Brake(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  const Segment moving = SegmentAt(now);
  StopMotor(now, TableMotion::kIdle, "");
  if (now >= moving.end || moving.homing) return;
  const double covered_deg = moving.Covered(now);
  const double speed = (covered_deg - moving.Covered(now - kSpeedWindow)) / Seconds(kSpeedWindow);
  const Segment& cut = segments_.back();
  const std::int64_t left = moving.count_steps - cut.count_steps;
  const double wanted_deg = 0.5 * speed * speed / moving.profile.acceleration();
  const std::int64_t steps =
      std::min<std::int64_t>(left, std::llround(wanted_deg * config_.steps_per_deg));
  if (!(speed > 0.0) || steps <= 0) return;
  // The second half of a motion of twice the way, which has this speed in its middle.
  const double way_deg = static_cast<double>(steps) / config_.steps_per_deg;
  const double acceleration = 0.5 * speed * speed / way_deg;
  Segment braking = BeginSegment(now);
  SetLeg(braking, cut.CountTo() + (cut.direction < 0.0 ? -steps : steps),
         TrapezoidalProfile(2.0 * way_deg, 2.0 * speed, acceleration));
  if (moving.motor_steps < moving.count_steps)
    braking.motor_steps =
        std::clamp<std::int64_t>(moving.motor_steps - cut.motor_steps, 0, braking.count_steps);
  braking.lead_s = 0.5 * braking.profile.Duration();
  braking.lead_deg = way_deg;
  braking.end = now + RoundUp(braking.lead_s);
  Finish(braking);
  Append(braking);
}

void MockTurntable::SetCount(double counted_deg, DeviceTime now) {
  const std::lock_guard lock(mutex_);
  StopMotor(now, TableMotion::kIdle, "");
  Segment segment = BeginSegment(now);
  const auto home =
      static_cast<double>(std::llround(config_.home_switch_deg * config_.steps_per_deg));
  segment.count_from = static_cast<std::int64_t>(std::llround(counted_deg * config_.steps_per_deg));
  segment.motor_from = static_cast<std::int64_t>(
      std::llround(home + (segment.motor_to_deg * config_.steps_per_deg - home) / config_.scale));
  segment.motor_from_deg = segment.motor_to_deg = TrueOfSteps(segment.motor_from);
  Append(segment);
}

// As Creep, but only an encoder counts it.
void MockTurntable::AppendDisplacement(double by_deg, DeviceTime begin) {
  const auto by_steps = static_cast<std::int64_t>(std::llround(by_deg * config_.steps_per_deg));
  if (by_steps == 0) return;
  Segment segment = BeginSegment(begin);
  const double way_deg = static_cast<double>(std::abs(by_steps)) / config_.steps_per_deg;
  SetLeg(segment, segment.count_from + by_steps,
         TrapezoidalProfile(way_deg, 2.0 * way_deg / kDisplacementS,
                            4.0 * way_deg / (kDisplacementS * kDisplacementS)));
  if (config_.feedback == TableFeedback::kOpenLoop) segment.count_steps = 0;
  segment.stopped_by = FaultKind::kDisplaced;
  Finish(segment);
  Append(segment);
}

MockTurntable::MotorState MockTurntable::Motor(DeviceTime now) const {
  const std::lock_guard lock(mutex_);
  const Segment& segment = SegmentAt(now);
  MotorState state;
  state.counted_deg = CountedDeg(segment, now);
  state.moving = now < segment.end;
  if (!state.moving) {
    state.stopped_by = segment.stopped_by;
    return state;
  }
  const double way_deg = segment.Covered(now) - segment.Covered(now - kSpeedWindow);
  state.speed_deg_s = std::max(0.0, way_deg / Seconds(kSpeedWindow));
  return state;
}

}  // namespace turnlight::rig::sim
