// What a response says, in words.
#pragma once

#include <string>
#include <vector>

#include "calib/calibrate/response/response.h"

namespace turnlight::calib::calibrate::response {

// Linear DN of a DN over the gain; of a response with photon transfer.
double SaturationElectrons(const Response& response, double saturation_dn);

// A verdict for each part that was measured, then what stands against it and what to do.
std::vector<std::string> WordsOf(const Response& response);

}  // namespace turnlight::calib::calibrate::response
