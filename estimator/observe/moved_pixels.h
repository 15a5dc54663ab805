// Pixels seen once more with everything a little elsewhere: what a calibration that is wrong
// changes of the observations.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "estimator/observe/sampling.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Positions, normals and mirrored directions with other poses (one for each keyframe) and, if it is
// given, another lens than that of `rays`; the reference stays where it is in W. Footprints, which
// change by less than they are kept to, and radiances stay. seen: 0 where a pixel no longer lies on
// one smooth piece of the surface, and what it had stays; 1 elsewhere. Deterministic for any number
// of threads.
Observations Moved(const PixelSample& sample, const std::vector<calib::RigPoses>& poses,
                   const calib::CameraModel* lens, const target::Geometry& geometry,
                   const calib::RayGrid& rays, std::vector<std::uint8_t>& seen);

}  // namespace turnlight::estimator::observe
