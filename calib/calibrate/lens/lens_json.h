// intrinsics.json: what is known of a calibrated lens, as text.
//
//   {"format": "turnlight-intrinsics", "version": 1,
//    "camera_model": {"path": "camera.cameramodel", "sha256": "..."},
//    "lens_model": "LENSMODEL_OPENCV8", "resolution": [1600, 1200],
//    "board": {"kind": "chessboard", "columns": 9, "rows": 6, "spacing": 25.0, "unit": "mm"},
//    "intrinsics": {"value": [...], "covariance": [[...]]},
//    "projection_covariance": [[...]],
//    "board_warp": {"fitted": true, "along_rows": 0.01, "along_columns": -0.02, "unit": "mm"},
//    "rms_px": 0.2, "noise_px": 0.2, "points": 1000, "outliers": 3, "parameters": 134,
//    "images": {"used": [{"image": "a.png", "board": 0, "rms_px": 0.2, "points": 54, "outliers": 0,
//                         "doubtful": false, "X_CB": [[3 rows of 4]]}],
//               "dropped": [{"image": "b.png", "board": null, "reason": "no board found"}]},
//    "coverage": {"share": 0.8, "columns": 12, "rows": 9, "points": [[...]]},
//    "uncertainty": {"columns": 60, "rows": 45, "worst_sigma_px": [[...]],
//                    "regions": [{"name": "middle", "covered_share": 1.0, "sigma_px": 0.02}],
//                    "covered_sigma_px": 0.05,
//                    "at_distance": {"distance": 500, "unit": "mm", "worst_sigma_px": [[...]]}},
//    "cross_validation": {"rms_px": 0.03, "largest_px": 0.1, "expected_px": 0.04},
//    "verdict": "...", "advice": ["..."], "notes": ["..."]}
//
// rms_px is per axis, weighted, without outliers; noise_px, their standard deviation, is the noise
// of corners that all covariances assume. projection_covariance has six more rows than that of the
// intrinsics: the mean motion of the boards in C, rotation vector and shift
// (projection_uncertainty.h); the uncertainty of a projection at any pixel and distance follows
// from it. Both are null for more than 300 intrinsics. The grid of "uncertainty" is evenly over the
// picture with its outermost pixels on the edges; null is where the lens does not reach; without
// "at_distance" it is at infinity. cross_validation is {"reason": "..."} where there is none.
#pragma once

#include <string>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/assess_lens.h"
#include "calib/calibrate/lens/calibrate_lens.h"

namespace turnlight::calib::calibrate::lens {

// model_text is what the file camera.cameramodel holds.
std::string IntrinsicsJson(const board::Board& board, const std::vector<PictureViews>& pictures,
                           const LensCalibration& calibration, const LensAssessment& assessment,
                           const std::string& model_text, const std::string& length_unit);

}  // namespace turnlight::calib::calibrate::lens
