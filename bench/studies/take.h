// From a config of the scene generator to a scored estimate, on the path of `turnlight estimate`.
#pragma once

#include "bench/studies/study_file.h"
#include "estimator/baseline/paper_estimate.h"
#include "estimator/estimate.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::studies {

// The result.json of an estimate of these pictures, and the time of the estimate alone in
// time_s/total.
Result<Json> EstimateSynthetic(const rig::sim::SyntheticSession& session,
                               const estimator::EstimateOptions& options = {});

// The estimate of these pictures beside session.scene; what was refused is the record's "failed".
Json EstimateAndScore(const rig::sim::SyntheticSession& session,
                      const estimator::EstimateOptions& options = {});

// The same by the paper's method.
Json EstimateAndScoreByPaper(const rig::sim::SyntheticSession& session,
                             const estimator::baseline::PaperOptions& options);

// Makes the pictures in memory (with the sensor's bits, encoding and clipping), estimates, scores.
Json TakeAndScore(const rig::sim::SyntheticConfig& config,
                  const estimator::EstimateOptions& options = {});

// A record of the given keys with more keys after them.
Json Joined(Json first, const Json& second);

// What a config is, in a few keys: target, motion, views, size, bits, encoding, noise.
Json Describe(const rig::sim::SyntheticConfig& config);

}  // namespace turnlight::studies
