// One program of this machine at a time on a camera: a lock file named by its serial number.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "base/lock_file.h"
#include "base/result.h"

namespace turnlight::rig::aravis {

// Kept from the first opening to the end, over lost connections. For several threads.
class CameraLock {
 public:
  // Again for the same camera: nothing. Fails (kDevice) if another holds it, named in the message.
  Status Take(const std::string& vendor, const std::string& serial);
  // For good: a late Take fails.
  void Release();

 private:
  std::mutex mutex_;
  std::optional<LockFile> file_;
  std::string name_;
  bool over_ = false;
};

}  // namespace turnlight::rig::aravis
