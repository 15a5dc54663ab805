#include "app/calibrate/raw_taking.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>
#include <utility>

#include "app/calibrate/prompt.h"
#include "app/motion_words.h"
#include "app/one_picture.h"
#include "app/progress.h"
#include "app/table_motion.h"
#include "base/file.h"
#include "base/format.h"
#include "base/lock_file.h"
#include "base/sha256.h"
#include "nodes/frame_proof.h"
#include "rig/capture/capture_setup.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr double kRawHomePatienceS = 120.0;
constexpr auto kReadingPatience = std::chrono::seconds(2);
constexpr auto kRestSlice = milliseconds(20);
constexpr char kCaptureLock[] = ".lock";

// One run of a raw capture.
struct RawRun {
  const DeviceConfig& config;
  const RawOrder& order;
  const fs::path& out;
  const RawTaking& how;
  Devices devices;
  DeviceClock clock;
  StatusLine line;
  TableMotion motion;
  std::optional<double> stands_deg;  // where the table was sent last
  std::vector<PlannedPicture> plan;
  std::vector<std::optional<rig::RawCaptureFrame>> frames;  // of the plan
  rig::RawCapture capture;                                  // its frames: those of other kinds
  std::optional<LockFile> lock;
};

rig::RawCapture NewCapture(const RawRun& run, const rig::DeviceIdentity& camera,
                           const rig::DeviceIdentity& table) {
  const rig::CameraDevice& device = *run.devices.camera;
  rig::RawCapture capture;
  capture.name = fs::absolute(run.out).lexically_normal().filename().string();
  if (capture.name.empty()) capture.name = "capture";
  capture.radiometry = NominalLevels(device);
  capture.bayer = device.bayer;
  capture.devices = {camera, table, device.format.size, device.roi_offset, device.binning, ""};
  capture.root = run.out;
  return capture;
}

std::string WhoIs(const rig::DeviceIdentity& device) {
  return device.vendor.empty() && device.model.empty() ? "not known" : rig::Describe(device);
}

// What is there already must be of the same devices, set up alike.
Status Join(const rig::RawCapture& before, rig::RawCapture& now) {
  const std::string file = (before.root / rig::kCaptureFile).string();
  const auto same = [&](const std::string& key, const std::string& was,
                        const std::string& is) -> Status {
    if (was == is) return {};
    return InputError(file + ": " + key + ": " + was + ", now it is " + is +
                      "; allowed is another --out");
  };
  const rig::CalibratedDevices &was = before.devices, &is = now.devices;
  const auto size = [](const cv::Size& s) { return Format("%d x %d", s.width, s.height); };
  const auto pair = [](const std::array<int, 2>& p) { return Format("%d, %d", p[0], p[1]); };
  Status status = same("identity/camera", WhoIs(was.camera), WhoIs(is.camera));
  if (status)
    status = same("identity/camera/resolution", size(was.resolution), size(is.resolution));
  if (status)
    status = same("identity/camera/roi_offset", pair(was.roi_offset), pair(is.roi_offset));
  if (status) status = same("identity/camera/binning", pair(was.binning), pair(is.binning));
  if (status)
    status = same("radiometry/white", NumberText(before.radiometry.white),
                  NumberText(now.radiometry.white));
  if (status)
    status = same("radiometry/bayer", before.bayer.value_or("none"), now.bayer.value_or("none"));
  // A table that was not opened is not known, before or now.
  if (status && WhoIs(was.table) != "not known" && WhoIs(is.table) != "not known")
    status = same("identity/table", WhoIs(was.table), WhoIs(is.table));
  if (!status) return status;
  if (WhoIs(is.table) == "not known") now.devices.table = was.table;
  now.devices.lens = was.lens;
  now.name = before.name;
  return {};
}

Status LookAtFolder(RawRun& run) {
  std::error_code code;
  if (fs::exists(run.out / rig::kSessionFile, code) || fs::is_regular_file(run.out, code))
    return InputError("--out: " + run.out.string() +
                      " is a session or a file, allowed is a new folder or a raw capture's");
  if (const Status status = MakeDirectory(run.out / "frames"); !status) return status;
  auto lock =
      LockFile::Take(run.out / kCaptureLock, run.out.string() + ": another program writes here");
  if (!lock) return Forward(lock);
  run.lock.emplace(std::move(*lock));
  run.frames.resize(run.plan.size());
  if (!rig::IsRawCapture(run.out)) return {};
  const auto before = rig::ReadRawCapture(run.out, rig::RawPictures::kMayBeMissing);
  if (!before) return Forward(before);
  if (const Status status = Join(*before, run.capture); !status) return status;
  auto kept = KeptFrames(*before, run.plan);
  if (!kept) return Forward(kept);
  run.frames = std::move(*kept);
  std::set<std::string> planned;
  for (const PlannedPicture& picture : run.plan) planned.insert(picture.image);
  for (const rig::RawCaptureFrame& frame : before->frames)
    if (!planned.contains(frame.image)) run.capture.frames.push_back(frame);
  return {};
}

Status WriteDown(const RawRun& run) {
  rig::RawCapture whole = run.capture;
  for (const auto& frame : run.frames)
    if (frame) whole.frames.push_back(*frame);
  return rig::WriteRawCapture(whole, run.out);
}

// The devices are open, and who they are is known, before anything is written or moves.
Status OpenDevices(RawRun& run) {
  rig::DeviceIdentity table_identity;
  if (run.order.move) {
    rig::Turntable& table = *run.devices.table->turntable;
    const auto table_opened = table.Open(run.clock.Now());
    if (!table_opened) return Forward(table_opened);
    table_identity = *table_opened;
    run.how.say(NameOfTable(run.config) + ": " + rig::Describe(*table_opened));
    run.motion = {&table, &run.clock, run.how.stop, run.config.plan.tolerance_deg};
    run.motion.note = [&run](const std::string& note) { run.how.say("note: " + note); };
  }
  rig::Camera& camera = *run.devices.camera->camera;
  const auto camera_opened = camera.Open(run.clock.Now());
  if (!camera_opened) return Forward(camera_opened);
  run.how.say(NameOfCamera(run.config) + ": " + rig::Describe(*camera_opened));
  for (const std::string& note : camera.TakeNotes()) run.how.say("note: " + note);
  run.capture = NewCapture(run, *camera_opened, table_identity);
  return {};
}

Status FindPosition(RawRun& run) {
  const auto state =
      WaitUntilStill(run.motion, run.clock.Now() + FromSeconds(run.config.plan.move_timeout_s));
  if (!state) return Forward(state);
  if (state->motion == rig::TableMotion::kIdle) return {};
  run.how.say("the position is not known: " + state->fault);
  run.how.say(HomeText(NameOfTable(run.config)));
  const auto homed = HomeTable(run.motion, FromSeconds(kRawHomePatienceS));
  return homed ? Status() : Forward(homed);
}

// What will happen, before it does.
void Announce(const RawRun& run, std::size_t missing) {
  std::string text = Format("%zu pictures of kind %s into %s", run.plan.size(),
                            run.order.kind.c_str(), run.out.string().c_str());
  if (missing < run.plan.size())
    text += Format(", %zu of them are there and good", run.plan.size() - missing);
  if (run.order.move && missing > 0)
    text += Format("; the table %s will turn from %.6g to %.6g degrees. Ctrl-C halts it",
                   NameOfTable(run.config).c_str(), *run.plan.front().angle_deg,
                   *run.plan.back().angle_deg);
  else
    text += "; nothing moves";
  run.how.say(text);
}

Status Rest(const RawRun& run, double ms) {
  const rig::DeviceTime end = run.clock.Now() + FromSeconds(ms * 1e-3);
  while (run.clock.Now() < end) {
    if (StopRequested(run.how.stop)) return InterruptedError();
    std::this_thread::sleep_for(std::min<rig::DeviceTime>(kRestSlice, end - run.clock.Now()));
  }
  return {};
}

Result<rig::TableState> TurnTo(RawRun& run, double angle_deg) {
  const rig::CapturePlan& plan = run.config.plan;
  run.motion.watch = [&](const rig::TableState& state) {
    run.line.Show(Format("turning, at %.2f of %.2f degrees", state.angle_deg, angle_deg));
  };
  const auto legs = rig::MoveLegs(plan, run.stands_deg, angle_deg);
  run.stands_deg.reset();
  Result<rig::TableState> state = rig::TableState{};
  for (const double leg : legs) {
    state = TurnTable(run.motion, leg, FromSeconds(plan.move_timeout_s));
    if (!state) return state;
  }
  if (const Status rested = Rest(run, plan.settle_ms); !rested) return Forward(rested);
  run.stands_deg = angle_deg;
  return state;
}

// A reading of the table that is younger than the exposure: it still stands there.
Result<rig::TableState> StillThere(RawRun& run, double angle_deg, rig::DeviceTime exposed) {
  const rig::DeviceTime deadline = run.clock.Now() + kReadingPatience;
  while (true) {
    const auto state = run.motion.table->State(run.clock.Now());
    if (!state) return state;
    if (const auto wrong = nodes::StandsAt(*state, angle_deg, run.motion.tolerance_deg))
      return DeviceError("after the exposure: " + *wrong);
    if (state->time >= exposed) return state;
    if (run.clock.Now() >= deadline)
      return DeviceError("the table did not say where it stands after the exposure");
    std::this_thread::sleep_for(kRestSlice);
  }
}

struct RawPicture {
  nodes::Frame frame;
  std::optional<double> measured_deg;
};

Result<RawPicture> TryRawPicture(RawRun& run, const PlannedPicture& planned) {
  if (planned.angle_deg && run.stands_deg != planned.angle_deg) {
    const auto state = TurnTo(run, *planned.angle_deg);
    if (!state) return Forward(state);
  }
  Shooting shooting{run.devices.camera->camera.get(), &run.clock, run.how.stop, planned.settings};
  shooting.patience = FromSeconds(run.config.plan.frame_timeout_s);
  shooting.attempts = 1 + static_cast<int>(run.config.plan.retries);
  shooting.note = [&run](const std::string& note) { run.how.say("note: " + note); };
  auto shot = TakePicture(shooting);
  if (!shot) return Forward(shot);
  RawPicture picture{std::move(shot->frame), {}};
  if (!planned.angle_deg) return picture;
  const auto state = StillThere(run, *planned.angle_deg, picture.frame.exposure_end);
  if (!state) return Forward(state);
  picture.measured_deg = state->angle_deg;
  return picture;
}

// With the plan's retries; each comes to the angle anew.
Result<RawPicture> TakeRawPicture(RawRun& run, const PlannedPicture& planned) {
  for (std::int64_t attempt = 0;; ++attempt) {
    auto picture = TryRawPicture(run, planned);
    if (picture || picture.error().kind != ErrorKind::kDevice || attempt >= run.config.plan.retries)
      return picture;
    run.how.say("note: " + picture.error().text + "; taken again");
    run.stands_deg.reset();
  }
}

Status Store(RawRun& run, std::size_t index, const RawPicture& picture) {
  const PlannedPicture& planned = run.plan[index];
  const auto bytes = rig::EncodeImage(planned.image, picture.frame.image);
  if (!bytes) return Forward(bytes);
  if (const Status status = WriteFileAtomic(run.out / planned.image, *bytes); !status)
    return status;
  rig::RawCaptureFrame frame;
  frame.image = planned.image;
  frame.kind = run.order.kind;
  frame.angle_deg = planned.angle_deg;
  frame.angle_measured_deg = picture.measured_deg;
  frame.exposure = {picture.frame.actual.exposure_us, picture.frame.actual.gain_db};
  frame.has_gain = true;
  frame.sha256 = Sha256Hex(*bytes);
  run.frames[index] = std::move(frame);
  return WriteDown(run);
}

double FullShare(const cv::Mat& image, double white) {
  const cv::Mat values = image.reshape(1);
  return cv::countNonZero(values >= white) / static_cast<double>(values.total());
}

Status TakeMissing(RawRun& run, RawTaken& done) {
  const std::size_t per_place =
      run.plan.size() / static_cast<std::size_t>(std::max(1, run.order.count));
  for (std::size_t i = 0; i < run.plan.size(); ++i) {
    if (run.frames[i]) {
      ++done.kept;
      continue;
    }
    if (StopRequested(run.how.stop)) return InterruptedError();
    if (run.order.ask && !run.order.move && i % per_place == 0) {
      const Status asked = WaitForEnter(Format("picture %zu of %zu: hold it still, then Enter ",
                                               i / per_place + 1, run.plan.size() / per_place),
                                        run.how.stop);
      if (!asked) return asked;
    }
    const auto picture = TakeRawPicture(run, run.plan[i]);
    if (!picture) return Forward(picture);
    if (done.taken == 0)
      done.full_share = FullShare(picture->frame.image, run.capture.radiometry.white);
    if (const Status stored = Store(run, i, *picture); !stored) return stored;
    ++done.taken;
    run.line.Show(Format("%zu of %zu pictures", i + 1, run.plan.size()));
  }
  return {};
}

}  // namespace

std::optional<rig::RawCapture> WholeCapture(const rig::CapturePlan& plan, const RawOrder& order,
                                            const fs::path& out) {
  auto capture = rig::ReadRawCapture(out);
  if (!capture) return std::nullopt;
  for (const char* extension : {".png", ".tif"}) {
    const auto kept = KeptFrames(*capture, PlanPictures(plan, order, extension));
    if (kept && std::count(kept->begin(), kept->end(), std::nullopt) == 0)
      return std::move(*capture);
  }
  return std::nullopt;
}

Result<RawTaken> TakeRawCapture(const DeviceConfig& config, const RawOrder& order,
                                const fs::path& out, const Drivers& drivers, const RawTaking& how) {
  auto devices = MakeDevices(config, {.table = order.move, .camera = true}, drivers);
  if (!devices) return Forward(devices);
  RawRun run{config, order, out, how, std::move(*devices), {}, {}, {}, {}, {}, {}, {}, {}};
  const bool floats = run.devices.camera->format.depth == CV_32F;
  run.plan = PlanPictures(config.plan, order, floats ? ".tif" : ".png");
  if (const Status status = OpenDevices(run); !status) return Forward(status);
  if (const Status status = LookAtFolder(run); !status) return Forward(status);
  const auto missing =
      static_cast<std::size_t>(std::count(run.frames.begin(), run.frames.end(), std::nullopt));
  Announce(run, missing);
  RawTaken done;
  Status status = missing > 0 && order.move ? FindPosition(run) : Status();
  if (status) status = TakeMissing(run, done);
  if (!status) return Forward(status);
  auto whole = rig::ReadRawCapture(out);
  if (!whole) return Forward(whole);
  done.capture = std::move(*whole);
  return done;
}

}  // namespace turnlight::app
