// The thread that talks to a camera, one job at a time, for a caller who waits a bounded time.
//
// While a shot is under way it works on that between the jobs. The thread is detached and owns what
// it needs: a program ends, and whoever made the worker goes on, while it still hangs in a call to
// a camera that no longer answers.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/result.h"
#include "rig/aravis/aravis_config.h"
#include "rig/aravis/camera_lock.h"
#include "rig/aravis/camera_session.h"

namespace turnlight::rig::aravis {

// A job that was handed over; may be waited for more than once.
template <typename T>
struct Job {
  std::future<T> result;
  std::shared_ptr<std::atomic<bool>> cancelled;

  bool WaitUntil(Steady::time_point time) {
    return result.wait_until(time) == std::future_status::ready;
  }
};

class CameraWorker {
 public:
  // Begins a thread of its own.
  static std::shared_ptr<CameraWorker> Begin(AravisConfig config);

  // job runs on the thread, with the worker's session; nothing of the caller's may be in it by
  // reference. A cancelled job that has not begun never does.
  template <typename F>
  auto Hand(F job) -> Job<std::invoke_result_t<F, CameraWorker&>> {
    using T = std::invoke_result_t<F, CameraWorker&>;
    auto task = std::make_shared<std::packaged_task<T(CameraWorker&)>>(std::move(job));
    Job<T> handed{task->get_future(), std::make_shared<std::atomic<bool>>(false)};
    Queue({[task](CameraWorker& worker) { (*task)(worker); }, handed.cancelled});
    return handed;
  }

  // Asks the thread to let go of the camera and end; true if it has within patience.
  bool End(std::chrono::milliseconds patience);
  // How long it has been in what it does now; 0 if it waits for work.
  Steady::duration Busy();

  // What the shot has come to, once.
  std::optional<Result<ShotFrame>> TakeShot();
  std::vector<std::string> TakeNotes();
  CameraReport Report();

  // For jobs, on the thread. -------------------------------------------------------------------

  // Opens the camera, anew if it was open.
  Result<DeviceIdentity> Reopen();
  // Null: not open.
  CameraSession* session() { return session_.get(); }
  void ForgetShot();

 private:
  struct Queued {
    std::function<void(CameraWorker&)> run;
    std::shared_ptr<std::atomic<bool>> cancelled;
  };

  explicit CameraWorker(AravisConfig config) : config_(std::move(config)) {}
  void Queue(Queued job);
  void Run();
  std::optional<Queued> Next();  // nothing: go on with the shot, or end
  void WorkOnShot();
  void Publish();

  const AravisConfig config_;
  CameraLock lock_;

  // Of the thread alone.
  std::optional<KnownCamera> known_;
  std::unique_ptr<CameraSession> session_;

  std::mutex mutex_;  // of all below
  std::condition_variable wake_, ended_;
  std::deque<Queued> queue_;
  bool end_ = false, has_ended_ = false, shooting_ = false;
  std::optional<Steady::time_point> busy_since_;
  std::optional<Result<ShotFrame>> shot_;
  std::vector<std::string> notes_;
  CameraReport report_;
};

}  // namespace turnlight::rig::aravis
