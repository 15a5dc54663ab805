// The paper's method as a whole, and what it found in the form of every estimate.
#pragma once

#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/baseline/paper_method.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::baseline {

// Stands beside EstimateScene, on the same observations and with the same refusals. The gauge is
// the method's own: a light's intensity is (d0 / distance)^2, its irradiance at W's origin. Sigmas,
// bounds of distances and the condition are NaN or absent: the method has none.
Result<EstimateOutput> EstimateByPaper(const std::vector<model::Keyframe>& keyframes,
                                       const target::Geometry& geometry, const calib::RayGrid& rays,
                                       const PaperOptions& options, const Watch& watch = {});

}  // namespace turnlight::estimator::baseline
