#include "tests/app/folder_camera.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <vector>

#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using rig::DeviceTime;

class FolderCamera : public rig::Camera {
 public:
  explicit FolderCamera(fs::path folder) : folder_(std::move(folder)) {}

  Result<rig::DeviceIdentity> Open(DeviceTime) override {
    std::error_code code;
    files_.clear();
    for (const auto& entry : fs::directory_iterator(folder_, code)) files_.push_back(entry.path());
    std::sort(files_.begin(), files_.end());
    if (files_.empty()) return DeviceError(folder_.string() + ": no pictures here");
    return rig::DeviceIdentity{"turnlight", "folder camera", folder_.filename().string()};
  }
  Result<rig::CameraSettings> Set(const rig::CameraSettings& settings, DeviceTime) override {
    return settings_ = settings;
  }
  Result<int> Drain(DeviceTime) override { return 0; }
  Result<std::uint64_t> Trigger(DeviceTime now) override {
    begin_ = now;
    waiting_ = true;
    return ++triggers_;
  }
  Result<std::optional<rig::RawFrame>> Poll(DeviceTime now) override {
    const auto exposure = std::chrono::duration<double, std::micro>(settings_.exposure_us);
    const DeviceTime end = begin_ + std::chrono::duration_cast<DeviceTime>(exposure);
    if (!waiting_ || now < end) return std::nullopt;
    waiting_ = false;
    const auto image = rig::ReadImage(files_[(triggers_ - 1) % files_.size()]);
    if (!image) return DeviceError(image.error().text);
    return rig::RawFrame{*image, triggers_, triggers_, begin_, end, settings_, true};
  }

 private:
  const fs::path folder_;
  std::vector<fs::path> files_;
  rig::CameraSettings settings_;
  DeviceTime begin_{};
  std::uint64_t triggers_ = 0;
  bool waiting_ = false;
};

}  // namespace

Result<rig::CameraDevice> MakeFolderCamera(StrictObject keys) {
  const std::string path = keys.String("path");
  const auto size = keys.Numbers("size", 2, {.min = 1.0, .max = 65536.0});
  if (Status status = keys.Finish(); !status) return Forward(status);
  rig::CameraDevice device;
  device.camera = std::make_shared<FolderCamera>(path);
  device.format = {{static_cast<int>(size[0]), static_cast<int>(size[1])}, 3, CV_16U};
  return device;
}

}  // namespace turnlight::app
