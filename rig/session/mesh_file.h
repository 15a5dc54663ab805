// Triangle meshes in files: PLY and OBJ.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/target_shape.h"

namespace turnlight::rig {

// Reads a mesh. Polygons are triangulated. Vertices keep the file's order.
//
// Of a PLY the elements vertex (x, y, z, nx, ny, nz of any type), face and tristrips (a list
// vertex_indices or vertex_index) are read, wherever they are; other elements and properties are
// stepped over. Doubles stay doubles. Of an OBJ the lines v, vn and f.
//
// Normals of the file are normalised; a vertex that has several is copied, the copies appended.
// Where a corner has none, it is the angle-weighted mean over the faces around its vertex, and
// vertices are split where faces meet at more than 30 degrees (crease): the first part keeps the
// index, the others are appended. Vertices at the same place count as one for this.
//
// Faces that cannot be used and vertices without a face are left out (mesh_repair.h), and faces are
// turned to be counter-clockwise seen from outside where that is certain (mesh_winding.h). What was
// done is appended to remarks, if that is given: texts that begin with the file.
//
// Fails (kInput): no faces, more than 1 % of faces that cannot be used and leave holes, a winding
// that cannot be told, normals against the winding of an open surface on more than 5 % of the
// faces, more than 2^26 triangles, damaged or truncated data.
Result<calib::MeshShape> ReadMesh(const std::filesystem::path& path,
                                  std::vector<std::string>* remarks = nullptr);
// The same from a file's bytes; `file` names it in messages and its extension picks the format.
Result<calib::MeshShape> ParseMesh(const std::string& bytes, const std::filesystem::path& file,
                                   std::vector<std::string>* remarks = nullptr);

}  // namespace turnlight::rig
