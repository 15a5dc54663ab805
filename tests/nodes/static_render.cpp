#include "static_render.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "estimator/target/renderer.h"

namespace turnlight::nodes {
namespace {

rig::sim::Studio StudioOf(const rig::sim::MockCameraConfig& config) {
  auto studio = rig::sim::BuildStudio(config);
  if (!studio) throw std::runtime_error(studio.error().text);
  return std::move(*studio);
}

// Shares of white; a positive angle turns the target counter-clockwise about W's z axis.
cv::Mat3f StaticPicture(const rig::sim::Studio& studio, const rig::sim::Motion& motion,
                        double angle_deg) {
  const calib::RigPoses start = rig::sim::PlaceAt(motion, 0.0);
  calib::Pose X_WT = start.X_WT;
  const Eigen::AngleAxisd turn(angle_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
  X_WT.rotation = turn.toRotationMatrix() * start.X_WT.rotation;
  X_WT.translation = turn * start.X_WT.translation;
  return estimator::target::Render(studio.scene, studio.geometry, studio.rays, start.X_WC, X_WT,
                                   {.samples_per_side = studio.samples_per_side})
      .radiance;
}

double ValueAt(const cv::Mat& picture, int row, int column, int channel) {
  const int index = column * picture.channels() + channel;
  return picture.depth() == CV_8U ? picture.ptr<std::uint8_t>(row)[index]
                                  : picture.ptr<std::uint16_t>(row)[index];
}

}  // namespace

StaticScene::StaticScene(const rig::sim::MockCameraConfig& config, const PictureKind& kind)
    : config_(config), kind_(kind), studio_(StudioOf(config)) {}

double StaticScene::WorstSigmas(const Bracket& bracket) const {
  const cv::Mat3f scene = StaticPicture(studio_, config_.scene.motion, bracket.angle_deg);
  const double white = (1 << kind_.bits) - 1;
  const rig::sim::Sensor& sensor = config_.scene.sensor;
  double worst = 0.0;
  for (const Frame& frame : bracket.exposures) {
    const int channels = frame.image.channels();
    if (frame.image.depth() != (kind_.bits == 8 ? CV_8U : CV_16U) ||
        frame.image.size() != scene.size())
      throw std::runtime_error("a picture of another kind");
    for (int row = 0; row < scene.rows; ++row)
      for (int column = 0; column < scene.cols; ++column)
        for (int c = 0; c < channels; ++c) {
          const cv::Vec3f& colour = scene(row, column);
          const double light = channels == 3  ? colour[c]
                               : kind_.mosaic ? colour[row % 2 + column % 2]
                                              : (colour[0] + colour[1] + colour[2]) / 3.0;
          const double share = std::min(light, 1.0);
          const double noise =
              std::hypot(sensor.noise_relative, sensor.noise_shot * std::sqrt(share));
          const double sigma_dn = std::hypot(noise * white, std::sqrt(1.0 / 12.0));
          const double off = ValueAt(frame.image, row, column, c) - share * white;
          worst = std::max(worst, std::abs(off) / sigma_dn);
        }
  }
  return worst;
}

double WorstSigmas(const std::vector<Bracket>& brackets, const rig::sim::MockCameraConfig& config) {
  const StaticScene scene(config);
  double worst = 0.0;
  for (const Bracket& bracket : brackets) worst = std::max(worst, scene.WorstSigmas(bracket));
  return worst;
}

}  // namespace turnlight::nodes
