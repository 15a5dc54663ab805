// The keyframes in a few thousand pixels each: enough to tell whether pictures, poses and model
// belong together, and small enough to keep all of them.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::consistency {

// One keyframe, grey, each pixel the mean over a block of the picture's.
struct SmallView {
  cv::Mat1f radiance;
  cv::Mat1b clipped;  // any pixel of the block was clipped or not finite
  cv::Mat1b mask;     // all pixels of the block are in the keyframe's mask
  calib::RigPoses poses;
  std::size_t number = 0;  // what messages call it by
};

struct SmallViews {
  calib::CameraModel camera;  // of the small pictures
  int block = 1;              // pixels of the picture along a side of a small one's
  std::vector<SmallView> views;
};

// The side of the blocks that leaves about 2500 small pixels on a target seen from these poses,
// and at least 60 rows of them; 1 or more. None of the poses sees it: as if it filled a tenth.
int BlockFor(const calib::CameraModel& camera, const target::Geometry& geometry,
             const std::vector<calib::RigPoses>& poses);

// Pixels beyond the last whole block are left out.
SmallView MakeSmallView(const model::Keyframe& keyframe, int block, std::size_t number);

// The radiance inside the mask, 0 outside: what stands behind the target is left out. Without a
// mask the whole.
cv::Mat1f Masked(const SmallView& view);

std::vector<calib::RigPoses> PosesOf(const SmallViews& views);
// 0, 1, 2, ...: every view with its own picture.
std::vector<std::size_t> InOrder(const SmallViews& views);

// As keyframes with these poses; picture k is that of view picture[k].
std::vector<model::Keyframe> ToKeyframes(const SmallViews& views,
                                         const std::vector<calib::RigPoses>& poses,
                                         const std::vector<std::size_t>& picture);
// With their own.
std::vector<model::Keyframe> ToKeyframes(const SmallViews& views);

}  // namespace turnlight::estimator::consistency
