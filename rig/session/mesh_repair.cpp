#include "rig/session/mesh_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "base/format.h"
#include "rig/session/mesh_edges.h"
#include "rig/session/triangulate.h"
#include "rig/session/vertex_normals.h"

namespace turnlight::rig {
namespace {

using FaceCorner = PolygonMesh::Corner;

// Squares of this still fit in the float that rays are traced in.
constexpr double kMaxCoordinate = 1e18;
constexpr double kMaxHoles = 0.01;  // of the faces

bool IsUsable(const Eigen::Vector3d& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxCoordinate;
}

const Eigen::Vector3d& At(const std::vector<Eigen::Vector3d>& vertices, const FaceCorner& corner) {
  return vertices[static_cast<std::size_t>(corner.vertex)];
}

// A face that is left out.
struct BadFace {
  std::size_t face = 0;
  bool has_area = false;
};

// Cuts the faces of a mesh one by one.
class FaceCutter {
 public:
  FaceCutter(const PolygonMesh& mesh, const std::vector<int>& place) : mesh_(mesh), place_(place) {
    usable_.reserve(mesh.vertices.size());
    for (const Eigen::Vector3d& vertex : mesh.vertices) usable_.push_back(IsUsable(vertex));
    triangles_.reserve(mesh.ends.size());
  }

  void Cut() {
    std::size_t start = 0;
    for (std::size_t f = 0; f < mesh_.ends.size(); start = mesh_.ends[f++]) {
      corners_.assign(mesh_.corners.begin() + static_cast<std::ptrdiff_t>(start),
                      mesh_.corners.begin() + static_cast<std::ptrdiff_t>(mesh_.ends[f]));
      Cut(f);
    }
  }

  const std::vector<BadFace>& bad() const { return bad_; }
  const std::string& why_first() const { return why_first_; }  // what is wrong with the first
  std::vector<TriangleMesh::Triangle> TakeTriangles() { return std::move(triangles_); }
  const std::vector<TriangleMesh::Triangle>& triangles() const { return triangles_; }
  int PlaceOf(const FaceCorner& corner) const {
    return place_[static_cast<std::size_t>(corner.vertex)];
  }
  // Whether it names a vertex that can be used.
  bool Names(const FaceCorner& corner) const {
    return corner.vertex >= 0 && static_cast<std::size_t>(corner.vertex) < usable_.size() &&
           usable_[static_cast<std::size_t>(corner.vertex)];
  }

 private:
  void Cut(std::size_t face) {
    for (const FaceCorner& corner : corners_)
      if (!Names(corner)) return LeaveOut(face, bad_.empty() ? WhyUnnamed(corner) : "", true);
    DropRepeated();
    if (corners_.size() < 3)
      return LeaveOut(face, "has corners at fewer than 3 places, and no area", false);
    if (corners_.size() == 3) {
      triangles_.push_back({corners_[0], corners_[1], corners_[2]});
      return;
    }
    // Begun at the same place, copies of a face that are wound differently are cut alike.
    std::rotate(corners_.begin(),
                std::min_element(corners_.begin(), corners_.end(),
                                 [&](const FaceCorner& a, const FaceCorner& b) {
                                   return PlaceOf(a) < PlaceOf(b);
                                 }),
                corners_.end());
    points_.clear();
    for (const FaceCorner& corner : corners_) points_.push_back(At(mesh_.vertices, corner));
    const auto parts = Triangulate(points_);
    if (parts.empty())
      return LeaveOut(face,
                      "crosses itself, has no area, or is not convex and has more than 256 corners",
                      true);
    for (const auto& part : parts) {
      const TriangleMesh::Triangle triangle{corners_[static_cast<std::size_t>(part[0])],
                                            corners_[static_cast<std::size_t>(part[1])],
                                            corners_[static_cast<std::size_t>(part[2])]};
      const Places at{PlaceOf(triangle[0]), PlaceOf(triangle[1]), PlaceOf(triangle[2])};
      if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0]) triangles_.push_back(triangle);
    }
  }

  // Corners at the same place in a row are one corner.
  void DropRepeated() {
    const auto same = [&](const FaceCorner& a, const FaceCorner& b) {
      return PlaceOf(a) == PlaceOf(b);
    };
    corners_.erase(std::unique(corners_.begin(), corners_.end(), same), corners_.end());
    while (corners_.size() > 1 && same(corners_.front(), corners_.back())) corners_.pop_back();
  }

  std::string WhyUnnamed(const FaceCorner& corner) const {
    const std::string vertex = "names vertex " + std::to_string(corner.vertex);
    if (corner.vertex >= 0 && static_cast<std::size_t>(corner.vertex) < usable_.size())
      return vertex +
             ", whose coordinates are not finite or too large, allowed are finite numbers" +
             " of at most 1e18";
    return vertex + ", allowed are 0 to " +
           std::to_string(static_cast<std::int64_t>(usable_.size()) - 1) + ", counted from 0";
  }

  void LeaveOut(std::size_t face, std::string why, bool has_area) {
    if (bad_.empty()) why_first_ = std::move(why);
    bad_.push_back({face, has_area});
  }

  const PolygonMesh& mesh_;
  const std::vector<int>& place_;
  std::vector<bool> usable_;  // by vertex
  std::vector<FaceCorner> corners_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<TriangleMesh::Triangle> triangles_;
  std::vector<BadFace> bad_;
  std::string why_first_;
};

// How many of the faces left out close what is open without them.
std::size_t CountHoles(const PolygonMesh& mesh, const std::vector<int>& place,
                       const FaceCutter& cutter) {
  const auto& bad = cutter.bad();
  if (std::none_of(bad.begin(), bad.end(), [](const BadFace& b) { return b.has_area; })) return 0;
  const EdgeTable edges = EdgesOf(cutter.triangles(), place);
  std::size_t holes = 0;
  for (const BadFace& face : bad) {
    const std::size_t begin = face.face > 0 ? mesh.ends[face.face - 1] : 0;
    const std::size_t end = mesh.ends[face.face];
    bool hole = false;
    for (std::size_t i = begin; i < end && face.has_area && !hole; ++i) {
      const FaceCorner& a = mesh.corners[i];
      const FaceCorner& b = mesh.corners[i + 1 < end ? i + 1 : begin];
      hole = cutter.Names(a) && cutter.Names(b) && cutter.PlaceOf(a) != cutter.PlaceOf(b) &&
             edges.Between(cutter.PlaceOf(a), cutter.PlaceOf(b)).size() % 2 == 1;
    }
    holes += hole ? 1 : 0;
  }
  return holes;
}

// Normals that are none are as if they were not there.
void DropBadNormals(PolygonMesh& mesh) {
  std::vector<bool> good;
  good.reserve(mesh.normals.size());
  for (const Eigen::Vector3d& normal : mesh.normals)
    good.push_back(IsUsable(normal) && !normal.stableNormalized().isZero());
  for (FaceCorner& corner : mesh.corners)
    if (corner.normal < 0 || static_cast<std::size_t>(corner.normal) >= good.size() ||
        !good[static_cast<std::size_t>(corner.normal)])
      corner.normal = -1;
}

}  // namespace

EdgeTable EdgesOf(const std::vector<TriangleMesh::Triangle>& triangles,
                  const std::vector<int>& place) {
  std::vector<Places> places;
  places.reserve(triangles.size());
  for (const TriangleMesh::Triangle& t : triangles)
    places.push_back({place[static_cast<std::size_t>(t[0].vertex)],
                      place[static_cast<std::size_t>(t[1].vertex)],
                      place[static_cast<std::size_t>(t[2].vertex)]});
  return EdgeTable(places, place.size());
}

Result<TriangleMesh> UsableTriangles(PolygonMesh mesh, const std::string& file,
                                     std::vector<std::string>& remarks) {
  const std::size_t faces = mesh.ends.size();
  if (faces == 0) return InputError(file + ": the mesh has no faces, allowed is 1 or more");
  DropBadNormals(mesh);
  TriangleMesh out;
  out.place = Weld(mesh.vertices);
  FaceCutter cutter(mesh, out.place);
  cutter.Cut();
  if (const auto& bad = cutter.bad(); !bad.empty()) {
    const std::string first =
        "; the first: face " + std::to_string(bad.front().face) + " " + cutter.why_first();
    if (cutter.triangles().empty())
      return InputError(file + ": none of " + Counted(faces, "face") + " can be used" + first);
    const std::size_t holes = CountHoles(mesh, out.place, cutter);
    if (static_cast<double>(holes) > kMaxHoles * static_cast<double>(faces))
      return InputError(file + ": " + std::to_string(holes) + " of " + std::to_string(faces) +
                        " faces cannot be used and leave holes, allowed are at most 1 %" + first);
    remarks.push_back(file + ": " + std::to_string(bad.size()) + " of " + std::to_string(faces) +
                      " faces cannot be used and were left out, " +
                      (holes == 0 ? std::string("which leaves no hole")
                                  : "of which " + std::to_string(holes) + " leave a hole") +
                      first);
  }
  out.triangles = cutter.TakeTriangles();
  out.vertices = std::move(mesh.vertices);
  out.normals = std::move(mesh.normals);
  return out;
}

Status RemoveUnused(TriangleMesh& mesh, const std::string& file,
                    std::vector<std::string>& remarks) {
  const std::size_t flat = std::erase_if(mesh.triangles, [&](const TriangleMesh::Triangle& t) {
    return AreaVectorOf(mesh, t).isZero(0.0);
  });
  if (mesh.triangles.empty()) return InputError(file + ": no face of the mesh has an area");
  if (flat > 0)
    remarks.push_back(file + ": " + Counted(flat, "triangle") + " without area " +
                      (flat == 1 ? "was" : "were") + " left out, which leaves no hole");
  std::vector<std::int32_t> kept(mesh.vertices.size(), -1);
  for (const TriangleMesh::Triangle& t : mesh.triangles)
    for (const FaceCorner& corner : t) kept[static_cast<std::size_t>(corner.vertex)] = 0;
  const auto stray = std::count(kept.begin(), kept.end(), -1);
  if (stray == 0) return {};
  std::int32_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] < 0) continue;
    kept[i] = count;
    mesh.vertices[static_cast<std::size_t>(count++)] = mesh.vertices[i];
  }
  mesh.vertices.resize(static_cast<std::size_t>(count));
  for (TriangleMesh::Triangle& t : mesh.triangles)
    for (FaceCorner& corner : t) corner.vertex = kept[static_cast<std::size_t>(corner.vertex)];
  remarks.push_back(file + ": " + std::to_string(stray) +
                    (stray == 1 ? " vertex that no face names was left out"
                                : " vertices that no face names were left out"));
  return {};
}

Eigen::Vector3d AreaVectorOf(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle) {
  return FaceAreaVector(mesh.vertices,
                        {static_cast<int>(triangle[0].vertex), static_cast<int>(triangle[1].vertex),
                         static_cast<int>(triangle[2].vertex)});
}

}  // namespace turnlight::rig
