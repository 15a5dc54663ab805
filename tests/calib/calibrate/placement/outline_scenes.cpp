#include "tests/calib/calibrate/placement/outline_scenes.h"

#include <cmath>
#include <numbers>

#include "base/angles.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// A star-shaped surface over latitude and longitude; radius by direction.
template <typename RadiusOf>
calib::MeshShape Star(int rings, int sectors, const RadiusOf& radius_of) {
  calib::MeshShape mesh;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double polar = pi * i / rings, turn = 2.0 * pi * j / sectors;
      const Vector3d direction(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                               std::cos(polar));
      mesh.vertices.push_back(radius_of(polar, turn) * direction);
      mesh.normals.push_back(direction);
    }
  const auto at = [&](int i, int j) { return i * sectors + j % sectors; };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      if (i > 0) mesh.faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i < rings - 1) mesh.faces.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  // All vertices at a pole are the same place, to the bit.
  for (int j = 1; j < sectors; ++j) {
    mesh.vertices[static_cast<std::size_t>(at(0, j))] = mesh.vertices[0];
    mesh.vertices[static_cast<std::size_t>(at(rings, j))] =
        mesh.vertices[static_cast<std::size_t>(at(rings, 0))];
  }
  return mesh;
}

}  // namespace

rig::RigCalibration SampleRig() {
  auto lens = calib::CameraModel::FromString(
      "{ 'lensmodel': 'LENSMODEL_OPENCV8', 'intrinsics': [ 2000, 2000, 639.5, 479.5, -0.1, 0.05, "
      "0.001, -0.0005, 0, 0, 0, 0 ], 'extrinsics': [ 0, 0, 0, 0, 0, 0 ], 'imagersize': [ 1280, "
      "960 ] }",
      "sample");
  rig::RigCalibration rig(*lens);
  rig.geometry.X_WC = calib::LookAtOrigin(0.3, DegToRad(35.0), 400.0);
  rig.geometry.X_WA = calib::Turn(Vector3d(1.0, 2.0, 0.0).normalized(), DegToRad(1.5));
  rig.geometry.X_WA.translation = Vector3d(0.8, -0.5, -1.0);
  rig.geometry.angle_scale = 1.001;
  rig.geometry.angle_offset_deg = 12.0;
  rig.devices.resolution = {1280, 960};
  return rig;
}

calib::MeshShape Lump() {
  return Star(48, 72, [](double polar, double turn) {
    return 35.0 + 5.0 * std::sin(polar) * std::cos(turn) +
           4.0 * std::sin(2.0 * polar) * std::sin(turn + 0.5) +
           3.0 * std::sin(polar) * std::sin(polar) * std::cos(3.0 * turn);
  });
}

calib::MeshShape Vase() {
  return Star(48, 96, [](double polar, double) {
    return 30.0 + 6.0 * std::cos(2.0 * polar) + 3.0 * std::cos(polar);
  });
}

calib::Pose RandomPlace(const RandomStream& random, double lean_deg) {
  const double lean_to = random.Uniform(0, 0.0, 2.0 * pi);
  calib::Pose place = calib::Turn({std::cos(lean_to), std::sin(lean_to), 0.0},
                                  DegToRad(random.Uniform(1, 0.0, lean_deg))) *
                      calib::Turn(Vector3d::UnitZ(), random.Uniform(2, 0.0, 2.0 * pi));
  place.translation = {random.Uniform(3, -15.0, 15.0), random.Uniform(4, -15.0, 15.0),
                       random.Uniform(5, -5.0, 5.0)};
  return place;
}

std::vector<View> Outlines(const rig::RigCalibration& rig, const calib::TargetShape& shape,
                           const calib::Pose& X_AT, const std::vector<double>& angles_deg,
                           const OutlineNoise& noise, std::uint64_t seed) {
  std::vector<View> views;
  for (std::size_t v = 0; v < angles_deg.size(); ++v) {
    const RandomStream random(seed, v);
    const double true_deg = angles_deg[v] + noise.angle_sigma_deg * random.Normal(1u << 30);
    View view{angles_deg[v], "frame " + std::to_string(v),
              SampleOutline(rig, shape, X_AT, true_deg, 1.0)};
    double last = random.Normal(0);
    for (std::size_t i = 0; i < view.outline.size(); ++i) {
      last = noise.correlation * last +
             std::sqrt(1.0 - noise.correlation * noise.correlation) * random.Normal(i + 1);
      view.outline[i].pixel += noise.sigma * last * view.outline[i].normal;
    }
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<PickedPoint> Pick(const rig::RigCalibration& rig, const calib::MeshShape& mesh,
                              const calib::Pose& X_AT, double sigma, std::uint64_t seed) {
  std::vector<PickedPoint> picked;
  const RandomStream random(seed, 1u << 20);
  for (std::size_t i = 0; i < 5; ++i) {
    calib::TurntableGeometry geometry = rig.geometry;
    geometry.X_AT = X_AT;
    const calib::RigPoses poses = calib::PosesAt(geometry, 0.0);
    const Eigen::Vector3d p_T = mesh.vertices[(701 * i + 300) % mesh.vertices.size()];
    const Eigen::Vector2d pixel = rig.lens.Project({poses.X_WC.Inverse() * (poses.X_WT * p_T)})[0];
    picked.push_back(
        {0, pixel + sigma * Eigen::Vector2d(random.Normal(2 * i), random.Normal(2 * i + 1)), p_T,
         "points.csv:" + std::to_string(i + 1)});
  }
  return picked;
}

std::vector<double> Revolution(int views) {
  std::vector<double> angles;
  for (int i = 0; i < views; ++i) angles.push_back(360.0 * i / views);
  return angles;
}

Eigen::Matrix<double, 6, 1> ErrorOf(const calib::Pose& estimate, const calib::Pose& truth) {
  const Eigen::AngleAxisd turn(truth.rotation * estimate.rotation.transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << turn.angle() * turn.axis(), truth.translation - estimate.translation;
  return error;
}

}  // namespace turnlight::calib::calibrate::placement
