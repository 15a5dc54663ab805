#include "rig/serial/serial_turntable.h"

#include <sys/eventfd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "rig/serial/serial_worker.h"

namespace turnlight::rig::serial {

SerialTurntable::SerialTurntable(SerialTurntableOptions options,
                                 std::unique_ptr<StageProtocol> protocol)
    : options_(std::move(options)), protocol_(std::move(protocol)) {}

SerialTurntable::~SerialTurntable() = default;

// The thread begins with the first call, so that a plan that is only looked at opens nothing.
Result<DeviceIdentity> SerialTurntable::Open(DeviceTime) {
  if (!worker_) worker_ = std::make_unique<Worker>(options_, std::move(protocol_));
  return worker_->Open();
}

Status SerialTurntable::Home(DeviceTime) { return worker_ ? worker_->Home() : NotOpen(); }
Status SerialTurntable::MoveTo(double angle_deg, DeviceTime) {
  return worker_ ? worker_->MoveTo(angle_deg) : NotOpen();
}
Status SerialTurntable::Halt(DeviceTime) { return worker_ ? worker_->Halt() : NotOpen(); }
Result<TableState> SerialTurntable::State(DeviceTime now) {
  if (!worker_) return Forward(NotOpen());
  return worker_->State(now);
}
std::vector<std::string> SerialTurntable::TakeNotes() {
  return worker_ ? worker_->TakeNotes() : std::vector<std::string>();
}
std::optional<StageTraits> SerialTurntable::traits() const {
  return worker_ ? worker_->traits() : std::nullopt;
}
std::string SerialTurntable::port_in_use() const { return worker_ ? worker_->port_in_use() : ""; }
Status SerialTurntable::NotOpen() const { return DeviceError(options_.driver + ": not open"); }

SerialKeys ReadSerialKeys(StrictObject& keys, const std::string& driver, int default_baud) {
  SerialKeys read;
  SerialTurntableOptions& options = read.options;
  options.driver = driver;
  options.port.path = keys.OptionalString("port").value_or("");
  options.port.usb_serial = keys.OptionalString("usb_serial").value_or("");
  if (options.port.path.empty() == options.port.usb_serial.empty())
    keys.RefuseText("port",
                    "allowed is exactly one of port, a path such as "
                    "/dev/serial/by-id/usb-..., and usb_serial, the serial number of the USB "
                    "adapter; turnlight devices lists both");
  options.line.baud =
      static_cast<int>(keys.OptionalInteger("baud", 50, 4'000'000).value_or(default_baud));
  options.reversed = keys.OptionalBoolean("reversed").value_or(false);
  options.overshoot_deg =
      keys.OptionalNumber("overshoot_deg", {.min = 0.0, .max = 90.0}).value_or(3.0);
  if (const auto limits = keys.OptionalNumbers("limits_deg", 2, {.min = -1e6, .max = 1e6})) {
    if (!((*limits)[0] < (*limits)[1])) keys.Refuse("limits_deg", "[MIN, MAX] with MIN below MAX");
    options.limits = Travel{(*limits)[0], (*limits)[1]};
  }
  read.kinematics.speed_deg_per_s =
      keys.OptionalNumber("speed_deg_s", {.max = 1e4, .above = 0.0}).value_or(20.0);
  read.kinematics.acceleration_deg_per_s2 =
      keys.OptionalNumber("acceleration_deg_s2", {.max = 1e6, .above = 0.0}).value_or(100.0);
  return read;
}

// The worker's calls, on the callers' threads.
// -----------------------------------------------------

Result<DeviceIdentity> SerialTurntable::Worker::Open() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, options_.open_deadline, [this] { return state_ != Link::kConnecting; });
  if (state_ == Link::kReady) return identified_->identity;
  if (state_ == Link::kConnecting)
    return DeviceError(options_.driver + ": the controller was not ready within " +
                       NumberText(std::chrono::duration<double>(options_.open_deadline).count()) +
                       " s");
  return DeviceError(options_.driver + ": " + error_);
}

void SerialTurntable::Worker::Ask(Wish wish) {
  wishes_.push_back(std::move(wish));
  ++wished_;
  eventfd_write(wake_, 1);
}

Status SerialTurntable::Worker::Home() {
  const std::lock_guard lock(mutex_);
  if (state_ != Link::kReady) return DeviceError(options_.driver + ": " + error_);
  Ask({Kind::kHome, {}, 0});
  return {};
}

std::optional<Travel> SerialTurntable::Worker::TravelOf() const {
  const StageTraits& traits = identified_->traits;
  if (!traits.min_deg || !traits.max_deg) return std::nullopt;
  return options_.reversed ? Travel{-*traits.max_deg, -*traits.min_deg}
                           : Travel{*traits.min_deg, *traits.max_deg};
}

Status SerialTurntable::Worker::MoveTo(double angle_deg) {
  const std::lock_guard lock(mutex_);
  if (state_ != Link::kReady) return DeviceError(options_.driver + ": " + error_);
  if (!std::isfinite(angle_deg))
    return DeviceError(options_.driver + ": move to an angle that is no number");
  if (options_.limits &&
      (angle_deg < options_.limits->min_deg || angle_deg > options_.limits->max_deg))
    return DeviceError(Format("%s: move to %.6g deg, allowed by limits_deg are %.6g to %.6g",
                              options_.driver.c_str(), angle_deg, options_.limits->min_deg,
                              options_.limits->max_deg));
  if (!must_home_.empty()) return DeviceError(options_.driver + ": " + must_home_);
  const auto travel = TravelOf();
  const auto plan =
      PlanWoundMove(angle_deg, last_angle_deg_, turns_, travel, options_.overshoot_deg);
  if (!plan)
    return DeviceError(
        Format("%s: move to %.6g deg, and the stage's travel of %.6g to %.6g deg has no "
               "such place, with whole turns added or taken off",
               options_.driver.c_str(), angle_deg, travel->min_deg, travel->max_deg));
  last_angle_deg_ = angle_deg;
  Wish wish{Kind::kMove, plan->legs_deg, plan->turns};
  if (options_.reversed)
    for (double& leg : wish.legs_deg) leg = -leg;
  Ask(std::move(wish));
  return {};
}

Status SerialTurntable::Worker::Halt() {
  const std::lock_guard lock(mutex_);
  if (state_ != Link::kReady) return DeviceError(options_.driver + ": " + error_);
  halting_ = true;
  Ask({Kind::kHalt, {}, 0});
  return {};
}

Result<TableState> SerialTurntable::Worker::State(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  clock_.Hear(now);
  if (state_ != Link::kReady) return DeviceError(options_.driver + ": " + error_);
  TableState state;
  state.time = now;
  state.motion = TableMotion::kMoving;
  state.angle_deg = (options_.reversed ? -1.0 : 1.0) * report_->position_deg + 360.0 * turns_;
  // Not told yet, or not answered since: whatever was true before says nothing.
  if (report_of_ != wished_ || report_->motion == TableMotion::kMoving) return state;
  state.motion = report_->motion;
  state.fault = report_->fault;
  state.time = clock_.ToCaller(report_time_);
  if (!must_home_.empty() && state.motion == TableMotion::kIdle) {
    state.motion = TableMotion::kUnhomed;
    state.fault = must_home_;
  }
  return state;
}

std::vector<std::string> SerialTurntable::Worker::TakeNotes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notes_, {});
}

std::optional<StageTraits> SerialTurntable::Worker::traits() const {
  const std::lock_guard lock(mutex_);
  return identified_ ? std::optional(identified_->traits) : std::nullopt;
}

std::string SerialTurntable::Worker::port_in_use() const {
  const std::lock_guard lock(mutex_);
  return port_in_use_;
}

}  // namespace turnlight::rig::serial
