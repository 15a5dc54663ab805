// What stands before a simulated camera instead of the scene's target, for calibrations: in a
// simulation's section `prop`.
//
//   {kind: board, board: {...}, ...}     a board that lies on the table and turns with it
//   {kind: handheld, board: {...}, ...}  a board held by hand, in another pose in each picture
//   {kind: ball, radius: 25, offset: [0, 0, 25], ...}   a mirror ball on the table, among the
//   lights {kind: flat, radiance: 0.8}          a field that is evenly lit {kind: grey, radiance:
//   0.5, colour: [1, 1, 1]}   a grey card over the field, in coloured light {kind: dark} the lens
//   is covered {kind: empty}                        the table without the target {kind: lamp-off}
//   the target, its lamps off
//
// Radiance 1 is the sensor's white at the reference exposure; the lens's vignetting and the
// sensor's noise and encoding come on top. With a prop, pictures at one angle with the same
// settings have noise of their own each, as pairs of pictures for the noise model need.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <variant>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/calibrate/board/board.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::rig::sim {

// Keys beside kind and board, all optional: as the members.
struct BoardLook {
  double bright = 0.8;        // radiance of paper, 0..100
  double dark = 0.05;         // of print, 0..100
  double background = 0.2;    // of all around, 0..100
  double quiet_border = 0.0;  // paper around the print, length unit, at least 0
  double blur_px = 0.5;       // Gaussian, of the optics, 0..50
};

struct TableBoard {
  calib::calibrate::board::Board board;
  BoardLook look;
  // Of the board's middle in the axis frame A; and a rotation vector, -180..180 each, after it was
  // laid flat, printed side up, its x axis along A's.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero();
};

// The whole print is in the picture, if there is such a pose: drawn by (seed, picture).
struct HandheldBoard {
  calib::calibrate::board::Board board;
  BoardLook look;
  std::uint64_t seed = 1;
  std::array<double, 2> distance{300.0, 500.0};  // of its middle from the camera, above 0
  double tilt_max_deg = 40.0;                    // 0..80
  double roll_max_deg = 20.0;                    // 0..180
};

// The scene's lights are glowing balls in it, the strongest of them of radiance lamp_radiance. Keys
// as the members, all optional.
struct BallOnTable {
  double radius = 25.0;                                   // length unit, above 0
  Eigen::Vector3d offset = {0.0, 0.0, 25.0};              // of its middle in the axis frame A
  double reflectance = 0.9;                               // of the mirror, 0..1
  double diffuse = 0.0;                                   // of a glossy ball, 0..1
  double lamp_radius_deg = 1.0;                           // seen from W's origin, 0.05..45
  double lamp_radiance = 20.0;                            // 0..1e4
  double ceiling = 0.05, floor = 0.02, background = 0.2;  // radiance of the room, 0..100
  double blur_px = 0.5;                                   // Gaussian, of the optics, 0..50
};

struct EvenField {
  Eigen::Vector3d radiance = Eigen::Vector3d::Zero();
};
struct LampOff {};

using Prop = std::variant<TableBoard, HandheldBoard, BallOnTable, EvenField, LampOff>;

Result<Prop> ReadProp(StrictObject object);
// The look's keys, where others stand beside them.
void ReadLook(StrictObject& object, BoardLook& look);

// X_AB of a board on the table, and X_CB of a board held by hand.
calib::Pose PoseOf(const TableBoard& prop);
calib::Pose PoseOf(const HandheldBoard& prop, const calib::CameraModel& camera,
                   std::uint64_t picture);

// Linear radiance, noise-free, before the vignetting: a board that is there.
cv::Mat3f RenderBoard(const calib::calibrate::board::Board& board, const BoardLook& look,
                      const calib::Pose& X_CB, const calib::CameraModel& camera);

}  // namespace turnlight::rig::sim
