// Triangle meshes in files: PLY and OBJ, read by a library.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"
#include "calib/target_shape.h"

namespace turnlight::rig {

// Reads a mesh. Polygons of up to 256 corners are triangulated. Vertices keep the file's order.
//
// Normals of the file are normalised; an OBJ vertex that has several is copied, the copies
// appended. Without normals they are the angle-weighted mean over the faces around a vertex, and
// vertices are split where faces meet at more than 30 degrees (crease): the first part keeps the
// index, the others are appended. Vertices at the same place count as one for this. A vertex
// without faces gets (0, 0, 1).
//
// Of a PLY the elements vertex (x, y, z, nx, ny, nz) and face (vertex_indices) are read, which must
// be the first two; coordinates have the precision of float. Of an OBJ the lines v, vn and f.
//
// Fails (kInput): no faces, an index out of range, coordinates or normals that are not finite or
// above 1e18, a normal of length 0, normals at some corners only, a polygon of 4 or more corners
// that cannot be cut into triangles, more than 2^26 triangles, normals against the winding on more
// than 5 % of the faces, damaged or truncated data.
Result<calib::MeshShape> ReadMesh(const std::filesystem::path& path);
// The same from a file's bytes; `file` names it in messages and its extension picks the format.
Result<calib::MeshShape> ParseMesh(const std::string& bytes, const std::filesystem::path& file);

}  // namespace turnlight::rig
