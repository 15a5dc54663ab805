#include "app/calibrate/prop_stage.h"

#include <utility>

#include "app/calibrate/prompt.h"

namespace turnlight::app {

Status PropStage::Put(const std::string& prop, const std::string& words) {
  if (!recipe_->simulator) return asks_ ? WaitForEnter(words + ", then Enter ", stop_) : Status();
  simulator_.reset();  // its port and its address are needed again
  SimulatorConfig config = *recipe_->simulator;
  const auto found = recipe_->props.find(prop);
  if (found != recipe_->props.end()) {
    config.simulation.camera.prop = found->second;
    config.camera->camera.prop = found->second;
  }
  auto started = Simulator::Start(std::move(config));
  if (!started) return Forward(started);
  simulator_ = std::move(*started);
  return {};
}

}  // namespace turnlight::app
