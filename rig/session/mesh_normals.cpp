#include "rig/session/mesh_normals.h"

#include <algorithm>
#include <cstdint>

#include "rig/session/vertex_normals.h"

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;

constexpr double kMaxAgainst = 0.05;  // of the faces
constexpr double kNearlyAll = 0.95;

// Turns normals round, each once however many corners name it.
class NormalTurner {
 public:
  explicit NormalTurner(TriangleMesh& mesh) : mesh_(mesh), turned_(mesh.normals.size(), -1) {}

  void Turn(PolygonMesh::Corner& corner) {
    if (corner.normal < 0) return;
    std::int32_t& turned = turned_[static_cast<std::size_t>(corner.normal)];
    if (turned < 0) {
      turned = static_cast<std::int32_t>(mesh_.normals.size());
      const Vector3d normal = -mesh_.normals[static_cast<std::size_t>(corner.normal)];
      mesh_.normals.push_back(normal);
    }
    corner.normal = turned;
  }

 private:
  TriangleMesh& mesh_;
  std::vector<std::int32_t> turned_;
};

}  // namespace

bool IsAgainstNormals(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle) {
  Vector3d sum = Vector3d::Zero();
  for (const PolygonMesh::Corner& corner : triangle) {
    if (corner.normal < 0) return false;
    sum += UnitAlong(mesh.normals[static_cast<std::size_t>(corner.normal)]);
  }
  return AreaVectorOf(mesh, triangle).dot(sum) < 0.0;
}

Status MendNormals(TriangleMesh& mesh, const MeshPieces& pieces, const std::string& file,
                   std::vector<std::string>& remarks) {
  if (mesh.normals.empty()) return {};
  std::vector<bool> against;
  against.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) against.push_back(IsAgainstNormals(mesh, t));
  const auto all = static_cast<double>(mesh.triangles.size());
  const auto total = static_cast<double>(std::count(against.begin(), against.end(), true));
  if (total <= kMaxAgainst * all) return {};
  NormalTurner turner(mesh);
  std::size_t turned = 0, dropped = 0, open = 0;
  for (const MeshPiece& piece : pieces.pieces) {
    const auto faces = pieces.FacesOf(piece);
    const auto count = static_cast<std::size_t>(std::count_if(
        faces.begin(), faces.end(), [&](int f) { return against[static_cast<std::size_t>(f)]; }));
    const double share = static_cast<double>(count) / static_cast<double>(piece.size());
    if (share <= kMaxAgainst || !piece.IsClosed()) {
      open += count;
      continue;
    }
    const bool turn = share >= kNearlyAll;
    (turn ? turned : dropped) += piece.size();
    for (const int face : faces)
      for (PolygonMesh::Corner& corner : mesh.triangles[static_cast<std::size_t>(face)]) {
        if (turn)
          turner.Turn(corner);
        else
          corner.normal = -1;
      }
  }
  const std::string of_all = " of " + std::to_string(mesh.triangles.size()) + " faces ";
  if (static_cast<double>(open) > kMaxAgainst * all)
    return InputError(
        file + ": " + std::to_string(open) + of_all +
        "have normals against their winding, allowed are at most 5 %; turn the" +
        " faces, so that they are counter-clockwise seen from outside, or the normals");
  if (turned > 0)
    remarks.push_back(file + ": the normals of " + std::to_string(turned) + of_all +
                      "pointed inwards and were turned round");
  if (dropped > 0)
    remarks.push_back(file + ": the normals of " + std::to_string(dropped) + of_all +
                      "contradict their closed surface and were made anew");
  return {};
}

}  // namespace turnlight::rig
