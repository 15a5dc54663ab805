// The axis of a turntable from views of a board that turns on it: one joint least-squares fit of
// the axis and the board's pose in C, the angle scale and the backlash, with the views' deviations
// from their angles as random effects, and covariances.
//
// Which of the gauge's freedoms is fixed how: rig_frame.h. Of a rotation of W about the axis and of
// the table's zero, one cannot be told from the other: angle_offset is 0, and where the target is
// at angle 0 is in X_AT.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::axis {

enum class Approach { kRising, kFalling };  // of the reported angles, as the table came to this one

struct AxisView {
  double angle_deg = 0.0;            // as the table reports it; finite, not wrapped
  std::optional<Approach> approach;  // if it is known
  board::BoardView board;            // no points: no board was found
};

struct AxisOptions {
  double origin_height = 0.0;  // length unit; of W's origin above where rig_frame.h has it
  std::optional<Eigen::MatrixXd> intrinsics_covariance;  // of the camera's intrinsics, in order
};

// What became of a view.
struct FittedView {
  std::size_t view = 0;  // of the input
  bool used = false;
  std::string why_not;        // of one that is left out: "no board was found"
  std::size_t numbering = 0;  // which of the board's same-looking numberings, from view to view
  std::size_t points = 0, outliers = 0;  // points counts the outliers too
  double rms_px = 0.0;                   // per coordinate, of points that are no outliers
  double deviation_deg = 0.0;            // turned, less what its angle says; true degrees about +z
  double deviation_sigma_deg = 0.0;      // of the corners' noise
  Pose X_CB;                             // of a used one
};

struct Backlash {
  // By how much farther the table reports when it comes by rising angles than by falling ones, for
  // the same place; degrees that it reports. Positive of a table with play.
  double deg = 0.0, sigma_deg = 0.0;
};

// The first view against the ones a whole turn (or more) away, by what the table reports.
struct Closure {
  std::size_t first = 0, last = 0;                  // views of the input
  double turns = 1.0;                               // signed
  double turned_deg = 0.0, turned_sigma_deg = 0.0;  // about +z, that the board did not come back
  double shift = 0.0;  // length unit: of the board's middle, in its plane
};

struct AxisCalibration {
  Pose X_WC;
  double angle_scale = 1.0;  // negative: the table counts clockwise seen from +z
  // 7 x 7: of X_WC (w, d as in rig-calibration.json) and angle_scale, intrinsics' share included.
  Eigen::MatrixXd covariance;
  // With the intrinsics before them, if their covariance was given: (N + 7) x (N + 7).
  std::optional<Eigen::MatrixXd> joint_covariance;

  // The axis in C: its direction (unit, W's z), and its point at W's origin. covariance 4 x 4: of
  // the direction (radians) and of the point, each along W's x and y axes.
  Eigen::Vector3d direction_C, origin_C;
  Eigen::Matrix4d axis_covariance;
  double direction_sigma_deg = 0.0;  // the larger one of its ellipse
  double offset_sigma = 0.0;         // likewise, length unit
  double scale_sigma = 0.0;

  Pose X_WB;                         // the board when the table reports 0
  bool board_lies = true;            // rig_frame.h
  std::optional<Backlash> backlash;  // nothing if all views came from one side
  std::vector<Closure> closures;
  double corner_sigma_px = 0.0;   // per coordinate of a well seen point
  double angle_sigma_deg = 0.0;   // of a view's deviation from its angle
  std::vector<FittedView> views;  // of all of the input
  std::size_t used = 0;
  double arc_deg = 0.0;       // that the used views leave no larger gap beyond, of 360
  double board_radius = 0.0;  // root mean square distance of the board's points from the axis
};

// Fails (kInput): an intrinsics' covariance of another size. Fails (kNoEstimate) with the reason:
// too few views or angles; views that do not show one turning board (numbering.h); an axis whose
// sigma is beyond what a calibration is of use with (1 degree, 1 % of the camera's distance, 5
// degrees a turn).
Result<AxisCalibration> CalibrateAxis(const board::Board& board, const CameraModel& camera,
                                      const std::vector<AxisView>& views,
                                      const AxisOptions& options = {});

// "view 3 (30 deg)"
std::string ViewLabel(std::size_t view, double angle_deg);

}  // namespace turnlight::calib::calibrate::axis
