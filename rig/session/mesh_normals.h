// A file's normals against the winding of its faces. Internal to this folder.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/mesh_pieces.h"

namespace turnlight::rig {

// Whether a triangle's normals point to the side from which it is seen clockwise. Without a normal
// at each corner it is false.
bool IsAgainstNormals(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle);

// Where normals are against the winding on more than 5 % of the faces: those of a closed piece,
// whose winding is certain, are turned round if nearly all are (95 %), else left to be made anew,
// with a remark. Fails (kInput) if they are against it on pieces that are open.
Status MendNormals(TriangleMesh& mesh, const MeshPieces& pieces, const std::string& file,
                   std::vector<std::string>& remarks);

}  // namespace turnlight::rig
