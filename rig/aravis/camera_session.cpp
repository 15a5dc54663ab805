#include "rig/aravis/camera_session.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/format.h"
#include "rig/aravis/reap.h"

namespace turnlight::rig::aravis {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr int kMaxTriggers = 5;    // of a shot, because packets were lost
constexpr int kMaxUnanswered = 3;  // of these, acknowledged and without a picture
// From the end of exposure and readout to when a picture is given up.
constexpr milliseconds kAnswerTime(700);
// Aravis waits 500 ms for an acknowledgement before it sends a command again.
constexpr milliseconds kSentTwiceAfter(400);
// In which a camera that was not asked must send nothing.
constexpr milliseconds kQuiet(120);
constexpr int kQuietTrials = 3;
// By how much a stamp may seem to lie outside trigger and arrival: the time that reading a clock
// takes on a busy machine. Clocks that have nothing to do with each other are seconds apart.
constexpr milliseconds kStampSlack(20);

microseconds ExposureOf(const CameraSettings& settings) {
  return microseconds(static_cast<std::int64_t>(settings.exposure_us));
}

ClockSample HostClock() {
  const Steady::time_point now = Steady::now();
  return {g_get_real_time() * 1000, now, now};
}

}  // namespace

CameraSession::CameraSession(Connection connection)
    : connection_(std::move(connection)),
      features_(arv_camera_get_device(connection_.camera.get())) {}

CameraSession::~CameraSession() {
  if (stream_ && !lost()) features_.Execute("AcquisitionStop");
  stream_.reset();
}

Result<std::unique_ptr<CameraSession>> CameraSession::Open(const AravisConfig& config,
                                                           CameraLock& lock,
                                                           std::optional<KnownCamera>& known) {
  auto connection = Connect(config.id, lock, known);
  if (!connection) return Forward(connection);
  std::unique_ptr<CameraSession> session(new CameraSession(std::move(*connection)));
  const Status started = session->Start(config, *known);
  if (started) return session;
  const std::string serial = session->identity().serial;
  if (session->lost()) Reap(std::move(session));
  return DeviceError("camera " + serial + ": " + started.error().text);
}

Status CameraSession::Start(const AravisConfig& config, KnownCamera& known) {
  format_ = config.format;
  size_ = config.size;
  readout_ = microseconds(static_cast<std::int64_t>(config.readout_ms * 1e3));
  if (Status applied = ApplySettings(features_, config, record_); !applied) return applied;
  const auto control = FindExposureControl(features_, config, record_);
  if (!control) return Forward(control);
  control_ = *control;
  const auto set = Set(CameraSettings{});
  if (!set) return Forward(set);
  auto stream = FrameStream::Create(connection_, config, known);
  if (!stream) return Forward(stream);
  stream_ = std::move(*stream);
  clock_.Find(features_, arv_camera_get_device(connection_.camera.get()));
  temperature_ = features_.FirstOf({"DeviceTemperature", "TemperatureAbs"});
  NoteMissing();
  Failure failure;
  arv_camera_start_acquisition(connection_.camera.get(), failure.out());
  if (failure) return DeviceError("AcquisitionStart: " + failure.text());
  return TakeTrial();
}

void CameraSession::NoteMissing() {
  notes_ = record_.notes;
  if (!record_.missing.empty())
    notes_.push_back("this camera has no " + Listed(record_.missing) + ": left out");
}

// The socket's buffer is set with the first picture, so that one may break.
Status CameraSession::TakeTrial() {
  std::optional<ClockSample> first, second;
  if (clock_.found())
    if (const auto ticks = clock_.ReadTicks(features_)) first = *ticks;
  const auto frame = FinishTrial();
  if (!frame) return Forward(frame);
  if (Status quiet = CheckQuiet(); !quiet) return quiet;
  if (first)
    if (const auto ticks = clock_.ReadTicks(features_)) second = *ticks;
  const auto between = [&](const ClockSample& sample) {
    const Steady::time_point stamp = HostTime(sample, last_frame_->stamp_ns);
    return stamp >= last_trigger_.sent - kStampSlack && stamp <= last_frame_->arrived + kStampSlack;
  };
  if (second && clock_.Calibrate(*first, *second)) {
    second->device_ns = NanosecondsOfTicks(second->device_ns, clock_.ticks_per_second());
    if (between(*second)) source_ = ClockSource::kLatch;
  }
  if (source_ == ClockSource::kArrival && between(HostClock())) source_ = ClockSource::kHost;
  if (source_ == ClockSource::kArrival)
    notes_.push_back(std::string(clock_.found() ? "the camera's clock does not fit its pictures' "
                                                  "times"
                                                : "the camera's clock cannot be read") +
                     ": pictures are bound by trigger, exposure and arrival alone");
  trial_ = false;
  return {};
}

Result<ShotFrame> CameraSession::FinishTrial() {
  if (Status sent = Trigger(); !sent) return Forward(sent);
  while (true) {
    auto frame = Wait(milliseconds(100));
    if (!frame) return Forward(frame);
    if (*frame) return std::move(**frame);
  }
}

Status CameraSession::CheckQuiet() {
  int trials = 0;
  while (stream_->Pop(kQuiet)) {
    if (++trials == kQuietTrials)
      return DeviceError(
          "it sends pictures that nobody triggered, with TriggerMode On: they could not be bound "
          "to "
          "an angle");
    std::this_thread::sleep_for(kQuiet);
    stream_->Drain();
  }
  return {};
}

bool CameraSession::Answers() {
  return !lost() && (!connection_.network || features_.Register(0).has_value()) &&
         CheckControl().has_value();
}

Status CameraSession::CheckControl() {
  ArvDevice* device = arv_camera_get_device(connection_.camera.get());
  if (!ARV_IS_GV_DEVICE(device) || arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return {};
  features_.Lose();
  return DeviceError(
      "control was lost: the camera was silent for too long, or another client took it");
}

Result<CameraSettings> CameraSession::Set(const CameraSettings& settings) {
  if (Status control = CheckControl(); !control) return Forward(control);
  const auto set = SetExposure(features_, control_, settings);
  if (set) settings_ = *set;
  return set;
}

int CameraSession::Drain() {
  shot_.reset();
  const int drained = stream_->Drain();
  counters_.stale += static_cast<std::uint64_t>(drained);
  return drained;
}

Status CameraSession::Trigger() {
  if (Status control = CheckControl(); !control) return control;
  shot_ = Shot();
  Status sent = SendTrigger();
  if (!sent) shot_.reset();
  return sent;
}

Status CameraSession::SendTrigger() {
  SentTrigger& trigger = shot_->trigger;
  trigger.source = source_;
  // The first picture comes before anything is known of the clock, and is not kept.
  trigger.exposure = trial_ ? microseconds(0) : ExposureOf(settings_);
  if (source_ == ClockSource::kHost) trigger.clock = HostClock();
  if (source_ == ClockSource::kLatch) {
    const auto read = clock_.Read(features_);
    if (!read) return Forward(read);
    trigger.clock = *read;
  }
  ++shot_->triggers;
  ++counters_.triggers;
  trigger.sent = Steady::now();
  if (Status sent = features_.Execute(kTriggerCommand); !sent) return sent;
  const Steady::time_point now = Steady::now();
  shot_->quiet_at.reset();
  shot_->deadline = now + ExposureOf(settings_) + readout_ + kAnswerTime;
  if (now - trigger.sent > kSentTwiceAfter)
    shot_->quiet_at = now + 2 * (ExposureOf(settings_) + readout_) + kQuiet;
  return {};
}

Status CameraSession::TriggerAgain(const std::string& why) {
  if (shot_->triggers >= kMaxTriggers || shot_->unanswered >= kMaxUnanswered)
    return DeviceError(why + ", after " + std::to_string(shot_->triggers) + " triggers");
  ++counters_.again;
  return SendTrigger();
}

Result<std::optional<ShotFrame>> CameraSession::Wait(milliseconds patience) {
  std::optional<ShotFrame> none;
  if (!shot_) return none;
  const auto go_on = [&](const Status& status) -> Result<std::optional<ShotFrame>> {
    if (status) return std::move(none);
    shot_.reset();
    return Forward(status);
  };
  const Steady::time_point until = shot_->quiet_at.value_or(shot_->deadline);
  const auto left = std::chrono::duration_cast<microseconds>(until - Steady::now());
  const auto buffer = stream_->Pop(std::clamp(left, microseconds(0), microseconds(patience)));
  if (shot_->quiet_at) {
    if (buffer) ++counters_.stale;
    if (Steady::now() < *shot_->quiet_at) return none;
    return go_on(TriggerAgain("the camera acknowledges triggers late"));
  }
  if (buffer) {
    auto judged = Judge(buffer);
    if (!judged || *judged) shot_.reset();
    return judged;
  }
  if (Steady::now() < shot_->deadline) return none;
  ++shot_->unanswered;
  ++counters_.unanswered;
  return go_on(TriggerAgain("the camera acknowledges triggers and sends no picture"));
}

Result<std::optional<ShotFrame>> CameraSession::Judge(const FrameStream::Buffer& buffer) {
  std::optional<ShotFrame> none;
  const ArrivedFrame arrived{arv_buffer_get_status(buffer.get()) == ARV_BUFFER_STATUS_SUCCESS,
                             arv_buffer_get_frame_id(buffer.get()),
                             static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer.get())),
                             Steady::now()};
  const FrameAnswer answer = JudgeFrame(shot_->trigger, arrived, last_id_);
  if (!last_id_ || IdAdvances(arrived.id, *last_id_)) last_id_ = arrived.id;
  if (answer == FrameAnswer::kStale) {
    ++counters_.stale;
    return none;
  }
  if (answer == FrameAnswer::kBroken) {
    ++counters_.broken;
    const Status again = TriggerAgain(Format("packets of the picture were lost (status %d)",
                                             arv_buffer_get_status(buffer.get())));
    if (!again) return Forward(again);
    return none;
  }
  last_frame_ = arrived;
  last_trigger_ = shot_->trigger;
  auto accepted = Accept(buffer.get(), arrived);
  if (!accepted) return Forward(accepted);
  return std::optional<ShotFrame>(std::move(*accepted));
}

Result<ShotFrame> CameraSession::Accept(ArvBuffer* buffer, const ArrivedFrame& arrived) {
  const ArvBufferPayloadType payload = arv_buffer_get_payload_type(buffer);
  if (payload != ARV_BUFFER_PAYLOAD_TYPE_IMAGE &&
      payload != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
    return DeviceError(Format("what came is no picture (payload type %d)", payload));
  const cv::Size size(arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer));
  const ArvPixelFormat code = arv_buffer_get_image_pixel_format(buffer);
  if (size != size_ || code != format_.code)
    return DeviceError(
        Format("a picture of %d x %d in format 0x%08x came, asked was %d x %d in "
               "0x%08x (%s)",
               size.width, size.height, code, size_.width, size_.height, format_.code,
               format_.name.c_str()));
  std::size_t bytes = 0;
  const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_image_data(buffer, &bytes));
  int x_padding = 0, y_padding = 0;
  arv_buffer_get_image_padding(buffer, &x_padding, &y_padding);
  auto image = Unpack(std::span(data, bytes), size, x_padding, format_);
  if (!image) return Forward(image);
  const auto actual = ReadExposure(features_, control_);
  if (!actual) return Forward(actual);
  settings_ = *actual;
  return ShotFrame{std::move(*image), arrived.id, SpanOf(shot_->trigger, arrived), *actual};
}

CameraReport CameraSession::Report() {
  CameraReport report{identity(),         record_.applied,        record_.missing, settings_,
                      ClockWord(source_), stream_->packet_size(), counters_,       {}};
  if (!temperature_.empty())
    if (const auto degrees = features_.Number(temperature_))
      report.readings.push_back({temperature_, *degrees});
  for (DeviceReading& reading : stream_->Counters()) report.readings.push_back(std::move(reading));
  const std::pair<const char*, std::uint64_t> counters[] = {
      {"Triggers", counters_.triggers},
      {"TriggersAgain", counters_.again},
      {"PicturesBroken", counters_.broken},
      {"PicturesStale", counters_.stale},
      {"TriggersUnanswered", counters_.unanswered}};
  for (const auto& [name, count] : counters)
    report.readings.push_back({name, static_cast<double>(count)});
  return report;
}

}  // namespace turnlight::rig::aravis
