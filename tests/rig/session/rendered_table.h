// A lump on a table as a camera would see it: rendered once without noise, then recorded with as
// many seeds of noise as a test wants. Not for what a renderer does; tests/rig/sim looks at that.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/format.h"
#include "base/random.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::rig {

constexpr double kStepDeg = 30.0;
constexpr double kReadNoise = 0.002;  // of white
constexpr double kShotNoise = 0.004;  // of white, at white
constexpr double kWhite = 65535.0;

// The scene of configs/simulated_turntable.yaml; frame i at i (kStepDeg + error_deg), every light
// being as bright as `brightness` says.
inline sim::SyntheticConfig TableConfig(int frames, double error_deg = 0.0,
                                        double brightness = 1.0) {
  sim::SyntheticConfig config;
  config.seed = 7;
  config.target = sim::Blob{40.0, 0.25, 96};
  config.motion = {sim::MotionKind::kTable, frames, kStepDeg + error_deg, 480.0, 25.0, 0.0};
  config.camera.width = 320;
  config.camera.height = 240;
  config.camera.focal_px = 640.0;
  config.lights = std::vector<sim::LightSpec>{{{0.5, -0.3, 0.8}, 800.0, 0.8 * brightness},
                                              {{-0.6, 0.3, 0.7}, 1100.0, 0.5 * brightness}};
  estimator::model::Reflectance reflectance;
  reflectance.albedo = {0.7, 0.55, 0.4};
  reflectance.ambient = 0.06 * brightness;
  reflectance.diffuse = 0.6;
  reflectance.lobes[0].strength = 0.25;
  reflectance.lobes[0].shape = 40.0;
  config.reflectance = reflectance;
  config.sensor.depth = sim::SensorDepth::kFloat;
  config.samples_per_side = 4;
  return config;
}

inline sim::SyntheticSession RenderTable(int frames, double error_deg = 0.0,
                                         double brightness = 1.0) {
  auto rendered = sim::SynthesizeInMemory(TableConfig(frames, error_deg, brightness));
  EXPECT_TRUE(rendered) << (rendered ? "" : rendered.error().text);
  return std::move(*rendered);
}

// A picture of levels as a sensor of 16 bits records it.
inline cv::Mat Recorded(const cv::Mat& levels, std::uint64_t seed, std::uint64_t frame) {
  cv::Mat recorded(levels.size(), CV_MAKETYPE(CV_16U, levels.channels()));
  const RandomStream random(seed, frame);
  const int width = levels.cols * levels.channels();
  for (int y = 0; y < levels.rows; ++y)
    for (int i = 0; i < width; ++i) {
      const auto level = static_cast<double>(levels.ptr<float>(y)[i]);
      const double sigma =
          std::sqrt(kReadNoise * kReadNoise + kShotNoise * kShotNoise * std::max(level, 0.0));
      const double noise = sigma * random.Normal(static_cast<std::uint64_t>(y * width + i));
      recorded.ptr<std::uint16_t>(y)[i] =
          cv::saturate_cast<std::uint16_t>(kWhite * (level + noise));
    }
  return recorded;
}

inline calib::Radiometry TableRadiometry() {
  calib::Radiometry radiometry;
  radiometry.white = kWhite;
  return radiometry;
}

// The session of a render, with the noise of a seed.
inline Session TableSession(const sim::SyntheticSession& rendered) {
  Session session;
  session.name = "table";
  session.length_unit = "mm";
  session.camera_path = "camera.cameramodel";
  session.camera = rendered.camera;
  session.radiometry = TableRadiometry();
  session.target = calib::SphereShape{40.0};
  for (std::size_t i = 0; i < rendered.frames.size(); ++i) {
    FrameRecord frame;
    frame.image = Format("frames/%03zu.png", i);
    frame.angle_deg = kStepDeg * static_cast<double>(i);
    frame.exposure.exposure_us = 8000.0;
    frame.X_WC = rendered.frames[i].X_WC;
    frame.X_WT = rendered.frames[i].X_WT;
    session.frames.push_back(frame);
  }
  return session;
}

// Writes it.
inline void RecordTable(const sim::SyntheticSession& rendered, std::uint64_t seed,
                        const std::filesystem::path& root) {
  std::filesystem::create_directories(root / "frames");
  const Session session = TableSession(rendered);
  for (std::size_t i = 0; i < rendered.frames.size(); ++i)
    ASSERT_TRUE(
        WriteImage(root / session.frames[i].image, Recorded(rendered.frames[i].image, seed, i)));
  ASSERT_TRUE(WriteSession(session, root));
}

}  // namespace turnlight::rig
