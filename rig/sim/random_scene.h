// The scene of a config: what it lists, or what its seed draws.
#pragma once

#include "base/result.h"
#include "estimator/model/scene.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig::sim {

// The config must be valid. Fails (kInput) if the random lights cannot be placed as far apart as
// asked.
Result<estimator::model::Scene> DrawScene(const SyntheticConfig& config);

}  // namespace turnlight::rig::sim
