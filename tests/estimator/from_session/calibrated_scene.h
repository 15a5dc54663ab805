// A simulated turntable whose calibration is known, and the session that it takes.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/angles.h"
#include "base/file.h"
#include "base/sha256.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "rig/sim/studio.h"

namespace turnlight::estimator::from_session {

inline Eigen::MatrixXd PoseCovariance(double rotation_deg, double shift) {
  Eigen::VectorXd variance(6);
  variance << Eigen::Vector3d::Constant(DegToRad(rotation_deg) * DegToRad(rotation_deg)),
      Eigen::Vector3d::Constant(shift * shift);
  return variance.asDiagonal();
}

inline Eigen::MatrixXd Diagonal(std::initializer_list<double> sigmas) {
  Eigen::VectorXd variance(static_cast<Eigen::Index>(sigmas.size()));
  Eigen::Index i = 0;
  for (const double sigma : sigmas) variance[i++] = sigma * sigma;
  return variance.asDiagonal();
}

inline rig::CalibrationCovariances ExampleCovariances() {
  rig::CalibrationCovariances known;
  known.camera_model = Diagonal({0.3, 0.3, 0.4, 0.4});
  known.X_WC = PoseCovariance(0.05, 0.1);
  known.X_AT = PoseCovariance(0.1, 0.15);
  known.angle_scale = Diagonal({1e-4});
  known.radiometry = Diagonal({60.0, 300.0});
  return known;
}

// A near and a nearer light on a glossy target, with little noise.
inline rig::sim::SyntheticConfig SmallRig(rig::sim::SyntheticTarget target) {
  rig::sim::SyntheticConfig config;
  config.target = target;
  config.camera = {160, 120, 280.0, {}};
  config.motion.kind = rig::sim::MotionKind::kTable;
  config.lights = std::vector<rig::sim::LightSpec>{
      {Eigen::Vector3d(0.6, 0.2, 0.8), 900.0, 1.0, Eigen::Vector3d::Ones()},
      {Eigen::Vector3d(-0.3, 0.7, 0.6), 700.0, 0.5, Eigen::Vector3d::Ones()}};
  model::Reflectance material;
  material.albedo = {0.8, 0.7, 0.6};
  material.ambient = 0.05;
  material.diffuse = 0.5;
  material.lobes[0].strength = 0.15;
  material.lobes[0].shape = 25.0;
  config.reflectance = material;
  config.sensor.noise_relative = 0.002;
  config.sensor.white = 32768.0;
  return config;
}

struct CalibratedScene {
  rig::sim::SyntheticConfig config;
  rig::sim::Studio studio;
  rig::RigCalibration calibration;  // the truth, without covariances
  std::vector<double> angles_deg;
};

// The target stands off the axis, so that all that a calibration says matters.
inline CalibratedScene MakeCalibratedScene(rig::sim::SyntheticConfig config, int views) {
  config.sensor.depth = rig::sim::SensorDepth::k16;
  auto studio = rig::sim::BuildStudio(config);
  EXPECT_TRUE(studio) << studio.error().text;
  rig::RigCalibration calibration(studio->camera);
  calibration.geometry.X_WC = calib::LookAtOrigin(0.3, 0.5, config.motion.distance);
  calibration.geometry.X_AT = calib::Turn(Eigen::Vector3d(1, 2, 3).normalized(), 0.4);
  calibration.geometry.X_AT.translation = {18.0, -9.0, 6.0};
  calibration.radiometry = studio->radiometry;
  calibration.radiometry.reference_exposure_us = 1000.0;
  calibration.devices.resolution = {studio->camera.width(), studio->camera.height()};
  CalibratedScene scene{std::move(config), std::move(*studio), std::move(calibration), {}};
  for (int i = 0; i < views; ++i) scene.angles_deg.push_back(360.0 * i / views);
  return scene;
}

// The pictures that the rig takes as it is, in a session that says what a calibration says; the
// session names the calibration if `named`.
inline rig::Session WriteCalibrated(const CalibratedScene& scene,
                                    const rig::RigCalibration& calibration, std::uint64_t seed,
                                    const std::filesystem::path& root, bool named = true) {
  rig::Session session;
  session.name = "calibrated";
  session.length_unit = "mm";
  session.camera_path = "camera.cameramodel";
  session.camera = calibration.lens;
  session.radiometry = calibration.radiometry;
  if (const auto* sphere = std::get_if<calib::SphereShape>(&scene.studio.target))
    session.target = *sphere;
  else
    session.target = rig::MeshFile{"target.ply"};
  EXPECT_TRUE(MakeDirectory(root / "frames"));
  if (const auto* mesh = std::get_if<calib::MeshShape>(&scene.studio.target)) {
    EXPECT_TRUE(WriteFileAtomic(root / "target.ply", rig::sim::MeshToPly(*mesh)));
  }
  const calib::Exposure exposure{1000.0, 0.0};
  for (std::size_t i = 0; i < scene.angles_deg.size(); ++i) {
    const auto truth = calib::PosesAt(scene.calibration.geometry, scene.angles_deg[i]);
    const auto rendered = rig::sim::RenderPlacement(scene.studio, truth);
    const cv::Mat picture =
        rig::sim::Photograph(scene.config.sensor, scene.studio.radiometry, exposure,
                             RandomStream(seed, i), rendered.radiance);
    rig::FrameRecord frame;
    frame.image = "frames/" + std::to_string(i) + ".png";
    EXPECT_TRUE(rig::WriteImage(root / frame.image, picture));
    frame.angle_deg = scene.angles_deg[i];
    frame.exposure = exposure;
    const auto said = calib::PosesAt(calibration.geometry, scene.angles_deg[i]);
    frame.X_WC = said.X_WC;
    frame.X_WT = said.X_WT;
    session.frames.push_back(frame);
  }
  if (named) {
    const std::string text = rig::PrintRigCalibration(calibration, session.camera_path);
    EXPECT_TRUE(WriteFileAtomic(root / "rig-calibration.json", text));
    session.calibration = {"rig-calibration.json", Sha256Hex(text)};
  }
  const Status written = rig::WriteSession(session, root);
  EXPECT_TRUE(written) << (written ? "" : written.error().text);
  session.root = root;
  return session;
}

}  // namespace turnlight::estimator::from_session
