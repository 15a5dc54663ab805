// Which side of a mesh's faces is outside. Internal to this folder.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/mesh_repair.h"

namespace turnlight::rig {

// Makes the faces counter-clockwise seen from outside, as far as the mesh tells, with a remark for
// whatever was done.
//
// A piece is what hangs together by edges of two faces; corners at the same place count as one.
// - Faces that coincide are one, whichever way each is wound.
// - Within a piece the faces are wound as their neighbours are.
// - A piece that is closed, but for holes of together at most 5 % of its area, encloses a positive
//   volume; it stays as it is within another such piece, where it may be a hollow.
// - What is open and was wound both ways is wound as the file's normals say, else as most of it was
//   (four fifths of the area). Otherwise, if it is more than 1 % of the whole, this fails (kInput):
//   the sides cannot be told. What is open and was wound one way stays as it is.
// - Normals of the file that are against the winding on more than 5 % of the faces are turned
//   round, or made anew, where the piece is closed; if it is open, this fails (kInput).
Status RepairWinding(TriangleMesh& mesh, const std::string& file,
                     std::vector<std::string>& remarks);

}  // namespace turnlight::rig
