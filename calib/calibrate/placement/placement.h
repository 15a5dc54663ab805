// Where the target stands on the table: X_AT from the outlines that pictures at several angles
// show, from picked points, or from both.
//
// What is fitted: a rotation vector w and a shift d of X_AT (radians and length unit, in A), the
// radius of a sphere if asked, and an edge offset: how far the outlines that were found lie outside
// the true ones, the same in all pictures (blur, shading, a mask's convention). The offset has a
// normal prior, so that what only the apparent size tells, such as the distance in a single
// picture, has a sigma that admits it.
//
// A shift that all outlines share and that no residual shows is allowed for in the covariance.
//
// Residuals are distances in pixels along the outline's normal, positive outside. Their size gives
// the noise; how far they are correlated along the outline, and how much whole pictures are shifted
// against each other, widens the covariance.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/pose.h"
#include "calib/target_shape.h"
#include "rig/rig_calibration.h"

namespace turnlight::calib::calibrate::placement {

struct OutlinePoint {
  Eigen::Vector2d pixel;   // (0, 0) is the centre of the top-left pixel
  Eigen::Vector2d normal;  // unit, away from the target
  double sigma = 0.3;      // pixels along the normal, relative to the other points; positive
};

// Points in their order along the outline; neighbours are a few pixels apart, a wider gap is one.
struct View {
  double angle_deg = 0.0;  // as the table reports it
  std::string label;       // "frame 3 (30.0 deg)", for messages
  std::vector<OutlinePoint> outline;
};

struct PickedPoint {
  std::size_t view = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector3d p_T;
  std::string where;  // "points.csv:7", for messages
};

struct PlacementOptions {
  double edge_offset_sigma = 0.2;  // pixels, of the prior; 0 holds the offset at 0
  // Pixels per axis: sigma of a shift that outlines have in all pictures alike, as the side away
  // from the lamps is always the same one. Rendered spheres with one dark side have 0.015.
  double common_shift_sigma = 0.03;
  double picked_sigma = 1.0;  // pixels, of a picked point along each axis; positive
  bool fit_radius = false;    // of a sphere; needs two angles that differ
  // A mesh without picked points: T's z axis is along A's, every angle about it is tried.
  bool upright = false;
};

// One measured distance and what became of it.
struct PointFit {
  std::size_t view = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector2d normal;
  double residual = 0.0;  // pixels, outside positive; picked points: along x and along y
  bool used = false;      // false: an outlier, or no part of the target's outline is near
};

struct ViewFit {
  std::size_t points = 0, used = 0;
  double rms = 0.0;                                 // pixels, of those used
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // pixels, of this picture against the fit
};

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Placement {
  calib::Pose X_AT;
  // Of (w, d), R -> Exp(w) R, t -> t + d in A, as rig-calibration.json has it.
  Matrix6 covariance = Matrix6::Zero();        // the sum of the next two
  Matrix6 from_outlines = Matrix6::Zero();     // noise, edge offset, shifts
  Matrix6 from_calibration = Matrix6::Zero();  // camera, axis and angles, as far as they are known
  // The calibration's parts that have a covariance, and 6 x N between X_AT and them: a camera that
  // was taken to be too high makes a target too high.
  rig::JointCovariance calibration;
  Eigen::MatrixXd with_calibration;
  double radius = 0.0, radius_sigma = 0.0;            // of a sphere; sigma 0 if it was given
  double edge_offset = 0.0, edge_offset_sigma = 0.0;  // pixels
  double rms = 0.0;                                   // pixels, of the residuals used
  double correlation = 1.0;      // variance of a mean of residuals over that of independent ones
  double wobble = 0.0;           // pixels per axis, of whole pictures, above what noise explains
  double pixel_length = 0.0;     // length unit that a pixel spans at the target
  bool rotation_matters = true;  // false: a sphere
  std::optional<Eigen::Vector3d> symmetry_axis;  // in T: rotation about it is not determined
  std::optional<double> reversed_rms;            // pixels; given: reversed angles fit better
  std::vector<ViewFit> views;                    // as those given
  std::vector<PointFit> points;
  std::vector<std::string> remarks;  // what the user should know
};

// The calibration's own X_AT is not used. Picked points, where there are enough of them, say where
// to begin; outlines, where there are any, decide. Fails (kInput) when the views cannot tell:
// nothing to see, too few points, a mesh without points that is not said to be upright; fails
// (kNoEstimate) when the outlines do not fit the shape.
Result<Placement> PlaceTarget(const rig::RigCalibration& calibration,
                              const calib::TargetShape& shape, const std::vector<View>& views,
                              const std::vector<PickedPoint>& picked,
                              const PlacementOptions& options = {});

// The calibration with X_AT, its covariance, and what that has in common with the other parts'.
rig::RigCalibration WithTarget(const rig::RigCalibration& calibration, const Placement& placement);

// The outline that a target placed so has in a picture, as polylines of image points.
std::vector<std::vector<Eigen::Vector2d>> ExpectedOutline(const rig::RigCalibration& calibration,
                                                          const calib::TargetShape& shape,
                                                          const calib::Pose& X_AT,
                                                          double angle_deg);

// Points along that outline `spacing` pixels apart, in order.
std::vector<OutlinePoint> SampleOutline(const rig::RigCalibration& calibration,
                                        const calib::TargetShape& shape, const calib::Pose& X_AT,
                                        double angle_deg, double spacing);

}  // namespace turnlight::calib::calibrate::placement
