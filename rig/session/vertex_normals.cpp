#include "rig/session/vertex_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "base/angles.h"
#include "rig/session/mesh_edges.h"

namespace turnlight::rig {
namespace {

constexpr double kCreaseDeg = 30.0;
// So that a crease of exactly 30 degrees does not hang on the last bit.
constexpr double kCosineSlack = 1e-9;

struct Corner {
  int face = 0;
  int slot = 0;  // 0, 1 or 2
};

// The smallest member of i's group. parent[i] <= i always.
std::size_t Root(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

class Smoother {
 public:
  Smoother(std::vector<Eigen::Vector3d> vertices, std::vector<Eigen::Vector3i> faces)
      : place_(Weld(vertices)), shape_{std::move(vertices), {}, std::move(faces)} {
    face_normals_.reserve(shape_.faces.size());
    for (const Eigen::Vector3i& face : shape_.faces)
      face_normals_.push_back(UnitAlong(FaceAreaVector(shape_.vertices, face)));
  }

  calib::MeshShape Run() {
    shape_.normals.assign(shape_.vertices.size(), Eigen::Vector3d::UnitZ());
    // The corners at each place, in the order of their faces: those of place p begin at start[p].
    std::vector<std::size_t> start(shape_.vertices.size() + 2, 0);
    const auto for_each_corner = [&](const auto& visit) {
      for (std::size_t f = 0; f < shape_.faces.size(); ++f)
        for (int slot = 0; slot < 3 && !face_normals_[f].isZero(); ++slot)
          visit(static_cast<std::size_t>(place_[VertexOf(f, slot)]),
                Corner{static_cast<int>(f), slot});
    };
    for_each_corner([&](std::size_t place, const Corner&) { ++start[place + 2]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Corner> corners(start.back());
    for_each_corner(
        [&](std::size_t place, const Corner& corner) { corners[start[place + 1]++] = corner; });
    for (std::size_t place = 0; place + 2 < start.size(); ++place)
      Smooth({corners.data() + start[place], start[place + 1] - start[place]});
    return std::move(shape_);
  }

 private:
  std::size_t VertexOf(std::size_t face, int slot) const {
    return static_cast<std::size_t>(shape_.faces[face][slot % 3]);
  }
  const Eigen::Vector3d& NormalOf(const Corner& corner) const {
    return face_normals_[static_cast<std::size_t>(corner.face)];
  }

  // Groups of corners that share a normal, as the smallest index of each one's group.
  const std::vector<std::size_t>& Groups(std::span<const Corner> corners) {
    std::vector<std::pair<int, std::size_t>>& edges = edges_;
    edges.clear();
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (const int next : {1, 2})
        edges.emplace_back(
            place_[VertexOf(static_cast<std::size_t>(corners[i].face), corners[i].slot + next)], i);
    std::sort(edges.begin(), edges.end());
    std::vector<std::size_t>& parent = parent_;
    parent.resize(corners.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const double cosine = std::cos(DegToRad(kCreaseDeg)) - kCosineSlack;
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
      while (end < edges.size() && edges[end].first == edges[i].first) ++end;
      if (end - i != 2) continue;
      const std::size_t first = edges[i].second;
      const std::size_t second = edges[i + 1].second;
      if (NormalOf(corners[first]).dot(NormalOf(corners[second])) < cosine) continue;
      const auto [low, high] = std::minmax({Root(parent, first), Root(parent, second)});
      parent[high] = low;
    }
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = Root(parent, i);
    return parent;
  }

  double AngleAt(const Corner& corner) const {
    const auto f = static_cast<std::size_t>(corner.face);
    const Eigen::Vector3d& here = PointOf(f, corner.slot);
    const Eigen::Vector3d a = PointOf(f, corner.slot + 1) - here;
    const Eigen::Vector3d b = PointOf(f, corner.slot + 2) - here;
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  const Eigen::Vector3d& PointOf(std::size_t face, int slot) const {
    return shape_.vertices[VertexOf(face, slot)];
  }

  // Gives the corners at one place their normals, splitting vertices.
  void Smooth(std::span<const Corner> corners) {
    if (corners.empty()) return;
    const std::vector<std::size_t>& group = Groups(corners);
    sums_.assign(corners.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < corners.size(); ++i)
      sums_[group[i]] += AngleAt(corners[i]) * NormalOf(corners[i]);
    const int first = IndexAt(corners[0]);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](const Corner& c) { return IndexAt(c) == first; }) &&
        std::all_of(group.begin(), group.end(), [](std::size_t g) { return g == 0; })) {
      shape_.normals[static_cast<std::size_t>(first)] = MeanOf(0, corners[0]);
      return;
    }
    std::map<std::pair<int, std::size_t>, int> indices;  // (vertex, group) -> index
    std::map<int, bool> taken;                           // vertices whose first group is named
    for (std::size_t i = 0; i < corners.size(); ++i) {
      int& vertex = IndexAt(corners[i]);
      const auto [entry, is_new] = indices.try_emplace({vertex, group[i]}, vertex);
      if (is_new) {
        if (!taken.try_emplace(vertex, true).second) entry->second = Split(vertex);
        shape_.normals[static_cast<std::size_t>(entry->second)] = MeanOf(group[i], corners[i]);
      }
      vertex = entry->second;
    }
  }

  int& IndexAt(const Corner& corner) {
    return shape_.faces[static_cast<std::size_t>(corner.face)][corner.slot];
  }
  // A ring of faces can turn all the way round; any normal of it then serves as well.
  Eigen::Vector3d MeanOf(std::size_t group, const Corner& corner) const {
    const Eigen::Vector3d normal = UnitAlong(sums_[group]);
    return normal.isZero() ? NormalOf(corner) : normal;
  }

  int Split(int vertex) {
    const Eigen::Vector3d position = shape_.vertices[static_cast<std::size_t>(vertex)];
    shape_.vertices.push_back(position);
    shape_.normals.push_back(Eigen::Vector3d::UnitZ());
    place_.push_back(place_[static_cast<std::size_t>(vertex)]);
    return static_cast<int>(shape_.vertices.size()) - 1;
  }

  std::vector<int> place_;
  calib::MeshShape shape_;
  std::vector<Eigen::Vector3d> face_normals_;  // unit; zero for a face without area
  // Of the place at hand:
  std::vector<std::pair<int, std::size_t>> edges_;  // the place at the other end, the corner
  std::vector<std::size_t> parent_;
  std::vector<Eigen::Vector3d> sums_;
};

}  // namespace

Eigen::Vector3d UnitAlong(const Eigen::Vector3d& v) {
  constexpr double kHardlyNormal = 1e-290;
  const double largest = v.cwiseAbs().maxCoeff();
  // Its length would be rounded as coarsely as it is.
  if (largest > 0.0 && largest < kHardlyNormal) return (v / largest).normalized();
  return v.stableNormalized();
}

Eigen::Vector3d FaceAreaVector(const std::vector<Eigen::Vector3d>& vertices,
                               const Eigen::Vector3i& face) {
  const Eigen::Vector3d& a = vertices[static_cast<std::size_t>(face[0])];
  const Eigen::Vector3d& b = vertices[static_cast<std::size_t>(face[1])];
  const Eigen::Vector3d& c = vertices[static_cast<std::size_t>(face[2])];
  return (b - a).cross(c - a);
}

calib::MeshShape WithVertexNormals(std::vector<Eigen::Vector3d> vertices,
                                   std::vector<Eigen::Vector3i> faces) {
  return Smoother(std::move(vertices), std::move(faces)).Run();
}

}  // namespace turnlight::rig
