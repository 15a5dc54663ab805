// Any bytes as a .cameramodel: refused with a message, or a camera whose rays are unit vectors that
// project back to their pixels and whose text form keeps every bit and is read by mrcal.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "calib/camera_model.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib {
namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

void CheckText(const CameraModel& camera) {
  const std::string text = camera.ToString();
  const auto again = CameraModel::FromString(text, "again");
  Require(again.has_value());
  Require(again->intrinsics() == camera.intrinsics() && again->lens_model() == camera.lens_model());
  Require(again->width() == camera.width() && again->height() == camera.height());
  mrcal_cameramodel_t* read =
      mrcal_read_cameramodel_string(text.data(), static_cast<int>(text.size()));
  Require(read != nullptr);
  mrcal_free_cameramodel(&read);
}

void CheckRays(const CameraModel& camera) {
  std::vector<Eigen::Vector2d> points;
  for (const double u : {-1.0, 0.0, 0.5, 1.0})
    for (const double v : {0.0, 0.5, 1.0})
      points.emplace_back(u * camera.width(), v * camera.height());
  const auto rays = camera.Unproject(points);
  const auto back = camera.Project(rays);
  double scale = 1.0;
  for (std::size_t i = 0; i < 4; ++i) scale += std::abs(camera.intrinsics()[i]);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i].allFinite()) continue;
    Require(std::abs(rays[i].norm() - 1.0) < 1e-12);
    Require((back[i] - points[i]).norm() < 1e-6 + 1e-14 * scale);
  }
}

void CheckGrid(const CameraModel& camera) {
  if (camera.width() * static_cast<std::int64_t>(camera.height()) > 64) return;
  const RayGrid grid(camera);
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Eigen::Vector3d ray = grid.Ray(column, row, 0.25, -1.0);
      Require(!ray.allFinite() || std::abs(ray.norm() - 1.0) < 1e-12);
      grid.Differential(column, row);
    }
  }
}

}  // namespace
}  // namespace turnlight::calib

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using turnlight::calib::CameraModel;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto camera = CameraModel::FromString(text, "fuzz.cameramodel");
  if (!camera) {
    turnlight::calib::Require(camera.error().text.starts_with("fuzz.cameramodel"));
    return 0;
  }
  turnlight::calib::CheckText(*camera);
  turnlight::calib::CheckRays(*camera);
  turnlight::calib::CheckGrid(*camera);
  return 0;
}
