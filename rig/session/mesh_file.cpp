#include "rig/session/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <map>
#include <utility>
#include <vector>

#include "base/file.h"
#include "rig/session/mesh_formats.h"
#include "rig/session/triangulate.h"
#include "rig/session/vertex_normals.h"

namespace turnlight::rig {
namespace {

constexpr std::size_t kMaxFaces = std::size_t{1} << 26;
constexpr std::size_t kMaxPolygonCorners = 256;
// Squares of this still fit in the float that rays are traced in.
constexpr double kMaxCoordinate = 1e18;
constexpr double kMaxAgainstWinding = 0.05;

using Corner = PolygonMesh::Corner;
using Triangle = std::array<Corner, 3>;

bool IsUsable(const Eigen::Vector3d& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxCoordinate;
}

Status CheckNumbers(const PolygonMesh& mesh, const std::string& file) {
  const std::string allowed = ", allowed are finite numbers of at most 1e18";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!IsUsable(mesh.vertices[i]))
      return InputError(file + ": the coordinates of vertex " + std::to_string(i) +
                        " are not finite or too large" + allowed);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i)
    if (!IsUsable(mesh.normals[i]))
      return InputError(file + ": normal " + std::to_string(i) + " is not finite or too large" +
                        allowed);
  return {};
}

Status CheckCorners(const PolygonMesh& mesh, const std::string& file) {
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  const auto normals = static_cast<std::int64_t>(mesh.normals.size());
  std::size_t start = 0;
  for (std::size_t f = 0; f < mesh.ends.size(); start = mesh.ends[f++]) {
    const std::string where = file + ": face " + std::to_string(f);
    const std::size_t count = mesh.ends[f] - start;
    if (count < 3 || count > kMaxPolygonCorners)
      return InputError(where + " has " + std::to_string(count) + " corners, allowed are 3 to " +
                        std::to_string(kMaxPolygonCorners));
    for (std::size_t i = start; i < mesh.ends[f]; ++i) {
      const Corner& corner = mesh.corners[i];
      if (corner.vertex < 0 || corner.vertex >= vertices)
        return InputError(where + " names vertex " + std::to_string(corner.vertex) +
                          ", allowed are 0 to " + std::to_string(vertices - 1) +
                          ", counted from 0");
      if (corner.normal < -1 || corner.normal >= normals)
        return InputError(where + " names normal " + std::to_string(corner.normal) +
                          ", allowed are 0 to " + std::to_string(normals - 1) + ", counted from 0");
      if ((corner.normal < 0) != (mesh.corners[0].normal < 0))
        return InputError(where +
                          ": some corners have a normal and others have none, allowed is a" +
                          " normal at all corners or at none");
    }
  }
  return {};
}

Status Check(const PolygonMesh& mesh, const std::string& file) {
  if (mesh.ends.empty()) return InputError(file + ": the mesh has no faces, allowed is 1 or more");
  const std::size_t triangles = mesh.corners.size() - 2 * mesh.ends.size();
  if (mesh.ends.size() > kMaxFaces || triangles > kMaxFaces || mesh.vertices.size() > 3 * kMaxFaces)
    return InputError(file + ": the mesh has " + std::to_string(mesh.ends.size()) + " faces and " +
                      std::to_string(mesh.vertices.size()) + " vertices, allowed are at most " +
                      std::to_string(kMaxFaces) + " triangles");
  if (const Status status = CheckNumbers(mesh, file); !status) return status;
  return CheckCorners(mesh, file);
}

Result<std::vector<Triangle>> TrianglesOf(const PolygonMesh& mesh, const std::string& file) {
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector3d> corners;
  std::size_t start = 0;
  for (std::size_t f = 0; f < mesh.ends.size(); start = mesh.ends[f++]) {
    corners.clear();
    for (std::size_t i = start; i < mesh.ends[f]; ++i)
      corners.push_back(mesh.vertices[static_cast<std::size_t>(mesh.corners[i].vertex)]);
    const auto parts = Triangulate(corners);
    if (parts.empty())
      return InputError(file + ": face " + std::to_string(f) +
                        " has no area or crosses itself, allowed are simple polygons");
    for (const auto& part : parts) {
      const auto corner = [&](int k) {
        return mesh.corners[start + static_cast<std::size_t>(part[static_cast<std::size_t>(k)])];
      };
      triangles.push_back({corner(0), corner(1), corner(2)});
    }
  }
  return triangles;
}

// Vertices keep their index with the first normal that a face gives them; copies with further
// normals are appended.
Result<calib::MeshShape> WithFileNormals(PolygonMesh mesh, const std::vector<Triangle>& triangles,
                                         const std::string& file) {
  calib::MeshShape shape{std::move(mesh.vertices), {}, {}};
  shape.normals.assign(shape.vertices.size(), Eigen::Vector3d::UnitZ());
  std::vector<std::int64_t> first(shape.vertices.size(), -1);
  std::map<std::pair<std::int64_t, std::int64_t>, int> copies;
  for (const Triangle& triangle : triangles) {
    Eigen::Vector3i& face = shape.faces.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Corner& corner = triangle[static_cast<std::size_t>(k)];
      const auto vertex = static_cast<std::size_t>(corner.vertex);
      const Eigen::Vector3d normal =
          mesh.normals[static_cast<std::size_t>(corner.normal)].stableNormalized();
      if (normal.isZero())
        return InputError(file + ": normal " + std::to_string(corner.normal) +
                          " has length 0, allowed are directions");
      face[k] = static_cast<int>(vertex);
      if (first[vertex] < 0) {
        first[vertex] = corner.normal;
        shape.normals[vertex] = normal;
      } else if (first[vertex] != corner.normal) {
        const auto [copy, is_new] = copies.try_emplace({corner.vertex, corner.normal},
                                                       static_cast<int>(shape.vertices.size()));
        face[k] = copy->second;
        if (!is_new) continue;
        const Eigen::Vector3d position = shape.vertices[vertex];
        shape.vertices.push_back(position);
        shape.normals.push_back(normal);
      }
    }
  }
  return shape;
}

Status CheckWinding(const calib::MeshShape& shape, const std::string& file) {
  std::size_t against = 0;
  for (const Eigen::Vector3i& face : shape.faces) {
    const Eigen::Vector3d mean = shape.normals[static_cast<std::size_t>(face[0])] +
                                 shape.normals[static_cast<std::size_t>(face[1])] +
                                 shape.normals[static_cast<std::size_t>(face[2])];
    if (FaceAreaVector(shape.vertices, face).dot(mean) < 0.0) ++against;
  }
  const double share = static_cast<double>(against) / static_cast<double>(shape.faces.size());
  if (share > kMaxAgainstWinding)
    return InputError(
        file + ": " + std::to_string(against) + " of " + std::to_string(shape.faces.size()) +
        " faces have normals against their winding, allowed are at most 5 %; turn the" +
        " faces, so that they are counter-clockwise seen from outside, or the normals");
  return {};
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

Result<calib::MeshShape> Parse(const std::string& bytes, const std::filesystem::path& file) {
  auto mesh = Import(bytes, file);
  if (!mesh) return Forward(mesh);
  if (const Status status = Check(*mesh, file.string()); !status) return Forward(status);
  const auto triangles = TrianglesOf(*mesh, file.string());
  if (!triangles) return Forward(triangles);
  if (mesh->corners[0].normal >= 0) {
    auto shape = WithFileNormals(std::move(*mesh), *triangles, file.string());
    if (!shape) return shape;
    const Status status = CheckWinding(*shape, file.string());
    return status ? std::move(shape) : Result<calib::MeshShape>(Forward(status));
  }
  std::vector<Eigen::Vector3i> faces;
  for (const Triangle& t : *triangles)
    faces.emplace_back(static_cast<int>(t[0].vertex), static_cast<int>(t[1].vertex),
                       static_cast<int>(t[2].vertex));
  return WithVertexNormals(std::move(mesh->vertices), std::move(faces));
}

}  // namespace

Result<calib::MeshShape> ParseMesh(const std::string& bytes, const std::filesystem::path& file) {
  try {
    return Parse(bytes, file);
  } catch (const std::exception& error) {
    return InputError(file.string() + ": damaged mesh: " + error.what());
  }
}

Result<calib::MeshShape> ReadMesh(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return ParseMesh(*bytes, path);
}

}  // namespace turnlight::rig
