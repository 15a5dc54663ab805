// The paper's method as a whole, and what it found in the form of every estimate.
#pragma once

#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/estimate.h"
#include "estimator/geometry.h"
#include "estimator/keyframe.h"
#include "estimator/paper_method.h"

namespace turnlight::estimator {

// Stands beside EstimateScene, on the same observations and with the same refusals. The gauge is
// the method's own: a light's intensity is (d0 / distance)^2, its irradiance at W's origin. Sigmas,
// bounds of distances and the condition are NaN or absent: the method has none.
Result<EstimateOutput> EstimateByPaper(const std::vector<Keyframe>& keyframes,
                                       const Geometry& geometry, const calib::RayGrid& rays,
                                       const PaperOptions& options);

}  // namespace turnlight::estimator
