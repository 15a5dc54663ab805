#include "app/calibrate/raw_plan.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::app {
namespace {

// Devices round: as nodes/frame_proof.h allows.
constexpr double kExposureTolerance = 1e-3;
constexpr double kGainToleranceDb = 0.05;

bool IsOf(const PlannedPicture& planned, const rig::RawCaptureFrame& frame) {
  const double asked = planned.settings.exposure_us;
  return frame.angle_deg == planned.angle_deg && frame.exposure.exposure_us &&
         std::abs(*frame.exposure.exposure_us - asked) <= kExposureTolerance * asked &&
         std::abs(frame.exposure.gain_db - planned.settings.gain_db) <= kGainToleranceDb;
}

std::string Words(std::optional<double> angle_deg, std::optional<double> exposure_us,
                  double gain_db) {
  return (angle_deg ? Format("at %.6g degrees", *angle_deg) : std::string("at no angle")) +
         (exposure_us ? Format(", %.6g us", *exposure_us) : std::string()) +
         Format(", %.4g dB", gain_db);
}

}  // namespace

std::vector<PlannedPicture> PlanPictures(const rig::CapturePlan& plan, const RawOrder& order,
                                         const std::string& extension) {
  std::vector<std::optional<double>> places;
  if (order.move)
    for (const rig::PlannedFrame& frame : rig::PlannedFrames(plan))
      places.push_back(frame.angle_deg);
  else
    places.resize(static_cast<std::size_t>(order.count));
  const auto& exposures = order.exposures_us.empty() ? plan.exposures_us : order.exposures_us;
  const int repeats = order.pairs > 0 ? 2 * order.pairs : 1;
  std::vector<PlannedPicture> pictures;
  for (const auto& angle_deg : places)
    for (const double exposure_us : exposures)
      for (int repeat = 0; repeat < repeats; ++repeat)
        pictures.push_back(
            {Format("frames/%s_%03zu%s", order.kind.c_str(), pictures.size(), extension.c_str()),
             angle_deg,
             {exposure_us, plan.gain_db}});
  return pictures;
}

Result<std::vector<std::optional<rig::RawCaptureFrame>>> KeptFrames(
    const rig::RawCapture& capture, const std::vector<PlannedPicture>& plan) {
  std::vector<std::optional<rig::RawCaptureFrame>> kept(plan.size());
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const auto found = std::find_if(
        capture.frames.begin(), capture.frames.end(),
        [&](const rig::RawCaptureFrame& frame) { return frame.image == plan[i].image; });
    if (found == capture.frames.end()) continue;
    const auto& settings = plan[i].settings;
    if (!IsOf(plan[i], *found))
      return InputError(
          (capture.root / rig::kCaptureFile).string() + ": " + found->image + " was taken " +
          Words(found->angle_deg, found->exposure.exposure_us, found->exposure.gain_db) +
          ", now it is asked for " +
          Words(plan[i].angle_deg, settings.exposure_us, settings.gain_db) +
          "; allowed is the same again, or another --out or --kind");
    const auto index = static_cast<std::size_t>(found - capture.frames.begin());
    if (found->sha256 && rig::ReadRawImage(capture, index)) kept[i] = *found;
  }
  return kept;
}

}  // namespace turnlight::app
