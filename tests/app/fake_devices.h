// A table and a camera that do what a test tells them, at once, and remember what they were asked.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/drivers.h"
#include "rig/device.h"

namespace turnlight::app {

struct FakeTable : rig::Turntable {
  bool homed = false, never_arrives = false, halts = true;
  double error_deg = 0.0;  // between what is commanded and where it stands
  std::string open_fault, home_fault, move_fault;
  std::vector<std::string> notes;

  double angle_deg = 0.0;
  int looks_until_still = 0, halted = 0, homings = 0;
  std::vector<double> moves;

  Result<rig::DeviceIdentity> Open(rig::DeviceTime) override {
    if (!open_fault.empty()) return DeviceError(open_fault);
    return rig::DeviceIdentity{"turnlight", "fake table", "T1"};
  }
  Status Home(rig::DeviceTime) override {
    ++homings;
    homed = home_fault.empty();
    angle_deg = 0.0;
    looks_until_still = never_arrives ? 1 << 30 : 2;
    return {};
  }
  Status MoveTo(double to_deg, rig::DeviceTime) override {
    if (!move_fault.empty()) return DeviceError(move_fault);
    moves.push_back(to_deg);
    angle_deg = to_deg + error_deg;
    looks_until_still = never_arrives ? 1 << 30 : 2;
    return {};
  }
  Result<rig::TableState> State(rig::DeviceTime now) override {
    if (looks_until_still > 0 && looks_until_still--)
      return rig::TableState{now, rig::TableMotion::kMoving, angle_deg, ""};
    if (!homed)
      return rig::TableState{now, rig::TableMotion::kUnhomed, 0.0,
                             home_fault.empty() ? "just switched on" : home_fault};
    return rig::TableState{now, rig::TableMotion::kIdle, angle_deg, ""};
  }
  Status Halt(rig::DeviceTime) override {
    ++halted;
    if (!halts) return DeviceError("deaf");
    looks_until_still = 1;
    return {};
  }
  std::vector<std::string> TakeNotes() override { return std::exchange(notes, {}); }
};

struct FakeCamera : rig::Camera {
  cv::Mat image = cv::Mat(48, 64, CV_8U, cv::Scalar(100));
  int lost = 0, broken = 0;  // of the next pictures
  double exposure_factor = 1.0, packets_missing_each = 0.0;
  std::string open_fault;
  std::vector<std::string> notes;

  int triggers = 0;
  rig::CameraSettings settings;
  rig::DeviceTime triggered{};

  Result<rig::DeviceIdentity> Open(rig::DeviceTime) override {
    if (!open_fault.empty()) return DeviceError(open_fault);
    return rig::DeviceIdentity{"turnlight", "fake camera", "C1"};
  }
  Result<rig::CameraSettings> Set(const rig::CameraSettings& asked, rig::DeviceTime) override {
    settings = asked;
    settings.exposure_us *= exposure_factor;
    return settings;
  }
  Result<int> Drain(rig::DeviceTime) override { return 0; }
  Result<std::uint64_t> Trigger(rig::DeviceTime now) override {
    triggered = now;
    return static_cast<std::uint64_t>(++triggers);
  }
  Result<std::optional<rig::RawFrame>> Poll(rig::DeviceTime) override {
    if (lost > 0) {
      --lost;
      return DeviceError("it did not answer");
    }
    rig::RawFrame frame;
    frame.image = image;
    frame.frame_id = frame.trigger = static_cast<std::uint64_t>(triggers);
    frame.exposure_begin = triggered;
    frame.exposure_end = triggered + rig::DeviceTime(1000);
    frame.actual = settings;
    frame.complete = broken == 0;
    broken -= broken > 0 ? 1 : 0;
    return frame;
  }
  std::vector<std::string> TakeNotes() override { return std::exchange(notes, {}); }
  std::vector<rig::DeviceReading> Readings() override {
    return {{"DeviceTemperature", 41.5}, {"PacketsMissing", packets_missing_each * triggers}};
  }
};

// A table of drivers in which `fake` is these two.
struct FakeDevices {
  std::shared_ptr<FakeTable> table = std::make_shared<FakeTable>();
  std::shared_ptr<FakeCamera> camera = std::make_shared<FakeCamera>();

  Drivers WithThem() const {
    Drivers drivers = BuiltInDrivers();
    drivers.tables.push_back({"fake", RealDriver<rig::TableDevice>([*this](StrictObject keys) {
                                keys.OptionalString("port");
                                keys.OptionalString("usb_serial");
                                const Status status = keys.Finish();
                                return status ? Result<rig::TableDevice>(
                                                    rig::TableDevice{table, {}, true})
                                              : Forward(status);
                              })});
    drivers.cameras.push_back(
        {"fake", RealDriver<rig::CameraDevice>([*this](StrictObject keys) {
           const Status status = keys.Finish();
           rig::CameraDevice device;
           device.camera = camera;
           device.format = {camera->image.size(), camera->image.channels(), camera->image.depth()};
           return status ? Result<rig::CameraDevice>(std::move(device)) : Forward(status);
         })});
    return drivers;
  }
};

}  // namespace turnlight::app
