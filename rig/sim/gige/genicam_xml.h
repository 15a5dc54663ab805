// The camera's description of itself in the GenICam language: standard (SFNC) names on the
// registers of rig/sim/gige/registers.h. Binning has the fixed value 1, and what a sensor of any
// maker can be asked for and this one has not is left out.
#pragma once

#include <string>

namespace turnlight::rig::sim::gige {

inline constexpr char kVendorName[] = "turnlight";
inline constexpr char kModelName[] = "simulated GigE camera";

std::string GenicamXml();

}  // namespace turnlight::rig::sim::gige
