#include "static_render.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "estimator/target/renderer.h"
#include "rig/sim/studio.h"

namespace turnlight::nodes {
namespace {

constexpr double kWhite = 65535.0;

// In DN; a positive angle turns the target counter-clockwise about W's z axis.
cv::Mat3f StaticPicture(const rig::sim::Studio& studio, const rig::sim::Motion& motion,
                        double angle_deg) {
  const calib::RigPoses start = rig::sim::PlaceAt(motion, 0.0);
  calib::Pose X_WT = start.X_WT;
  const Eigen::AngleAxisd turn(angle_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
  X_WT.rotation = turn.toRotationMatrix() * start.X_WT.rotation;
  X_WT.translation = turn * start.X_WT.translation;
  const auto rendering =
      estimator::target::Render(studio.scene, studio.geometry, studio.rays, start.X_WC, X_WT,
                                {.samples_per_side = studio.samples_per_side});
  return rendering.radiance * kWhite;
}

}  // namespace

double WorstSigmas(const std::vector<Bracket>& brackets, const rig::sim::MockCameraConfig& config) {
  const auto studio = rig::sim::BuildStudio(config.scene);
  if (!studio) throw std::runtime_error(studio.error().text);
  const double noise_dn = config.scene.sensor.noise_relative * kWhite;
  const double sigma_dn = std::hypot(noise_dn, std::sqrt(1.0 / 12.0));  // and of rounding
  double worst = 0.0;
  for (const Bracket& bracket : brackets) {
    const cv::Mat3f expected = StaticPicture(*studio, config.scene.motion, bracket.angle_deg);
    for (const Frame& frame : bracket.exposures) {
      if (frame.image.type() != CV_16UC3 || frame.image.size() != expected.size())
        throw std::runtime_error("a picture of another kind");
      const cv::Mat_<cv::Vec3w> picture = frame.image;
      for (int i = 0; i < static_cast<int>(expected.total()); ++i)
        for (int c = 0; c < 3; ++c) {
          const double clipped = std::min<double>(expected(i)[c], kWhite);
          const double off = picture(i)[c] - clipped;
          worst = std::max(worst, std::abs(off) / sigma_dn);
        }
    }
  }
  return worst;
}

}  // namespace turnlight::nodes
