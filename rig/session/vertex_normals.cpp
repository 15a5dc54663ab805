#include "rig/session/vertex_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/angles.h"

namespace turnlight::rig {
namespace {

constexpr double kCreaseDeg = 30.0;
// So that a crease of exactly 30 degrees does not hang on the last bit.
constexpr double kCosineSlack = 1e-9;

struct Corner {
  int face = 0;
  int slot = 0;  // 0, 1 or 2
};

// For each vertex the lowest index of a vertex at the same place.
std::vector<int> Weld(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](int i) -> const Eigen::Vector3d& {
    return vertices[static_cast<std::size_t>(i)];
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    for (int axis = 0; axis < 3; ++axis)
      if (at(a)[axis] != at(b)[axis]) return at(a)[axis] < at(b)[axis];
    return a < b;
  });
  std::vector<int> place(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && at(order[i]) == at(order[i - 1]);
    place[static_cast<std::size_t>(order[i])] =
        same ? place[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return place;
}

// The smallest member of i's group. parent[i] <= i always.
std::size_t Root(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

class Smoother {
 public:
  Smoother(std::vector<Eigen::Vector3d> vertices, std::vector<Eigen::Vector3i> faces)
      : place_(Weld(vertices)), shape_{std::move(vertices), {}, std::move(faces)} {
    for (const Eigen::Vector3i& face : shape_.faces)
      face_normals_.push_back(FaceAreaVector(shape_.vertices, face).stableNormalized());
  }

  calib::MeshShape Run() {
    shape_.normals.assign(shape_.vertices.size(), Eigen::Vector3d::UnitZ());
    std::vector<std::vector<Corner>> around(shape_.vertices.size());
    for (std::size_t f = 0; f < shape_.faces.size(); ++f)
      for (int slot = 0; slot < 3 && !face_normals_[f].isZero(); ++slot)
        around[static_cast<std::size_t>(place_[VertexOf(f, slot)])].push_back(
            {static_cast<int>(f), slot});
    for (const std::vector<Corner>& corners : around) Smooth(corners);
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
  std::vector<std::size_t> Groups(const std::vector<Corner>& corners) const {
    std::vector<std::pair<int, std::size_t>> edges;  // the place at the other end, the corner
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (const int next : {1, 2})
        edges.emplace_back(
            place_[VertexOf(static_cast<std::size_t>(corners[i].face), corners[i].slot + next)], i);
    std::sort(edges.begin(), edges.end());
    std::vector<std::size_t> parent(corners.size());
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
  void Smooth(const std::vector<Corner>& corners) {
    const std::vector<std::size_t> group = Groups(corners);
    std::vector<Eigen::Vector3d> sums(corners.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < corners.size(); ++i)
      sums[group[i]] += AngleAt(corners[i]) * NormalOf(corners[i]);
    std::map<std::pair<int, std::size_t>, int> indices;  // (vertex, group) -> index
    std::map<int, bool> taken;                           // vertices whose first group is named
    for (std::size_t i = 0; i < corners.size(); ++i) {
      int& vertex = shape_.faces[static_cast<std::size_t>(corners[i].face)][corners[i].slot];
      const auto [entry, is_new] = indices.try_emplace({vertex, group[i]}, vertex);
      if (is_new) {
        if (!taken.try_emplace(vertex, true).second) entry->second = Split(vertex);
        Eigen::Vector3d normal = sums[group[i]].stableNormalized();
        // A ring of faces can turn all the way round; any normal of it then serves as well.
        if (normal.isZero()) normal = NormalOf(corners[i]);
        shape_.normals[static_cast<std::size_t>(entry->second)] = normal;
      }
      vertex = entry->second;
    }
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
};

}  // namespace

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
