// What the mesh formats behind mesh_file.h deliver, one file each. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig {

// Polygons as a file holds them. Nothing is checked but what the format itself demands: numbers may
// be not finite, indices out of range, faces of any number of corners.
struct PolygonMesh {
  struct Corner {
    std::int32_t vertex = -1;
    std::int32_t normal = -1;  // -1: the file gives none
  };
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;
  std::vector<Corner> corners;    // of all faces, one face after another
  std::vector<std::size_t> ends;  // of each face: one past its last corner
  bool single_precision = false;  // the coordinates are rounded to floats
};

// An index of a file as it is kept: what is too large, or no whole number, names no vertex.
inline std::int32_t KeptIndex(double index) {
  constexpr double kMax = std::numeric_limits<std::int32_t>::max();
  if (index != std::floor(index)) return -1;
  return static_cast<std::int32_t>(std::clamp(index, -kMax, kMax));
}

Result<PolygonMesh> ReadPly(const std::string& bytes, const std::string& file);
Result<PolygonMesh> ReadObj(const std::string& bytes, const std::string& file);

// How far coordinates reach from the origin, and how far apart they are, along any axis.
struct Extent {
  double far = 0.0, size = 0.0;

  // What single precision resolves there, and whether that spoils a mesh of this size.
  double FloatStep() const { return std::numeric_limits<float>::epsilon() * far; }
  bool CoarseInFloat() const { return FloatStep() > 1e-6 * size; }
};

// Of the vertices that are finite.
inline Extent ExtentOf(const std::vector<Eigen::Vector3d>& vertices) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(HUGE_VAL), high = -low;
  for (const Eigen::Vector3d& vertex : vertices) {
    if (!vertex.allFinite()) continue;
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return {std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()), (high - low).maxCoeff()};
}

}  // namespace turnlight::rig
