// A mirror ball among lamps, in closed form: each sample of a pixel is reflected exactly. A prop
// for what is calibrated by a ball, and for its tests.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::rig::sim {

// A glowing ball, which looks like a disc from everywhere. All in W.
struct BallLamp {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, from W's origin
  double inverse_distance = 0.0;                         // 1 / length unit; 0: distant
  double angular_radius = 0.01;  // radians, seen from W's origin; below pi / 2
  double radiance = 1.0;         // of its surface; white is 1
};

// A lit rectangle on a far wall, such as a window: directions within `half_width` and `half_height`
// (radians) of its middle, measured along two axes across it.
struct FarWindow {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit
  double half_width = 0.1;
  double half_height = 0.1;
  double radiance = 1.0;
};

struct MirrorBall {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // in W
  double radius = 25.0;
  double reflectance = 1.0;  // of the mirror
  double diffuse = 0.0;      // a glossy ball's: its share of a Lambertian shading by the lamps, per
                             // irradiance of 1 (radiance times pi sin^2 of the angular radius)
};

struct MirrorRoom {
  std::vector<BallLamp> lamps;
  std::vector<FarWindow> windows;
  double ceiling = 0.0;     // radiance of the room above, +z; it changes evenly to
  double floor = 0.0;       // that below
  double background = 0.0;  // of what is beside the ball
};

// Noise-free linear radiance, behind a lens that blurs by a Gaussian of `blur_px` (sigma, pixels;
// 0: none). A pixel is the mean over its footprint, of 4 x 4 samples, 16 x 16 where it sees an edge
// of a lamp or of a window.
cv::Mat1f RenderMirrorBall(const MirrorBall& ball, const MirrorRoom& room,
                           const calib::RayGrid& rays, const calib::Pose& X_WC, double blur_px);

}  // namespace turnlight::rig::sim
