// Which lens model a user means.
#pragma once

#include <string>

#include "base/result.h"

namespace turnlight::calib::calibrate::lens {

// mrcal's full name of a lens model: "OPENCV8" and "LENSMODEL_OPENCV8" are the same, in either
// case. Splined models need their configuration, as mrcal writes it:
// "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=60". Fails (kInput): an unknown name,
// listing the allowed ones; CAHVORE, which mrcal projects but cannot optimise; a wrong
// configuration; more than 4000 parameters. `what` begins the message, such as "--lens".
Result<std::string> FullLensModelName(const std::string& name, const std::string& what);

// Whether it is a splined model: its first four intrinsics are held while the others are fitted.
bool IsSplined(const std::string& full_name);

}  // namespace turnlight::calib::calibrate::lens
