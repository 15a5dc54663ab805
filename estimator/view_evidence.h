// Why views tell nothing new: the same pose, copies, a table that stood still, or a target that
// looks the same from everywhere. What a note or a refusal claims of views is measured here.
#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "calib/rig_geometry.h"
#include "estimator/estimate.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator {

// Views whose pictures are the same bit for bit, and not of one value, though their poses differ
// and what their pixels see of the target does; each with the first such view before it.
// Signatures and poses of the views, in their order.
std::vector<std::pair<int, int>> FindCopies(const observe::Observations& all,
                                            const std::vector<cv::Mat>& signatures,
                                            const std::vector<calib::RigPoses>& poses);

// Gives the note "views-add-nothing", if there is one, the words of its cause.
// frame_numbers: EstimateOptions; scene and options: the solution, in the
// observations' coordinates and radiance, and how it is evaluated.
void ExplainViews(const observe::Observations& all, const std::vector<cv::Mat>& signatures,
                  const std::vector<calib::RigPoses>& poses, const model::Scene& scene,
                  const solve::EvaluateOptions& options,
                  const std::vector<std::size_t>& frame_numbers, Estimate& out);

}  // namespace turnlight::estimator
