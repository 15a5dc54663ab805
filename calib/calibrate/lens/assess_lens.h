// What a calibration is good for, in numbers and words.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/lens/calibrate_lens.h"
#include "calib/calibrate/lens/projection_difference.h"

namespace turnlight::calib::calibrate::lens {

// How many used points lie in each cell of the sensor, row by row; cells are about square.
struct Coverage {
  int columns = 12, rows = 0;
  std::vector<std::size_t> points;
};

// A ninth of the picture.
struct Region {
  std::string name;            // "top left corner", "left edge", "middle"
  double covered_share = 0.0;  // of its area, by the outlines of the boards' used points
  double sigma_px = 0.0;       // median over its pixels, at infinity; NaN where there is none
};

// The pictures in two halves, every other one, each calibrated by itself.
struct CrossValidation {
  std::vector<Eigen::Vector2d> difference;  // at the pixels of the assessment's grid
  std::vector<bool> compared;               // covered in both halves
  double rms_px = 0.0, largest_px = 0.0;    // of the difference's length, where compared
  double expected_px = 0.0;                 // the rms that noise of the corners alone would give
};

struct LensAssessment {
  ImageGrid grid;
  std::vector<bool> covered;       // by a board's used points
  std::vector<double> sigma_px;    // in the worst direction, at infinity
  std::optional<double> distance;  // length unit of the board
  std::vector<double> sigma_at_distance_px;
  Coverage coverage;
  double covered_share = 0.0;     // of the picture
  double covered_sigma_px = 0.0;  // 95 % of the covered area are better, at infinity
  std::vector<Region> regions;    // nine, row by row
  Result<CrossValidation> halves = InputError("");  // or why there is none
  std::vector<std::size_t> doubtful;                // of the calibration's views
  std::string verdict;                              // one or more sentences
  std::vector<std::string> advice;                  // pictures to leave out, where to add some
};

// Two more calibrations for the halves. distance: the uncertainty there as well, above 0.
LensAssessment AssessLens(const board::Board& board, const std::vector<PictureViews>& pictures,
                          const LensCalibration& calibration, const LensOptions& options,
                          std::optional<double> distance);

}  // namespace turnlight::calib::calibrate::lens
