// Triangle meshes in files: PLY and OBJ, read by a library.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"
#include "calib/target_shape.h"

namespace turnlight::rig {

// Reads a mesh; polygons are triangulated. Vertex normals of the file are normalised; without them
// they are the angle-weighted mean over the faces around, vertices being split where faces meet at
// more than 30 degrees (crease).
// Fails (kInput): no faces, an index out of range, coordinates that are not finite, more than 2^26
// faces, normals against the winding on more than 5 % of the faces.
Result<calib::MeshShape> ReadMesh(const std::filesystem::path& path);
// The same from a file's bytes; `file` names it in messages and its extension picks the format.
Result<calib::MeshShape> ParseMesh(const std::string& bytes, const std::filesystem::path& file);

}  // namespace turnlight::rig
