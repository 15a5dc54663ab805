#include "rig/session/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <unordered_map>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "rig/session/mesh_formats.h"
#include "rig/session/mesh_repair.h"
#include "rig/session/mesh_winding.h"
#include "rig/session/vertex_normals.h"

namespace turnlight::rig {
namespace {

constexpr std::size_t kMaxFaces = std::size_t{1} << 26;

Status CheckSize(const PolygonMesh& mesh, const std::string& file) {
  if (mesh.ends.size() <= kMaxFaces && mesh.corners.size() <= 3 * kMaxFaces &&
      mesh.vertices.size() <= 3 * kMaxFaces)
    return {};
  return InputError(file + ": the mesh has " + std::to_string(mesh.ends.size()) + " faces and " +
                    std::to_string(mesh.vertices.size()) + " vertices, allowed are at most " +
                    std::to_string(kMaxFaces) + " triangles");
}

std::vector<Eigen::Vector3i> FacesOf(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3i> faces;
  faces.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) faces.emplace_back(t[0].vertex, t[1].vertex, t[2].vertex);
  return faces;
}

// Corners without a normal get one of the faces around them.
void MakeMissingNormals(TriangleMesh& mesh) {
  const calib::MeshShape made = WithVertexNormals(mesh.vertices, FacesOf(mesh));
  const auto first = static_cast<std::int32_t>(mesh.normals.size());
  mesh.normals.insert(mesh.normals.end(), made.normals.begin(), made.normals.end());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      auto& corner = mesh.triangles[f][static_cast<std::size_t>(k)];
      if (corner.normal < 0) corner.normal = first + made.faces[f][k];
    }
}

// Vertices keep their index with the first normal that a face gives them; copies with further
// normals are appended.
calib::MeshShape WithCornerNormals(TriangleMesh mesh) {
  calib::MeshShape shape{std::move(mesh.vertices), {}, {}};
  shape.normals.assign(shape.vertices.size(), Eigen::Vector3d::UnitZ());
  shape.faces.reserve(mesh.triangles.size());
  std::vector<std::int32_t> first(shape.vertices.size(), -1);
  std::unordered_map<std::uint64_t, int> copies;  // by vertex and normal
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    Eigen::Vector3i& face = shape.faces.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto& corner = triangle[static_cast<std::size_t>(k)];
      const auto vertex = static_cast<std::size_t>(corner.vertex);
      face[k] = corner.vertex;
      if (first[vertex] == corner.normal) continue;
      const Eigen::Vector3d normal =
          UnitAlong(mesh.normals[static_cast<std::size_t>(corner.normal)]);
      if (first[vertex] < 0) {
        first[vertex] = corner.normal;
        shape.normals[vertex] = normal;
        continue;
      }
      const std::uint64_t key = (static_cast<std::uint64_t>(corner.vertex) << 32) |
                                static_cast<std::uint32_t>(corner.normal);
      const auto [copy, is_new] = copies.try_emplace(key, static_cast<int>(shape.vertices.size()));
      face[k] = copy->second;
      if (!is_new) continue;
      const Eigen::Vector3d position = shape.vertices[vertex];
      shape.vertices.push_back(position);
      shape.normals.push_back(normal);
    }
  }
  return shape;
}

calib::MeshShape WithNormals(TriangleMesh mesh, const std::string& file,
                             std::vector<std::string>& remarks) {
  std::size_t missing = 0;
  for (const auto& triangle : mesh.triangles)
    for (const auto& corner : triangle) missing += corner.normal < 0 ? 1 : 0;
  const std::size_t corners = 3 * mesh.triangles.size();
  if (missing > 0 && !mesh.normals.empty())
    remarks.push_back(file + ": " + std::to_string(missing) + " of " + std::to_string(corners) +
                      " corners of triangles have no usable normal: it was made from the faces");
  if (missing == corners) {
    std::vector<Eigen::Vector3i> faces = FacesOf(mesh);
    calib::MeshShape shape = WithVertexNormals(std::move(mesh.vertices), std::move(faces));
    shape.normals_made = true;
    return shape;
  }
  if (missing > 0) MakeMissingNormals(mesh);
  return WithCornerNormals(std::move(mesh));
}

// Tells of a mesh so far from the origin that single precision spoils it.
void RemarkPrecision(const TriangleMesh& mesh, const std::string& file,
                     std::vector<std::string>& remarks) {
  const Extent extent = ExtentOf(mesh.vertices);
  if (!extent.CoarseInFloat()) return;
  remarks.push_back(
      file +
      turnlight::Format(
          ": the coordinates are single-precision numbers as large as %.7g: they are "
          "rounded by up to %.2g, in a mesh of the size %.3g; export it again with doubles, or "
          "moved to the origin",
          extent.far, 0.5 * extent.FloatStep(), extent.size));
}

Result<PolygonMesh> Import(const std::string& bytes, const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".ply") return ReadPly(bytes, file.string());
  if (extension == ".obj") return ReadObj(bytes, file.string());
  return InputError(file.string() + ": the extension is \"" + extension +
                    "\", allowed are .ply and .obj");
}

Result<calib::MeshShape> Parse(const std::string& bytes, const std::filesystem::path& path,
                               std::vector<std::string>& remarks) {
  const std::string file = path.string();
  auto polygons = Import(bytes, path);
  if (!polygons) return Forward(polygons);
  if (const Status status = CheckSize(*polygons, file); !status) return Forward(status);
  const bool single_precision = polygons->single_precision;
  auto mesh = UsableTriangles(std::move(*polygons), file, remarks);
  if (!mesh) return Forward(mesh);
  if (const Status status = RepairWinding(*mesh, file, remarks); !status) return Forward(status);
  if (const Status status = RemoveUnused(*mesh, file, remarks); !status) return Forward(status);
  if (single_precision) RemarkPrecision(*mesh, file, remarks);
  return WithNormals(std::move(*mesh), file, remarks);
}

}  // namespace

Result<calib::MeshShape> ParseMesh(const std::string& bytes, const std::filesystem::path& file,
                                   std::vector<std::string>* remarks) {
  std::vector<std::string> unused;
  try {
    return Parse(bytes, file, remarks ? *remarks : unused);
  } catch (const std::exception& error) {
    return InputError(file.string() + ": damaged mesh: " + error.what());
  }
}

Result<calib::MeshShape> ReadMesh(const std::filesystem::path& path,
                                  std::vector<std::string>* remarks) {
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return ParseMesh(*bytes, path, remarks);
}

}  // namespace turnlight::rig
