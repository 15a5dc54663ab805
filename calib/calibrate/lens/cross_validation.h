// Two halves of the pictures against each other.
#pragma once

#include <vector>

#include "base/result.h"
#include "calib/calibrate/lens/assess_lens.h"

namespace turnlight::calib::calibrate::lens {

// Which of the pixels lie within the outline of the used points of a view.
std::vector<bool> CoveredPixels(const LensCalibration& calibration,
                                const std::vector<Eigen::Vector2d>& pixels);

// Of the views that the calibration used. Fails with the reason: too few pictures, a half that
// cannot be calibrated, halves that cover no common area.
Result<CrossValidation> CompareHalves(const board::Board& board,
                                      const std::vector<PictureViews>& pictures,
                                      const LensCalibration& calibration,
                                      const LensOptions& options, const ImageGrid& grid);

}  // namespace turnlight::calib::calibrate::lens
