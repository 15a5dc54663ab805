#include "calib/calibrate/placement/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A piece bounds the picture if a ray this far outside of it, in pixels, passes the target.
constexpr double kOutside = 0.05;
constexpr int kMostPieces = 256;  // of one edge

calib::MeshShape Triangles(const calib::PlaneShape& plane) {
  const double x = 0.5 * plane.width, y = 0.5 * plane.height;
  return {{{-x, -y, 0.0}, {x, -y, 0.0}, {x, y, 0.0}, {-x, y, 0.0}},
          std::vector<Vector3d>(4, Vector3d::UnitZ()),
          {{0, 1, 2}, {0, 2, 3}}};
}

// Vertices at the same place get the same number: a crease splits them.
std::vector<int> Weld(const std::vector<Vector3d>& vertices) {
  std::map<std::array<double, 3>, int> numbers;
  std::vector<int> welded;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3d& v = vertices[i];
    welded.push_back(
        numbers.emplace(std::array{v.x(), v.y(), v.z()}, static_cast<int>(i)).first->second);
  }
  return welded;
}

}  // namespace

struct ContourFinder::Piece {
  Vector3d a, b, inside;  // inside: a corner of the face that is seen, away from the edge
};

ContourFinder::ContourFinder(const calib::TargetShape& shape) {
  if (const auto* plane = std::get_if<calib::PlaneShape>(&shape)) {
    mesh_ = Triangles(*plane);
    plane_sides_ = plane->sides;
  } else {
    mesh_ = std::get<calib::MeshShape>(shape);
    geometry_ = std::make_shared<const estimator::target::Geometry>(shape);
  }
  CollectEdges();
}

void ContourFinder::CollectEdges() {
  const std::vector<int> welded = Weld(mesh_.vertices);
  std::map<std::pair<int, int>, Edge> open;
  for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
    Eigen::Vector3i& face = mesh_.faces[f];
    for (int i = 0; i < 3; ++i) face[i] = welded[static_cast<std::size_t>(face[i])];
    const auto vertex = [&](int i) { return mesh_.vertices[static_cast<std::size_t>(face[i])]; };
    face_normals_.push_back((vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized());
    if (!face_normals_.back().allFinite()) continue;  // of no area
    for (int i = 0; i < 3; ++i) {
      const int a = face[i], b = face[(i + 1) % 3];
      const std::pair key{std::min(a, b), std::max(a, b)};
      const auto found = open.find(key);
      if (found == open.end()) {
        open.emplace(key, Edge{a, b, static_cast<int>(f), -1});
        continue;
      }
      found->second.other = static_cast<int>(f);
      edges_.push_back(found->second);
      open.erase(found);
    }
  }
  for (const auto& [key, edge] : open) edges_.push_back(edge);
}

std::vector<ContourFinder::Piece> ContourFinder::FindPieces(const Vector3d& p_TC) const {
  const auto seen = [&](int face) {
    const auto f = static_cast<std::size_t>(face);
    return face_normals_[f].dot(p_TC -
                                mesh_.vertices[static_cast<std::size_t>(mesh_.faces[f][0])]) > 0.0;
  };
  std::vector<Piece> pieces;
  for (const Edge& edge : edges_) {
    const bool first = seen(edge.face);
    if (edge.other >= 0 && first == seen(edge.other)) continue;
    const int face = first || edge.other < 0 ? edge.face : edge.other;
    const Eigen::Vector3i& corners = mesh_.faces[static_cast<std::size_t>(face)];
    int inside = corners[0];
    for (int i = 0; i < 3; ++i)
      if (corners[i] != edge.a && corners[i] != edge.b) inside = corners[i];
    const auto vertex = [&](int i) { return mesh_.vertices[static_cast<std::size_t>(i)]; };
    pieces.push_back({vertex(edge.a), vertex(edge.b), vertex(inside)});
  }
  return pieces;
}

namespace {

// Cuts what is long in the picture; leaves out what does not project.
void AddSegments(const Vector3d& a_T, const Vector3d& b_T, const Vector2d& a, const Vector2d& b,
                 const Vector2d& inside, const calib::Pose& X_CT, const calib::CameraModel& camera,
                 std::vector<Segment>& segments) {
  if (!a.allFinite() || !b.allFinite() || !inside.allFinite()) return;
  const int count = static_cast<int>(
      std::clamp(std::ceil((b - a).norm() / kLongestPiece), 1.0, 1.0 * kMostPieces));
  std::vector<Vector3d> p_T, p_C;
  for (int i = 0; i <= count; ++i) {
    p_T.push_back(a_T + (b_T - a_T) * (static_cast<double>(i) / count));
    p_C.push_back(X_CT * p_T.back());
  }
  const std::vector<Vector2d> p = count > 1 ? camera.Project(p_C) : std::vector<Vector2d>{a, b};
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const Vector2d along = p[i + 1] - p[i];
    if (!along.allFinite() || !(along.norm() > 0.0)) continue;
    Vector2d normal = Vector2d(along.y(), -along.x()).normalized();
    if (normal.dot(inside - 0.5 * (p[i] + p[i + 1])) > 0.0) normal = -normal;
    segments.push_back({p_T[i], p_T[i + 1], p[i], p[i + 1], normal});
  }
}

}  // namespace

std::vector<Segment> ContourFinder::Find(const calib::Pose& X_CT,
                                         const calib::CameraModel& camera) const {
  const calib::Pose X_TC = X_CT.Inverse();
  if (plane_sides_ == 1 && X_TC.translation.z() <= 0.0) return {};
  std::vector<Vector3d> p_C;
  const std::vector<Piece> pieces = FindPieces(X_TC.translation);
  for (const Piece& piece : pieces)
    for (const Vector3d& p_T : {piece.a, piece.b, piece.inside}) p_C.push_back(X_CT * p_T);
  const std::vector<Vector2d> p = camera.Project(p_C);
  std::vector<Segment> all;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    AddSegments(pieces[i].a, pieces[i].b, p[3 * i], p[3 * i + 1], p[3 * i + 2], X_CT, camera, all);
  if (plane_sides_ > 0) return all;
  std::vector<Vector2d> outside;
  for (const Segment& segment : all)
    outside.push_back(0.5 * (segment.a + segment.b) + kOutside * segment.normal);
  const std::vector<Vector3d> rays = camera.Unproject(outside);
  std::vector<Segment> bounding;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (rays[i].allFinite() && !geometry_->Occluded(X_TC.translation, Vector3d::Zero(),
                                                    (X_TC.rotation * rays[i]).normalized()))
      bounding.push_back(all[i]);
  return bounding;
}

}  // namespace turnlight::calib::calibrate::placement
