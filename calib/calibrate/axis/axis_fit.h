// The joint fit with what does not belong to it left out: points that lie off, views that do not
// show the board where their angle puts it. Internal to this folder.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/axis/angle_noise.h"
#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/calibrate/axis/turning_model.h"

namespace turnlight::calib::calibrate::axis {

struct FitView {
  bool used = false;
  std::string why_not;
  std::size_t numbering = 0;
  ModelView all;           // with all of its points, in the numbering of the reference view
  std::vector<bool> fits;  // of those points
  ModelView kept;          // with those that fit
  double deviation = 0.0;  // radians, with the prior
  // Without the prior, and its sigma from the corners' noise.
  double free_deviation = 0.0, free_sigma = 0.0;
};

struct AxisFit {
  TurningState state;  // its deviations are those of the used views, in order
  std::vector<FitView> views;
  double angle_ref_deg = 0.0;
  bool fits_backlash = false;
  int columns = kParameters;  // that were fitted, from the first on
  NoiseEstimate noise;
  std::vector<ViewSums> sums;  // of the used views, in order
};

// As CalibrateAxis, but for what the covariance says.
Result<AxisFit> FitAxis(const board::Board& board, const CameraModel& camera,
                        const std::vector<AxisView>& views);

}  // namespace turnlight::calib::calibrate::axis
