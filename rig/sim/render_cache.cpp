#include "rig/sim/render_cache.h"

#include <algorithm>
#include <utility>

namespace turnlight::rig::sim {
namespace {

std::size_t BytesOf(const cv::Mat& picture) { return picture.total() * picture.elemSize(); }

}  // namespace

RenderCache::RenderCache(std::shared_ptr<const Studio> studio, std::size_t max_bytes)
    : studio_(std::move(studio)), max_bytes_(max_bytes) {}

cv::Mat3f RenderCache::Radiance(const View& view) {
  std::unique_lock lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.view == view; });
  if (found != entries_.end()) {
    rendered_.wait(lock, [&] { return !found->radiance.empty(); });
    const cv::Mat3f radiance = found->radiance;
    entries_.splice(entries_.end(), entries_, found);
    return radiance;
  }
  const auto entry = entries_.insert(entries_.end(), Entry{view, {}});
  lock.unlock();
  const cv::Mat3f radiance = RenderView(*studio_, view).radiance;
  lock.lock();
  entry->radiance = radiance;
  Trim();
  rendered_.notify_all();
  return radiance;
}

// Entries that are being rendered stay, and so does the newest.
void RenderCache::Trim() {
  std::size_t bytes = 0;
  for (auto entry = entries_.end(); entry != entries_.begin();) {
    --entry;
    bytes += BytesOf(entry->radiance);
    const bool newest = std::next(entry) == entries_.end();
    if (bytes > max_bytes_ && !newest && !entry->radiance.empty()) entry = entries_.erase(entry);
  }
}

std::size_t RenderCache::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = 0;
  for (const Entry& entry : entries_) bytes += BytesOf(entry.radiance);
  return bytes;
}

}  // namespace turnlight::rig::sim
