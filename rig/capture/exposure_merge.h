// Exposures: several raw pictures of the same angle become one linear picture of larger range; and
// what a picture's numbers say about whether it may be kept.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "base/result.h"
#include "calib/radiometry.h"

namespace turnlight::rig {

// The sensor's noise in DN: variance = read_noise_dn^2 + dn_per_electron * (DN - black) + 1/12,
// the last for the rounding to whole DN.
struct SensorNoise {
  double read_noise_dn = 4.0;    // at least 0
  double dn_per_electron = 1.0;  // at least 0
  // DN up to which a sample says only "dark": it was cut off below. Default: 0 if the radiometry's
  // black is above 0, else none, as then 0 is a measurement of black.
  std::optional<double> black_limit_dn;
};

struct ExposedImage {
  cv::Mat image;             // CV_8U, CV_16U or CV_32F DN, grey or R, G, B
  calib::Exposure exposure;  // as read back; exposure_us must be there
};

struct MergedFrame {
  // As it goes into the session. One exposure: the raw DN, untouched. More: CV_32F radiance of the
  // reference exposure, in MergedRadiometry's DN (black 0, white 1; may be above 1 and below 0).
  cv::Mat image;
  // 255 where every channel has at least one sample that is neither clipped nor cut off below.
  // Empty for one exposure: then nothing was judged.
  cv::Mat1b validity;
  calib::Exposure exposure;  // to be stored with the frame: one: its own; more: the reference
};

// radiometry: of the raw DN; linear, and its reference_exposure_us must be set for a bracket (the
// plan's first exposure; reference_gain_db defaults to 0). Samples are weighted by the inverse of
// their variance at the merged value (not at the sample, which would favour samples that noise made
// dark); clipped ones do not count, nor their 8 neighbours as long as another exposure does. A
// channel clipped in all exposures gets the radiance at which the shortest clips, which is
// MergedRadiometry's saturation, so that readers see it as saturated; one cut off below in all gets
// the value of the longest. Channels are merged apart; the white balance is not applied.
// Fails (kInput): no image, sizes or types that differ, an encoding that is not linear, a missing
// or not positive exposure.
Result<MergedFrame> MergeExposures(const std::vector<ExposedImage>& bracket,
                                   const calib::Radiometry& radiometry, const SensorNoise& noise);

// The radiometry of a session's frames. One exposure: as given, with the references set to the
// exposure and gain. More: linear, black 0, white 1, saturation where the shortest exposure clips.
// exposures_us: the plan's, the first is the reference; gain_db: the plan's.
calib::Radiometry SessionRadiometry(const calib::Radiometry& raw,
                                    const std::vector<double>& exposures_us, double gain_db);

}  // namespace turnlight::rig
