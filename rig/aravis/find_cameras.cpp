#include "rig/aravis/find_cameras.h"

#include <arv.h>

#include <future>
#include <mutex>
#include <thread>
#include <utility>

namespace turnlight::rig::aravis {
namespace {

std::string Text(const char* text) { return text ? text : ""; }

// Aravis has one list in the process, read by position.
std::vector<FoundCamera> UpdateAndCopy() {
  static std::mutex* const kMutex = new std::mutex;  // a search may outlive main
  const std::lock_guard lock(*kMutex);
  arv_update_device_list();
  std::vector<FoundCamera> cameras;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i)
    cameras.push_back({Text(arv_get_device_id(i)), Text(arv_get_device_vendor(i)),
                       Text(arv_get_device_model(i)), Text(arv_get_device_serial_nbr(i)),
                       Text(arv_get_device_address(i)), Text(arv_get_device_protocol(i))});
  return cameras;
}

}  // namespace

Result<std::vector<FoundCamera>> FindCameras(std::chrono::milliseconds patience) {
  std::packaged_task<std::vector<FoundCamera>()> task(UpdateAndCopy);
  std::future<std::vector<FoundCamera>> found = task.get_future();
  std::thread(std::move(task)).detach();
  if (found.wait_for(patience) == std::future_status::ready) return found.get();
  return DeviceError("the search for cameras did not end within " +
                     std::to_string(patience.count()) + " ms");
}

std::optional<FoundCamera> CameraOf(const std::vector<FoundCamera>& cameras,
                                    const std::string& id) {
  for (std::string FoundCamera::*key :
       {&FoundCamera::id, &FoundCamera::serial, &FoundCamera::address})
    for (const FoundCamera& camera : cameras)
      if (camera.*key == id) return camera;
  return std::nullopt;
}

std::string DescribeCameras(const std::vector<FoundCamera>& cameras) {
  if (cameras.empty()) return "no camera was seen on any network or USB port";
  std::string text = "seen were ";
  for (std::size_t i = 0; i < cameras.size(); ++i)
    text += (i > 0 ? ", " : "") + cameras[i].id + " (serial " + cameras[i].serial + ", at " +
            cameras[i].address + ")";
  return text;
}

}  // namespace turnlight::rig::aravis
