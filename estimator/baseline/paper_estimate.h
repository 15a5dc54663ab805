// The paper's method as a whole, and what it found in the form of every estimate.
#pragma once

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/baseline/paper_method.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::baseline {

// Stands beside EstimateScene, on the same observations and with the same refusals. The gauge is
// the method's own: a light's intensity is (d0 / distance)^2, its irradiance at W's origin. Sigmas,
// bounds of distances and the condition are NaN or absent: the method has none.
// Of `estimate` only most_pixels, residuals_of and watch count: the method knows of nothing else.
Result<EstimateOutput> EstimateByPaper(const model::KeyframeSource& keyframes,
                                       const target::Geometry& geometry, const calib::RayGrid& rays,
                                       const PaperOptions& options,
                                       const EstimateOptions& estimate = {});

}  // namespace turnlight::estimator::baseline
