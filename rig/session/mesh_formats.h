// What the mesh formats behind mesh_file.h deliver, one file each. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig {

// Polygons as a file holds them. Nothing is checked but what the format itself demands.
struct PolygonMesh {
  struct Corner {
    std::int64_t vertex = -1;
    std::int64_t normal = -1;  // -1: the file gives none
  };
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;
  std::vector<Corner> corners;    // of all faces, one face after another
  std::vector<std::size_t> ends;  // of each face: one past its last corner
};

Result<PolygonMesh> ReadPly(const std::string& bytes, const std::string& file);
Result<PolygonMesh> ReadObj(const std::string& bytes, const std::string& file);

}  // namespace turnlight::rig
