// One keyframe: what each of its pixels sees of the target, and why some of them are not used.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Why a pixel is not used; the bits of a flag picture. 0: used.
enum PixelFlag : std::uint8_t {
  kOffTarget = 1,      // the ray misses the target, or the mask says it is not the target
  kSaturated = 2,      // clipped, not finite, or one of the 8 neighbours of such a pixel
  kSilhouette = 4,     // within two pixels of the outline, or across a jump of depth or normal
  kGrazing = 8,        // seen too flat for its footprint to be trusted
  kUnlikeOthers = 16,  // an outlier among its neighbours
  kLostInNoise = 32,   // cut off at the sensor's floor
};

// The part of a pixel's width over which it averages. Of the mean over 5 x 5 points, as renderers
// take it (ours by default too), the variance is 24/25 of a box's; a camera's is known no better.
inline constexpr double kAperture = 0.97979589711327124;

// One pixel's geometry in W: means over its footprint, and their change across it.
struct PixelGeometry {
  Eigen::Vector3d position, normal, face_normal, mirrored;
  Eigen::Vector3d dw_du = Eigen::Vector3d::Zero(), dw_dv = Eigen::Vector3d::Zero();
  Eigen::Vector3d dx_du = Eigen::Vector3d::Zero(), dx_dv = Eigen::Vector3d::Zero();
  double cosine = 0.0;  // n.v
  bool smooth = false;  // the footprint lies on one smooth piece of surface
};

// A keyframe's usable pixels, before they are packed.
struct FramePixels {
  std::vector<PixelGeometry> geometry;
  std::vector<std::uint32_t> pixel;
  cv::Mat1b flags;
};

// Traces the rays of all pixels of the mask, in parallel, deterministically.
FramePixels TraceKeyframe(const model::Keyframe& keyframe, const target::Geometry& geometry,
                          const calib::RayGrid& rays);

// One pixel's width about an image point; not smooth if it meets no one piece of surface all round.
// None if its middle meets nothing, or lies outside the picture.
std::optional<PixelGeometry> TracePixel(const calib::RigPoses& poses,
                                        const target::Geometry& geometry,
                                        const calib::RayGrid& rays, const Eigen::Vector2d& point);

}  // namespace turnlight::estimator::observe
