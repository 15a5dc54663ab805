// Polygons into triangles. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace turnlight::rig {

// Positions in the list of a simple polygon's corners (3 or more, nearly flat, either winding
// kept), three a triangle: a fan from corner 0 where that covers the polygon, otherwise ear
// clipping, which takes time with the cube of the corners. Empty if the polygon crosses itself.
std::vector<std::array<int, 3>> Triangulate(const std::vector<Eigen::Vector3d>& corners);

}  // namespace turnlight::rig
