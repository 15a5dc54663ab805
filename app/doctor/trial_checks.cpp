#include "app/doctor/trial_checks.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "app/motion_words.h"
#include "app/one_picture.h"
#include "app/progress.h"
#include "app/table_motion.h"
#include "base/format.h"
#include "base/statistics.h"
#include "rig/capture/closure_check.h"
#include "rig/capture/frame_check.h"

namespace turnlight::app {
namespace {

constexpr int kTrialFrames = 100;
constexpr int kMostLost = 3;                  // then it is of no use to go on
constexpr double kTrialExposureUs = 20000.0;  // at most: a hundred of a second each would take long
constexpr double kTurnHomeS = 120.0;
constexpr double kQuarterTurnDeg = 90.0;

Shooting ShootingOf(const Patient& patient, double exposure_us) {
  Shooting shooting{patient.devices.camera->camera.get(), &patient.clock, patient.stop};
  shooting.settings = {exposure_us, patient.config.plan.gain_db};
  shooting.patience = FromSeconds(patient.config.plan.frame_timeout_s);
  shooting.attempts = 1 + static_cast<int>(patient.config.plan.retries);
  return shooting;
}

std::optional<double> ReadingOf(rig::Camera& camera, const std::string& name) {
  for (const rig::DeviceReading& reading : camera.Readings())
    if (reading.name == name) return reading.value;
  return std::nullopt;
}

// What a counter of the camera's grew by.
class Counter {
 public:
  Counter(rig::Camera& camera, std::string name)
      : camera_(&camera), name_(std::move(name)), before_(ReadingOf(camera, name_)) {}
  std::optional<double> Growth() const {
    const auto now = ReadingOf(*camera_, name_);
    return now ? std::optional(*now - before_.value_or(0.0)) : std::nullopt;
  }

 private:
  rig::Camera* camera_;
  std::string name_;
  std::optional<double> before_;
};

FrameTrial TakeTrial(const Patient& patient) {
  rig::Camera& camera = *patient.devices.camera->camera;
  const Counter missing(camera, "PacketsMissing"), resent(camera, "PacketsResent"),
      again(camera, "TriggersAgain");
  const Shooting shooting =
      ShootingOf(patient, std::min(patient.config.plan.exposures_us.front(), kTrialExposureUs));
  FrameTrial trial;
  Progress progress("taking pictures", kTrialFrames);
  while (trial.asked < kTrialFrames && trial.asked - trial.good < kMostLost) {
    const auto shot = TakePicture(shooting);
    ++trial.asked;
    progress.Step();
    if (shot) {
      ++trial.good;
      trial.again += shot->attempts - 1;
      trial.seconds.push_back(shot->seconds);
    } else {
      if (trial.error.empty()) trial.error = shot.error().text;
      if (shot.error().kind == ErrorKind::kInterrupted) break;
    }
  }
  trial.again += static_cast<int>(again.Growth().value_or(0.0));
  trial.packets_missing = missing.Growth();
  trial.packets_resent = resent.Growth();
  return trial;
}

// The angles of once around, from the plan's start in its direction.
std::vector<double> QuartersOf(const rig::CapturePlan& plan) {
  const double sign = plan.direction == rig::TurnDirection::kCcw ? 1.0 : -1.0;
  std::vector<double> angles;
  for (int i = 0; i <= 4; ++i) angles.push_back(plan.start_deg + sign * kQuarterTurnDeg * i);
  return angles;
}

std::optional<double> OutsideLimits(const rig::CapturePlan& plan) {
  for (const double angle : QuartersOf(plan))
    if (plan.limits && (angle < plan.limits->min_deg || angle > plan.limits->max_deg)) return angle;
  return std::nullopt;
}

// Of one way to go to an angle, arriving as a capture does.
Status Approach(const Patient& patient, const TableMotion& motion, double& at_deg,
                double angle_deg) {
  for (const double leg : rig::MoveLegs(patient.config.plan, at_deg, angle_deg)) {
    if (leg == at_deg) continue;
    const auto state = TurnTable(motion, leg, FromSeconds(patient.config.plan.move_timeout_s));
    if (!state) return Forward(state);
    at_deg = leg;
  }
  return {};
}

// A picture once the table has come to rest.
Result<cv::Mat> PictureAtRest(const Patient& patient) {
  const rig::DeviceTime rested =
      patient.clock.Now() + FromSeconds(1e-3 * patient.config.plan.settle_ms);
  while (patient.clock.Now() < rested) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  auto shot = TakePicture(ShootingOf(patient, patient.config.plan.exposures_us.front()));
  if (!shot) return Forward(shot);
  return shot->frame.image;
}

Result<double> KnownAngle(const Patient& patient, const TableMotion& motion) {
  auto state =
      WaitUntilStill(motion, patient.clock.Now() + FromSeconds(patient.config.plan.move_timeout_s));
  if (state && state->motion != rig::TableMotion::kIdle) {
    patient.say(HomeText(NameOfTable(patient.config)));
    state = HomeTable(motion, FromSeconds(kTurnHomeS));
  }
  if (!state) return Forward(state);
  return state->angle_deg;
}

Result<rig::ClosureCheck> TurnOnce(const Patient& patient, const calib::Radiometry& levels) {
  TableMotion motion{patient.devices.table->turntable.get(), &patient.clock, patient.stop,
                     patient.config.plan.tolerance_deg};
  motion.note = patient.say;
  auto at = KnownAngle(patient, motion);
  if (!at) return Forward(at);
  const auto angles = QuartersOf(patient.config.plan);
  patient.say(
      Format("the table %s will turn from %.3f to %.3f degrees and on to %.3f degrees in "
             "quarter turns, at %.4g deg/s",
             NameOfTable(patient.config).c_str(), *at, angles.front(), angles.back(),
             patient.devices.table->kinematics.speed_deg_per_s));
  std::vector<cv::Mat> ends;
  Progress progress("quarter turns", angles.size());
  for (const double angle : angles) {
    if (const Status there = Approach(patient, motion, *at, angle); !there) return Forward(there);
    progress.Step();
    if (angle != angles.front() && angle != angles.back()) continue;
    auto picture = PictureAtRest(patient);
    if (!picture) return Forward(picture);
    ends.push_back(*picture);
  }
  if (ends[0].size() != ends[1].size() || ends[0].type() != ends[1].type())
    return DeviceError("the camera gave pictures of two kinds");
  return rig::CompareClosure(angles.front(), ends[0], angles.back(), ends[1], levels);
}

calib::Radiometry LevelsOfPatient(const Patient& patient) {
  const auto calibration = ReadCalibrationOf(patient.config);
  return LevelsOf(patient.devices, calibration ? *calibration : std::nullopt);
}

}  // namespace

Check JudgePackets(const FrameTrial& trial) {
  std::string figure = Format("%d of %d pictures good, %d triggered again (%.3g %%)", trial.good,
                              trial.asked, trial.again, 100.0 * trial.again / trial.asked);
  if (trial.packets_missing) figure += Format(", %.0f packets missing", *trial.packets_missing);
  if (trial.packets_resent) figure += Format(", %.0f sent again", *trial.packets_resent);
  const bool lost_on_the_way =
      trial.packets_missing.value_or(0.0) + trial.packets_resent.value_or(0.0) > 0.0;
  const std::string advice =
      lost_on_the_way ? "look at the socket buffer and the packet size above; check cable, switch, "
                        "and what else uses this network or USB controller"
                      : "compare capture/frame_timeout_s with the exposure; check the trigger, the "
                        "cable, and what else uses this network or USB controller";
  if (trial.good < trial.asked) return Failed(figure + "; " + trial.error, advice);
  const bool lossy = trial.again > 0 || trial.packets_missing.value_or(0.0) > 0.0;
  return lossy ? Warning(figure, advice) : Fine(figure);
}

Check CheckPackets(Patient& patient) {
  if (!patient.camera) return Skipped(patient.devices.camera ? kCameraShut : kNoCamera);
  patient.say(Format("taking %d pictures, nothing moves", kTrialFrames));
  patient.trial = TakeTrial(patient);
  return JudgePackets(*patient.trial);
}

Check CheckLatency(Patient& patient) {
  if (!patient.trial || patient.trial->seconds.empty()) return Skipped("no picture came");
  std::vector<double> seconds = patient.trial->seconds;
  const double most = *std::max_element(seconds.begin(), seconds.end());
  const double allowed = patient.config.plan.frame_timeout_s;
  const std::string figure = Format("median %.0f ms, longest %.0f ms, exposure included",
                                    1e3 * Median(seconds), 1e3 * most);
  if (most < 0.5 * allowed) return Fine(figure);
  return Warning(figure + Format("; a capture waits %.3g s", allowed),
                 Format("capture: {frame_timeout_s: %.2g}", 3.0 * most));
}

Check CheckLevels(Patient& patient) {
  if (!patient.trial || patient.trial->good == 0) return Skipped("no picture came");
  const auto shot = TakePicture(ShootingOf(patient, patient.config.plan.exposures_us.front()));
  if (!shot) return Failed(shot.error().text, "look at the pictures above");
  const auto check = rig::CheckFrame(shot->frame.image, LevelsOfPatient(patient), {}, {});
  const std::string figure =
      Format("mean level %.3g %% of white, %.3g %% of the pixels clipped",
             100.0 * check.statistics.mean_level, 100.0 * check.statistics.saturated_share);
  const std::string advice = rig::ExposureAdvice(check.statistics);
  if (check.verdict != rig::FrameVerdict::kGood) return Failed(check.text, advice);
  return advice.empty() ? Fine(figure) : Warning(figure, advice);
}

Check CheckTurn(Patient& patient) {
  if (!patient.table || !patient.camera) return Skipped("it needs the table and the camera, open");
  if (!patient.options.move) return Skipped("--no-move");
  if (const auto angle = OutsideLimits(patient.config.plan))
    return Skipped(Format("%.6g degrees is outside capture/limits_deg", *angle));
  const auto closure = TurnOnce(patient, LevelsOfPatient(patient));
  if (!closure) return Failed(closure.error().text, "check the table, then give the command again");
  if (closure->closed) return Fine(closure->text);
  if (closure->difference.blocks == 0)
    return Failed(closure->text,
                  "mend the light first: nothing was compared, so that this says "
                  "nothing of the table");
  return Failed(closure->text,
                "check the steps per degree (of GRBL $100), the coupling and that the target lies "
                "firm; a slower rig/table/speed_deg_s loses fewer steps");
}

}  // namespace turnlight::app
