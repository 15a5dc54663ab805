// Keyframes that are read when they are needed: pictures are large, and few are needed at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/result.h"
#include "calib/rig_geometry.h"
#include "estimator/model/keyframe.h"

namespace turnlight::estimator::model {

struct KeyframeSource {
  std::vector<calib::RigPoses> poses;  // of each keyframe
  // A keyframe, its poses as above; the same each time. Called from several threads.
  std::function<Result<Keyframe>(std::size_t keyframe)> read;

  std::size_t size() const { return poses.size(); }
};

// Of keyframes in memory, which must outlive the source.
KeyframeSource SourceOf(const std::vector<Keyframe>& keyframes);

}  // namespace turnlight::estimator::model
