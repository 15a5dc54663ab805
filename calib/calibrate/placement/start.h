// Where a fit begins. Internal to this folder.
#pragma once

#include <optional>
#include <vector>

#include "calib/calibrate/placement/fit.h"

namespace turnlight::calib::calibrate::placement {

// The centre from the middles of the outlines, over the angles, and from their size in one; the
// radius if it is unknown (0). Nothing if rays meet nowhere, or the radius cannot be told.
std::optional<State> StartSphere(const rig::RigCalibration& calibration,
                                 const std::vector<View>& views, double radius, bool fit_radius);

// At most `most` placements that differ and that picked points allow, best first; at least 4
// points. Every rotation of a grid, the shift being a linear problem then, and Gauss-Newton from
// the best.
std::vector<State> StartPicked(const rig::RigCalibration& calibration,
                               const std::vector<View>& views,
                               const std::vector<PickedPoint>& picked, double size,
                               std::size_t most);

// From the four corners of the outline of each of a few views, each assignment of corners.
std::vector<State> StartPlane(const rig::RigCalibration& calibration,
                              const std::vector<View>& views, const calib::PlaneShape& plane);

// A mesh whose z axis stands along A's: turned about it in steps of 10 degrees.
std::vector<State> StartUpright(const rig::RigCalibration& calibration,
                                const std::vector<View>& views, const Eigen::Vector3d& center_T,
                                double radius);

// The four corners of an outline that has about four; else nothing.
std::optional<std::vector<Eigen::Vector2d>> FindCorners(const std::vector<OutlinePoint>& outline);

}  // namespace turnlight::calib::calibrate::placement
