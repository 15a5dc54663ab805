// From what a mesh file says to triangles that can be used, with a remark for whatever was done.
// Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/mesh_edges.h"
#include "rig/session/mesh_formats.h"

namespace turnlight::rig {

// Triangles whose corners name vertices with usable coordinates; normals are of length above 0, and
// a corner names one or none (-1). The corners of a triangle are at three places, though till
// RemoveUnused it may have no area.
struct TriangleMesh {
  using Triangle = std::array<PolygonMesh::Corner, 3>;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;
  std::vector<Triangle> triangles;
  // For each vertex the lowest index of one at the same place; good until RemoveUnused.
  std::vector<int> place;
};

// Cuts the faces into triangles and leaves out those that cannot be used: with fewer than 3
// corners, naming a vertex that is not there or not finite (or above 1e18), crossing themselves, or
// without area. Left out whatever their number are those that leave no hole: that have no area, or
// whose edges all have another face on their other side besides, so that the surface is whole
// without them. Fails (kInput) if those that leave a hole are more than 1 % of the faces, or no
// face is left.
Result<TriangleMesh> UsableTriangles(PolygonMesh mesh, const std::string& file,
                                     std::vector<std::string>& remarks);

// Takes out the triangles without area, which till then tie their neighbours together, and the
// vertices that no triangle names. Fails (kInput) if no triangle is left.
Status RemoveUnused(TriangleMesh& mesh, const std::string& file, std::vector<std::string>& remarks);

// Which triangles meet at an edge, by the places of their corners.
EdgeTable EdgesOf(const std::vector<TriangleMesh::Triangle>& triangles,
                  const std::vector<int>& place);

// Twice the area of a triangle, along its normal.
Eigen::Vector3d AreaVectorOf(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle);

}  // namespace turnlight::rig
