// How much memory an estimate takes, said before it begins.
#pragma once

#include <cstddef>
#include <string>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator {

struct MemoryInputs {
  std::size_t picture_pixels = 0;  // of one picture
  std::size_t keyframes = 0;
  std::size_t target_pixels = 0;  // of all keyframes together, at most
  std::size_t most_pixels = 0;    // that the estimate may hold
  bool casts_shadows = false;     // a mesh
  bool noise_known = false;       // radiometry.noise
  std::size_t mesh_faces = 0;
  bool pictures = true;  // drawn at the end
};

// An upper bound of the most that the program holds at a time, in bytes; at most about 1.5 times
// what was measured, from 0.3 to 24 megapixels. Does not depend on the number of threads.
double MemoryNeed(const MemoryInputs& inputs);

// How many pixels see the target, from rays through a coarse grid of each picture; masks are not
// looked at. Rounded up by a tenth.
std::size_t TargetPixels(const model::KeyframeSource& keyframes, const target::Geometry& geometry,
                         const calib::CameraModel& camera);

// Fails with kInput if the need is more than so many bytes, and says which --pixels or --views
// would fit.
Status CheckMemory(const MemoryInputs& inputs, double most_bytes);

// "4GB", "800MB", "2.5 GiB": bytes.
Result<double> BytesOf(const std::string& size);

}  // namespace turnlight::estimator
