// Which corners of a mesh are at the same place, and which faces meet at an edge. Internal to this
// folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace turnlight::rig {

// For each vertex the lowest index of a vertex at the same place.
std::vector<int> Weld(const std::vector<Eigen::Vector3d>& vertices);

// A triangle's corners as places: indices of vertices that stand for all at the same place.
using Places = std::array<int, 3>;

// The sides of triangles, sorted by the undirected edge between two places that they lie on. Takes
// time with n log n at worst.
class EdgeTable {
 public:
  struct Side {
    int other = 0;  // the larger of the edge's two places
    int index = 0;  // 3 * triangle + corner that the side leaves
    int face() const { return index / 3; }
    int slot() const { return index % 3; }
  };
  // Places are below `places`.
  EdgeTable(const std::vector<Places>& triangles, std::size_t places);

  std::size_t size() const { return sides_.size(); }
  // The sides on the edge between two places, in the order of their triangles.
  std::span<const Side> Between(int a, int b) const;

  // Calls visit(std::span<const Side>) for each edge.
  template <typename Visit>
  void ForEachEdge(const Visit& visit) const {
    for (std::size_t i = 0, end = 0, lower = 0; i < sides_.size(); i = end) {
      while (starts_[lower + 1] <= i) ++lower;
      while (end < starts_[lower + 1] && sides_[end].other == sides_[i].other) ++end;
      visit(std::span<const Side>(sides_.data() + i, end - i));
    }
  }

 private:
  std::vector<std::size_t> starts_;  // of the sides whose lower place is the index
  std::vector<Side> sides_;
};

}  // namespace turnlight::rig
