// Faces of a mesh that coincide. Internal to this folder.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rig/session/mesh_repair.h"

namespace turnlight::rig {

// Where faces were there once more and wound the other way, that copy; empty if there are none.
struct ReversedCopies {
  std::vector<int> of;  // by triangle: an index into copies, or -1
  std::vector<TriangleMesh::Triangle> copies;

  bool Has(std::size_t triangle) const { return !of.empty() && of[triangle] >= 0; }
};

// Keeps the first of triangles that have their corners at the same places, with a remark.
ReversedCopies RemoveCopies(TriangleMesh& mesh, const EdgeTable& edges, const std::string& file,
                            std::vector<std::string>& remarks);

}  // namespace turnlight::rig
