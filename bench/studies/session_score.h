// From a session on disk that has a truth.json to a scored estimate, on the path of `turnlight
// estimate`.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "bench/studies/study_file.h"
#include "estimator/from_session/session_estimate.h"
#include "estimator/model/scene.h"

namespace turnlight::studies {

// A photograph's truth may be directions alone; then nothing else is compared.
struct SessionTruth {
  estimator::model::Scene scene;
  bool directions_only = false;
};
// Fails like app::ReadScene.
Result<SessionTruth> ReadSessionTruth(const std::filesystem::path& folder);

// The estimate beside truth.json; what was refused is the record's "failed".
Json EstimateAndScoreSession(const std::filesystem::path& folder,
                             const estimator::from_session::Options& options = {});

}  // namespace turnlight::studies
