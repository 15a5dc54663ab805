// The first byte says what the rest is: '0' a PLY, '1' an OBJ. Refused with a message that names
// the file, or a mesh whose indices, normals and coordinates are sound, with remarks that name the
// file and hold nothing that a terminal would obey.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/printable.h"
#include "rig/session/mesh_file.h"

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string file = data[0] % 2 == 0 ? "fuzz.ply" : "fuzz.obj";
  std::vector<std::string> remarks;
  const auto mesh = turnlight::rig::ParseMesh({reinterpret_cast<const char*>(data) + 1, size - 1},
                                              file, &remarks);
  if (!mesh) remarks.push_back(mesh.error().text);
  for (const std::string& text : remarks)
    Require(text.starts_with(file) && turnlight::Printable(text) == text);
  if (!mesh) return 0;
  Require(!mesh->faces.empty() && mesh->normals.size() == mesh->vertices.size());
  std::vector<bool> named(mesh->vertices.size());
  for (const Eigen::Vector3i& face : mesh->faces) {
    Require(face.minCoeff() >= 0 && face.maxCoeff() < static_cast<int>(mesh->vertices.size()));
    for (const int vertex : face) named[static_cast<std::size_t>(vertex)] = true;
  }
  Require(std::find(named.begin(), named.end(), false) == named.end());
  for (const Eigen::Vector3d& vertex : mesh->vertices) Require(vertex.allFinite());
  for (const Eigen::Vector3d& normal : mesh->normals)
    Require(std::abs(normal.norm() - 1.0) < 1e-12);
  return 0;
}
