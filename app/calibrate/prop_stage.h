// What stands before the camera in a step of a calibration: a person puts it there, or the
// simulator, which is begun anew with it.
#pragma once

#include <memory>
#include <string>

#include "app/calibrate/rig_recipe.h"
#include "app/simulator.h"
#include "base/result.h"
#include "base/stop_flag.h"

namespace turnlight::app {

class PropStage {
 public:
  // recipe outlives it. asks: a person is asked for what a real rig needs.
  PropStage(const RigRecipe& recipe, bool asks, const StopFlag* stop)
      : recipe_(&recipe), asks_(asks), stop_(stop) {}

  // prop: a key of the recipe's props, or "target". words: what a person has to do.
  Status Put(const std::string& prop, const std::string& words);

 private:
  const RigRecipe* recipe_;
  bool asks_;
  const StopFlag* stop_;
  std::unique_ptr<Simulator> simulator_;
};

}  // namespace turnlight::app
