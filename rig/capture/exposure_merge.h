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

// radiometry: of the raw DN; linear, with its reference_exposure_us for a bracket. Each channel of
// each pixel by itself: samples are weighted by the inverse of their variance at the merged value
// (not at the sample, which would favour those that noise made dark); what is clipped does not
// count, nor a clipped pixel's 8 neighbours as long as another exposure tells of them. A channel
// that is clipped in all exposures gets twice the radiance at which the shortest clips, so that
// readers see it as saturated; one that is cut off below in all, the value of the longest. The
// white balance is not applied.
// Fails (kInput): no image, sizes or types that differ, an encoding that is not linear, an exposure
// or a reference that is missing or not above 0.
Result<MergedFrame> MergeExposures(const std::vector<ExposedImage>& bracket,
                                   const calib::Radiometry& radiometry, const SensorNoise& noise);

// The radiometry of raw frames, with references where it has none: the plan's first exposure and
// its gain. MergeExposures takes this one.
calib::Radiometry RawRadiometry(const calib::Radiometry& raw,
                                const std::vector<double>& exposures_us, double gain_db);
// The radiometry of a session's frames. One exposure: RawRadiometry. A bracket: linear, black 0,
// white 1, saturation where the shortest exposure clips, and no noise model.
calib::Radiometry SessionRadiometry(const calib::Radiometry& raw,
                                    const std::vector<double>& exposures_us, double gain_db);

}  // namespace turnlight::rig
