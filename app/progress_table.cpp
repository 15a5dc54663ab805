#include "app/progress_table.h"

#include <cstdio>

namespace turnlight::app {

std::string ProgressTable(const std::vector<nodes::Estimate>& estimates) {
  std::string table =
      "keyframes,residual_rms,light,direction_x,direction_y,direction_z,direction_sigma_deg,"
      "inverse_distance,inverse_distance_sigma,intensity,intensity_sigma\n";
  for (const nodes::Estimate& estimate : estimates) {
    int number = 0;
    for (const nodes::LightNow& light : estimate.lights) {
      table += std::to_string(estimate.keyframes);
      const auto add = [&table](double value) {
        char text[40];
        std::snprintf(text, sizeof text, ",%.17g", value);
        table += text;
      };
      add(estimate.rms);
      table += "," + std::to_string(++number);
      for (const double value : light.direction) add(value);
      add(light.direction_sigma_deg);
      add(light.inverse_distance);
      add(light.inverse_distance_sigma);
      add(light.intensity);
      add(light.intensity_sigma);
      table += "\n";
    }
  }
  return table;
}

}  // namespace turnlight::app
