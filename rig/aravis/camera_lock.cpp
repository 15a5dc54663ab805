#include "rig/aravis/camera_lock.h"

#include <cctype>
#include <utility>

namespace turnlight::rig::aravis {

Status CameraLock::Take(const std::string& vendor, const std::string& serial) {
  std::string name = vendor + "_" + serial;
  for (char& letter : name)
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-') letter = '_';
  const std::lock_guard lock(mutex_);
  if (over_) return DeviceError("the camera is being closed");
  if (file_ && name_ == name) return {};
  auto taken = LockFile::TakeForAll("turnlight_camera_" + name + ".lock",
                                    "camera " + serial + ": in use by");
  if (!taken) return DeviceError(taken.error().text);
  file_ = std::move(*taken);
  name_ = name;
  return {};
}

void CameraLock::Release() {
  const std::lock_guard lock(mutex_);
  over_ = true;
  file_.reset();
}

}  // namespace turnlight::rig::aravis
