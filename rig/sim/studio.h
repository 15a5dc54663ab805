// What all pictures of one simulated scene share, and how one is taken: placed, rendered, given
// noise, encoded, clipped. The generator of sessions and the mock camera photograph through it.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "base/random.h"
#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "calib/target_shape.h"
#include "estimator/model/scene.h"
#include "estimator/target/geometry.h"
#include "estimator/target/renderer.h"
#include "rig/sim/prop.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/true_geometry.h"
#include "rig/sim/walk.h"

namespace turnlight::rig::sim {

struct Studio {
  calib::CameraModel camera;
  calib::RayGrid rays;
  cv::Mat1f shading;  // share of the light that gets through the lens, per pixel; empty: all
  calib::TargetShape target;
  estimator::target::Geometry geometry;
  estimator::model::Scene scene;  // the truth
  calib::Radiometry radiometry;   // reference_gain_db is 0; no reference_exposure_us
  int samples_per_side = 5;
  calib::RigGeometry rig;    // true of it, but for the angle noise
  TrueGeometry places;       // that it was made of
  std::uint64_t seed = 1;    // of the angle noise
  std::optional<Prop> prop;  // stands there instead of the target
  std::optional<Walk> walk;  // the camera is carried round it; rig is an orbit
};

// Fails (kInput): what Validate refuses, lights that cannot be placed as far apart as asked. The
// sensor's clip_share is left to the caller.
Result<Studio> BuildStudio(const SyntheticConfig& config);

// What turns, and how: a table whose axis is W's z axis, X_AT being the tilt; or the camera round
// the still target.
calib::RigGeometry GeometryOf(const Motion& motion);
// Where camera and target are when the motion has gone round by angle_deg.
calib::RigPoses PlaceAt(const Motion& motion, double angle_deg);

// Noise-free, behind the lens. lit = false leaves the ambient term alone.
estimator::target::Rendering RenderPlacement(const Studio& studio, const calib::RigPoses& placement,
                                             bool lit = true);
// The same at one frame of what is synthesized: lamps may change from one to the next.
estimator::target::Rendering RenderKeyframe(const Studio& studio, const calib::RigPoses& placement,
                                            std::size_t keyframe);

// One picture of what stands there.
struct View {
  double angle_deg = 0.0;  // the table's, or how far a camera was carried
  bool lit = true;
  std::uint64_t picture = 0;  // a number, of boards held by hand; 0 of all else

  bool operator==(const View&) const = default;
};
// Whether each picture shows another pose.
bool IsHandheld(const Studio& studio);
// Noise-free, behind the lens: the prop if there is one, else the target, where they really are.
// Empty coverage with a prop.
estimator::target::Rendering RenderView(const Studio& studio, const View& view);

// Standard deviation of the noise of one value of linear radiance. The sensor's variance is
// (noise_relative G)^2 + noise_shot^2 G s for a signal s (share of white) at a gain factor G.
double NoiseSigma(const Sensor& sensor, const calib::Radiometry& radiometry,
                  const calib::Exposure& exposure, double radiance);

// The sensor: noise (value i of the picture takes random number i), encoding, clipping. radiance is
// CV_32FC3, or CV_32FC1 for a grey sensor.
cv::Mat Photograph(const Sensor& sensor, const calib::Radiometry& radiometry,
                   const calib::Exposure& exposure, const RandomStream& random,
                   const cv::Mat& radiance);

}  // namespace turnlight::rig::sim
