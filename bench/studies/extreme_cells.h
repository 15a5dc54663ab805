// The cells of the extremes study: one plain scene, and one thing at a time taken to its extreme.
//
// The plain scene: a sphere of radius 50 mm, the camera goes round it in 8 views of 160 x 120, two
// lights 46 degrees apart at 12 and 18 radii, Phong with n = 40 and k_s = 0.3, Lambert; 16 bits
// linear with a black level, noise 0.2 % of white. Nothing is clipped.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::studies {

struct ExtremeCell {
  std::string group;    // "shininess"
  std::string setting;  // "1e5"
  std::function<Result<rig::sim::SyntheticSession>()> make;
};

std::vector<ExtremeCell> ExtremeCells();

// The plain scene.
rig::sim::SyntheticConfig PlainConfig();

// Parts of ExtremeCells, one per file: scenes whose config says everything, and those whose
// pictures, poses or shapes are changed after they were made.
void AddSceneCells(std::vector<ExtremeCell>& cells);
void AddPictureCells(std::vector<ExtremeCell>& cells);

}  // namespace turnlight::studies
