// The pieces of a mesh that hang together by edges of two faces. Internal to this folder.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rig/session/mesh_edges.h"
#include "rig/session/mesh_repair.h"

namespace turnlight::rig {

struct MeshPiece {
  std::size_t begin = 0, end = 0;  // its faces are those of MeshPieces::faces from begin on
  bool orientable = true;          // false: like a Moebius strip
  double area = 0.0;
  double turned_area = 0.0;  // of the faces that are against the first
  double border = 0.0;       // length of what is open
  double volume = 0.0;       // signed, as the first face is wound; capped flat where it is open
  Eigen::AlignedBox3d box;

  std::size_t size() const { return end - begin; }
  // Closed but for holes that are small beside it, and not flat.
  bool IsClosed() const;
};

struct MeshPieces {
  std::vector<MeshPiece> pieces;
  std::vector<int> faces;           // of one piece after another
  std::vector<std::int8_t> turned;  // by face: 1 if it is wound against the first of its piece

  std::span<const int> FacesOf(const MeshPiece& piece) const {
    return {faces.data() + piece.begin, piece.size()};
  }
};

// Of triangles that are all different.
MeshPieces FindPieces(const TriangleMesh& mesh, const EdgeTable& edges);

// Whether a point lies within a closed piece, however it is wound.
bool IsInside(const TriangleMesh& mesh, const MeshPieces& pieces, const MeshPiece& piece,
              const Eigen::Vector3d& point);

}  // namespace turnlight::rig
