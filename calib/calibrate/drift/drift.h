// Is a rig's calibration still true? A few pictures taken now, of a board on the turning table or
// of the target itself, against the stored calibration: what drifted, by how much, in how many
// sigmas.
//
// The pictures are fitted with nothing changed, with each cause of drift alone, with two of them,
// and with all. What the stored calibration may have wrong by its own covariance, the angles' noise
// and the outlines' edge offset are random effects in every fit, so that they are no drift; a
// board's place is free. How much better a fit with a cause is, as chi-squared, says how sure the
// drift is; the simplest that leaves nothing to explain is the finding.
//
// What a board that may lie anywhere cannot tell: a camera that moved along the axis, or went round
// it. What outlines cannot tell: whether the camera sank or the target rose, whether the target was
// turned or the table lost its zero.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/drift/rig_change.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/target_shape.h"
#include "rig/rig_calibration.h"

namespace turnlight::calib::calibrate::drift {

// Of calibrations that are still true, at most this share is said to have drifted.
inline constexpr double kFalseAlarms = 0.01;

struct DriftOptions {
  double angle_sigma_deg = 0.05;   // of where the table is at each view
  double edge_offset_sigma = 0.2;  // pixels, of outlines: blur and shading
  double shading_sigma = 0.1;      // pixels, of each harmonic of what all outlines have alike
};

// A length of a vector, or a number with its sign, with its sigma: that of the pictures and of the
// stored calibration.
struct Quantity {
  std::string key;    // "camera_turned_deg"
  std::string words;  // "the camera turned by"
  std::string unit;   // "deg"; a length is in the calibration's unit
  double value = 0.0, sigma = 0.0;
  double sigma_of_pictures = 0.0;  // without the stored calibration's share
};

// A fit with these causes.
struct Finding {
  std::vector<Cause> causes;
  double gain = 0.0;         // chi-squared that they explain
  int freedom = 0;           // by so many numbers
  double chance = 1.0;       // of so much gain without drift
  double left_chance = 1.0;  // of what they leave unexplained, if it is noise
  bool explains = false;     // leaves nothing to speak of
  std::vector<Quantity> quantities;
};

enum class Verdict { kStillTrue, kDrifted, kCannotTell };

// One corner, or one point of an outline.
struct PointDrift {
  std::size_t view = 0;  // of `views`
  Eigen::Vector2d pixel;
  // Seen less expected, pixels; of an outline's point along its normal. With the stored calibration
  // as it is, and with the finding.
  Eigen::Vector2d stored, found;
};

struct DriftReport {
  Verdict verdict = Verdict::kCannotTell;
  std::string why;  // it cannot be told

  // Pixels: of corners per coordinate, of outlines along the normal. The stored calibration as it
  // is, with a board's place, deviations of angles and the edge offset fitted.
  double stored_rms = 0.0;
  double worst = 0.0;      // of a point
  double noise = 0.0;      // rms that no change of the calibration explains
  double moved_rms = 0.0;  // by how much the finding moves the points from the stored calibration

  std::vector<Finding> alone;         // each cause that the pictures can tell, by itself
  Finding everything;                 // all of them
  Finding found;                      // if it drifted
  std::vector<Finding> as_well;       // others that fit as well as `found`
  std::vector<std::string> views;     // labels of those used
  std::vector<std::string> left_out;  // with the reason
  std::size_t outliers = 0;
  std::vector<PointDrift> points;  // without outliers
  std::vector<std::string> remarks;
  std::string length_unit;
};

// Fails (kInput) if there is nothing to see at all. What pictures show but do not tell is a
// verdict.
Result<DriftReport> CheckWithBoard(const rig::RigCalibration& calibration,
                                   const board::Board& board,
                                   const std::vector<axis::AxisView>& views,
                                   const DriftOptions& options = {});
// The target stands where the calibration's X_AT has it, or did. Fails (kInput) too if the
// calibration does not say where the target is.
Result<DriftReport> CheckWithOutlines(const rig::RigCalibration& calibration,
                                      const TargetShape& shape,
                                      const std::vector<placement::View>& views,
                                      const DriftOptions& options = {});

}  // namespace turnlight::calib::calibrate::drift
