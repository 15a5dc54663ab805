// The renders of a simulated scene at rest, kept by view: a picture taken again, or one whose
// angle was known ahead, costs the sensor only.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>

#include "rig/sim/studio.h"

namespace turnlight::rig::sim {

// Safe to call from several threads: who asks for what another is rendering waits for it.
class RenderCache {
 public:
  // What was asked for longest ago goes first, once all is larger than max_bytes; the newest stays.
  RenderCache(std::shared_ptr<const Studio> studio, std::size_t max_bytes);

  // Linear radiance, noise-free. Not to be written to.
  cv::Mat3f Radiance(const View& view);
  std::size_t bytes() const;

 private:
  struct Entry {
    View view;
    cv::Mat3f radiance;  // empty while it is being rendered
  };

  void Trim();

  const std::shared_ptr<const Studio> studio_;
  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable rendered_;
  std::list<Entry> entries_;  // the newest last
};

}  // namespace turnlight::rig::sim
