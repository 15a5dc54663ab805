// A GigE Vision or USB3 Vision camera, by Aravis.
//
// Each trigger gives one picture, bound to it by the camera's clock (frame_judge.h). No call waits
// longer than a second for the camera, the first Open than 15 s; a camera that does not answer is a
// DeviceError, and lets the program end. Docs: docs/drivers.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rig/aravis/aravis_config.h"
#include "rig/aravis/camera_report.h"
#include "rig/aravis/camera_worker.h"
#include "rig/caller_clock.h"
#include "rig/device.h"
#include "rig/driver.h"

namespace turnlight::rig::aravis {

// Not for several threads at once.
class AravisCamera : public Camera {
 public:
  explicit AravisCamera(AravisConfig config) : config_(std::move(config)) {}
  ~AravisCamera() override;

  Result<DeviceIdentity> Open(DeviceTime now) override;
  // Within the camera's bounds and steps.
  Result<CameraSettings> Set(const CameraSettings& settings, DeviceTime now) override;
  Result<int> Drain(DeviceTime now) override;
  Result<std::uint64_t> Trigger(DeviceTime now) override;
  // Frame ids are the camera's as one rising count, over wraps and new connections.
  Result<std::optional<RawFrame>> Poll(DeviceTime now) override;
  std::vector<std::string> TakeNotes() override;
  std::vector<DeviceReading> Readings() override;

  // As of the last picture, or the opening.
  CameraReport Report() const;

 private:
  template <typename F>
  auto Do(F job) -> std::invoke_result_t<F, CameraWorker&>;
  tl::unexpected<Error> Silent();

  tl::unexpected<Error> Fault(const std::string& text) const;

  const AravisConfig config_;
  std::shared_ptr<CameraWorker> worker_;  // from the first Open on
  std::optional<Job<Result<DeviceIdentity>>> opening_;
  bool opened_before_ = false;
  bool open_ = false;
  std::uint64_t triggers_ = 0;
  IdCounter ids_;
  CallerClock clock_;
};

// The keys of docs/drivers.md. Nothing is opened.
Result<CameraDevice> MakeAravisCamera(StrictObject keys);

}  // namespace turnlight::rig::aravis
