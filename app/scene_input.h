// Scenes and starts from files: a truth.json or a result.json.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "estimator/model/initial_guess.h"
#include "estimator/model/scene.h"

namespace turnlight::app {

// Fail (kInput, kSystem) like ReadFile and like the readers of estimator/results/scene_json.h.
Result<estimator::model::Scene> ReadScene(const std::filesystem::path& path);
Result<estimator::model::InitialGuess> ReadInitialGuess(const std::filesystem::path& path);

}  // namespace turnlight::app
