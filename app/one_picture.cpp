#include "app/one_picture.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "base/format.h"
#include "nodes/frame_proof.h"

namespace turnlight::app {
namespace {

constexpr auto kPollCameraEvery = std::chrono::milliseconds(1);

Result<Shot> TryPicture(const Shooting& shooting) {
  rig::Camera& camera = *shooting.camera;
  const auto now = [&shooting] { return shooting.clock->Now(); };
  if (const auto set = camera.Set(shooting.settings, now()); !set) return Forward(set);
  const auto drained = camera.Drain(now());
  if (!drained) return Forward(drained);
  const rig::DeviceTime triggered = now();
  const auto trigger = camera.Trigger(triggered);
  if (!trigger) return Forward(trigger);
  const rig::DeviceTime deadline =
      triggered + FromSeconds(shooting.settings.exposure_us * 1e-6) + shooting.patience;
  while (true) {
    auto polled = camera.Poll(now());
    if (!polled) return Forward(polled);
    if (*polled) {
      rig::RawFrame& raw = **polled;
      return Shot{
          {std::move(raw.image), raw.frame_id, raw.trigger, *trigger, triggered, raw.exposure_begin,
           raw.exposure_end, raw.actual, raw.complete, *drained, camera.Readings()},
          ToSeconds(now() - triggered)};
    }
    if (StopRequested(shooting.stop)) return InterruptedError();
    if (now() >= deadline)
      return DeviceError(Format(
          "no picture came in answer to trigger %llu within %.3g s, the exposure and the timeout "
          "(capture/frame_timeout_s, or --timeout where given)",
          static_cast<unsigned long long>(*trigger), ToSeconds(deadline - triggered)));
    std::this_thread::sleep_for(kPollCameraEvery);
  }
}

}  // namespace

Result<Shot> TakePicture(const Shooting& shooting) {
  for (int attempt = 1;; ++attempt) {
    auto shot = TryPicture(shooting);
    for (const std::string& note : shooting.camera->TakeNotes()) shooting.note(note);
    if (!shot && shot.error().kind == ErrorKind::kInterrupted) return shot;
    std::optional<std::string> wrong = shot ? std::nullopt : std::optional(shot.error().text);
    if (shot) wrong = nodes::Answers(shot->frame, shooting.settings, std::nullopt);
    if (!wrong) {
      shot->attempts = attempt;
      return shot;
    }
    if (attempt >= shooting.attempts) return DeviceError(*wrong);
    shooting.note(*wrong + "; triggered again");
  }
}

}  // namespace turnlight::app
