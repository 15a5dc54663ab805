// A turntable that is not there: it moves in closed form, so that the truth of any instant can be
// asked, and it reports what a controller would report, which is not the truth.
//
// The chain: commanded angle -> whole steps -> the controller's count -> the motor's shaft (a
// trapezoid of speed; may lose steps) -> the platter (lags by the backlash after a reversal, swings
// a little on arrival). What stands still stands exactly: once settle_ms are over the true angle is
// a function of the steps alone, so that pictures taken at different times are the same bits.
//
// Before the first homing the position is unknown (kUnhomed). Homing turns in the positive
// direction until the platter meets the switch, which also takes up the backlash.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/device.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_config.h"

namespace turnlight::rig::sim {

// Rest to rest over a distance at limited speed and acceleration.
class TrapezoidalProfile {
 public:
  // distance >= 0; speed and acceleration above 0; any units.
  TrapezoidalProfile(double distance, double speed, double acceleration);
  double Duration() const { return 2.0 * ramp_s_ + cruise_s_; }
  // Way covered t seconds after the start: 0 before it, exactly the distance from the end on.
  double At(double t) const;
  double acceleration() const { return acceleration_; }

 private:
  double distance_;
  double acceleration_;
  double ramp_s_;    // each of speeding up and slowing down
  double cruise_s_;  // 0 if the speed limit is never reached
};

// Safe to call from several threads: the mock camera asks for the truth while another node moves
// the table. Times may not go back by more than the last few moves.
class MockTurntable : public Turntable {
 public:
  // The config must be valid. No script: no faults.
  explicit MockTurntable(MockTurntableConfig config, std::shared_ptr<FaultScript> faults = nullptr);
  ~MockTurntable() override;

  Result<DeviceIdentity> Open(DeviceTime now) override;
  Status Home(DeviceTime now) override;
  Status MoveTo(double angle_deg, DeviceTime now) override;
  Result<TableState> State(DeviceTime now) override;
  // In a move the count stays known with an encoder; open loop must home again.
  Status Halt(DeviceTime now) override;

  // What only a simulation knows. ----------------------------------------------------------------

  // The platter's angle. Continuous but for whole turns when homing begins, and for the remains of
  // a swing that the next move cuts short.
  double TrueAngleDeg(DeviceTime time) const;
  // How many moves to an angle it has begun.
  std::uint64_t moves() const;
  // The angle of the last MoveTo before or at that time; 0 if there was none.
  double CommandedAngleDeg(DeviceTime time) const;
  // The table moves by itself for so long, and the controller counts it. No effect unless it stands
  // homed and idle when that begins.
  void Creep(double by_deg, DeviceTime begin, DeviceTime duration);
  const MockTurntableConfig& config() const { return config_; }

  // What a simulated controller does with the motor (rig/sim/stage, turntable_motor.cpp). There is
  // no link that could be unplugged, and whether the position is known is the controller's to
  // judge. Faults of the table strike as they do in MoveTo and Home.

  // Goes to a counted angle, |deg| <= 36000, by a profile of its own; a motion under way is cut.
  void Drive(double to_deg, double speed_deg_s, double acceleration_deg_s2, DeviceTime now);
  // As Home, at a speed of its own.
  void SearchHome(double speed_deg_s, double acceleration_deg_s2, DeviceTime now);
  // Comes to rest as fast as the move's acceleration allows, at the latest where it would have; a
  // homing is cut.
  void Brake(DeviceTime now);
  // The motor stands at once, on a whole step. A controller that does so in motion should not
  // trust its count.
  void Cut(DeviceTime now);
  // Where the motor stands is counted as this angle from now on.
  void SetCount(double counted_deg, DeviceTime now);

  struct MotorState {
    double counted_deg = 0.0;  // whole steps; with an encoder the shaft's
    double speed_deg_s = 0.0;  // of the count, >= 0
    bool moving = false;
    // Why the last motion ended before its target: kStall (seen by an encoder only), kAlarm,
    // kLimit, kReset, kStuckSwitch; or kDisplaced: it was moved by hand since.
    std::optional<FaultKind> stopped_by;
  };
  MotorState Motor(DeviceTime now) const;

 private:
  struct Segment;

  Status CheckLink(DeviceTime now);
  const Segment& SegmentAt(DeviceTime time) const;
  Segment BeginSegment(DeviceTime begin) const;
  void SetLeg(Segment& segment, std::int64_t to_steps, const TrapezoidalProfile& profile) const;
  void BeginMove(double angle_deg, double speed_deg_s, double acceleration_deg_s2, DeviceTime now);
  void BeginHoming(double speed_deg_s, double acceleration_deg_s2, DeviceTime now);
  void StrikeMove(Segment& segment, DeviceTime now);
  void AppendDisplacement(double by_deg, DeviceTime begin);
  void Finish(Segment& segment) const;
  void Append(Segment segment);
  void StopMotor(DeviceTime now, TableMotion outcome, const std::string& fault);
  double TrueOfSteps(std::int64_t steps) const;
  double CountedDeg(const Segment& segment, DeviceTime now) const;

  const MockTurntableConfig config_;
  const std::shared_ptr<FaultScript> faults_;
  mutable std::mutex mutex_;
  std::vector<Segment> segments_;  // never empty, in order of time, none overlaps the next
  bool open_ = false;
  std::uint64_t moves_ = 0;
  DeviceTime unplugged_until_{};
};

}  // namespace turnlight::rig::sim
