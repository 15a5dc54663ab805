// Whether a target shows its back.
#pragma once

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/observe/usable.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Adds to counts.rays and counts.from_behind: of an even sample of the pixels that the mask says
// are of the target, how many meet it, and how many of these from behind.
void CountBackFaces(const model::Keyframe& keyframe, const target::Geometry& geometry,
                    const calib::RayGrid& rays, FlagCounts& counts);

}  // namespace turnlight::estimator::observe
