// progress.csv: every estimate that was published while the capture went on, one line per light.
#pragma once

#include <string>
#include <vector>

#include "nodes/messages.h"

namespace turnlight::app {

// Columns: keyframes, residual_rms, light (from 1, in the estimate's order), direction_x,
// direction_y, direction_z, direction_sigma_deg, inverse_distance, inverse_distance_sigma,
// intensity, intensity_sigma. Numbers read back to the same bits.
std::string ProgressTable(const std::vector<nodes::Estimate>& estimates);

}  // namespace turnlight::app
