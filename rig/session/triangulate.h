// Polygons into triangles. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace turnlight::rig {

// Triangles that cover a simple, nearly flat polygon of 3 or more corners, as positions in the list
// of corners, with the polygon's winding: a fan from corner 0 where that covers it, otherwise ear
// clipping, which takes time with the cube of the corners and is for polygons of up to 256. Empty
// if there are none: the polygon has no area, crosses itself, or has too many corners.
std::vector<std::array<int, 3>> Triangulate(const std::vector<Eigen::Vector3d>& corners);

}  // namespace turnlight::rig
