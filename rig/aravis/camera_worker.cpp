#include "rig/aravis/camera_worker.h"

#include <thread>

#include "rig/aravis/reap.h"

namespace turnlight::rig::aravis {
namespace {

// Between two looks at the queue while a picture is awaited.
constexpr std::chrono::milliseconds kShotSlice(10);

}  // namespace

std::shared_ptr<CameraWorker> CameraWorker::Begin(AravisConfig config) {
  std::shared_ptr<CameraWorker> worker(new CameraWorker(std::move(config)));
  std::thread([worker] { worker->Run(); }).detach();
  return worker;
}

void CameraWorker::Queue(Queued job) {
  const std::lock_guard lock(mutex_);
  queue_.push_back(std::move(job));
  wake_.notify_one();
}

std::optional<CameraWorker::Queued> CameraWorker::Next() {
  std::unique_lock lock(mutex_);
  busy_since_.reset();
  wake_.wait(lock, [&] { return end_ || shooting_ || !queue_.empty(); });
  busy_since_ = Steady::now();
  if (end_ || queue_.empty()) return std::nullopt;
  Queued job = std::move(queue_.front());
  queue_.pop_front();
  return job;
}

void CameraWorker::Run() {
  while (true) {
    auto job = Next();
    {
      const std::lock_guard lock(mutex_);
      if (end_) break;
    }
    if (job && !*job->cancelled) job->run(*this);
    if (!job) WorkOnShot();
    const std::lock_guard lock(mutex_);
    shooting_ = session_ && session_->waiting();
  }
  session_.reset();
  lock_.Release();
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  ended_.notify_all();
}

void CameraWorker::WorkOnShot() {
  if (!session_) return;
  auto frame = session_->Wait(kShotSlice);
  if (frame && !*frame) return;
  Publish();
  const std::lock_guard lock(mutex_);
  if (frame) {
    shot_ = Result<ShotFrame>(std::move(**frame));
  } else {
    shot_ = Result<ShotFrame>(Forward(frame));
  }
}

// Notes, settings and counters, for whoever asks.
void CameraWorker::Publish() {
  auto notes = session_->TakeNotes();
  CameraReport report = session_->Report();
  const std::lock_guard lock(mutex_);
  notes_.insert(notes_.end(), notes.begin(), notes.end());
  report_ = std::move(report);
}

Result<DeviceIdentity> CameraWorker::Reopen() {
  ForgetShot();
  if (session_ && !session_->Answers()) Reap(std::move(session_));
  session_.reset();
  auto session = CameraSession::Open(config_, lock_, known_);
  if (!session) return Forward(session);
  session_ = std::move(*session);
  Publish();
  return session_->identity();
}

void CameraWorker::ForgetShot() {
  const std::lock_guard lock(mutex_);
  shot_.reset();
}

bool CameraWorker::End(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  end_ = true;
  wake_.notify_one();
  if (ended_.wait_for(lock, patience, [&] { return has_ended_; })) return true;
  lock.unlock();
  lock_.Release();
  return false;
}

Steady::duration CameraWorker::Busy() {
  const std::lock_guard lock(mutex_);
  return busy_since_ ? Steady::now() - *busy_since_ : Steady::duration(0);
}

std::optional<Result<ShotFrame>> CameraWorker::TakeShot() {
  const std::lock_guard lock(mutex_);
  return std::exchange(shot_, std::nullopt);
}

std::vector<std::string> CameraWorker::TakeNotes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notes_, {});
}

CameraReport CameraWorker::Report() {
  const std::lock_guard lock(mutex_);
  return report_;
}

}  // namespace turnlight::rig::aravis
