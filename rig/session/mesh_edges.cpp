#include "rig/session/mesh_edges.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <utility>

namespace turnlight::rig {
namespace {

using Bits = std::array<std::uint64_t, 3>;

// Equal for equal places and in a total order for all, whatever the numbers; -0 is 0.
Bits BitsOf(const Eigen::Vector3d& v) {
  return {std::bit_cast<std::uint64_t>(v.x() + 0.0), std::bit_cast<std::uint64_t>(v.y() + 0.0),
          std::bit_cast<std::uint64_t>(v.z() + 0.0)};
}

// The mixing step of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t Mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace

std::vector<int> Weld(const std::vector<Eigen::Vector3d>& vertices) {
  // Sorted by a hash: numbers beside each other sort much faster than places in memory do.
  std::vector<std::pair<std::uint64_t, int>> order(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Bits bits = BitsOf(vertices[i]);
    order[i] = {Mixed(bits[0] + Mixed(bits[1] + Mixed(bits[2]))), static_cast<int>(i)};
  }
  std::sort(order.begin(), order.end());
  const auto bits_of = [&](const auto& entry) {
    return BitsOf(vertices[static_cast<std::size_t>(entry.second)]);
  };
  std::vector<int> place(vertices.size());
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    while (end != order.end() && end->first == begin->first) ++end;
    if (end - begin > 1)
      std::sort(begin, end, [&](const auto& a, const auto& b) {
        const Bits x = bits_of(a), y = bits_of(b);
        return x != y ? x < y : a.second < b.second;
      });
    for (auto it = begin; it != end; ++it) {
      const bool same = it != begin && bits_of(*it) == bits_of(*(it - 1));
      place[static_cast<std::size_t>(it->second)] =
          same ? place[static_cast<std::size_t>((it - 1)->second)] : it->second;
    }
  }
  return place;
}

EdgeTable::EdgeTable(const std::vector<Places>& triangles, std::size_t places)
    : starts_(places + 2, 0), sides_(3 * triangles.size()) {
  const auto lower = [](const Places& t, std::size_t k) {
    return static_cast<std::size_t>(std::min(t[k], t[(k + 1) % 3]));
  };
  for (const Places& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++starts_[lower(t, k) + 2];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  // starts_[p + 1] runs from the start of p to its end, which is the start of p + 1.
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Places& t = triangles[f];
      sides_[starts_[lower(t, k) + 1]++] = {std::max(t[k], t[(k + 1) % 3]),
                                            static_cast<int>(3 * f + k)};
    }
  for (std::size_t p = 0; p + 1 < starts_.size(); ++p)
    std::sort(sides_.begin() + static_cast<std::ptrdiff_t>(starts_[p]),
              sides_.begin() + static_cast<std::ptrdiff_t>(starts_[p + 1]),
              [](const Side& a, const Side& b) {
                return a.other != b.other ? a.other < b.other : a.index < b.index;
              });
}

std::span<const EdgeTable::Side> EdgeTable::Between(int a, int b) const {
  const auto [low, high] = std::minmax(a, b);
  const auto begin = sides_.begin() + static_cast<std::ptrdiff_t>(starts_[low]);
  const auto end = sides_.begin() + static_cast<std::ptrdiff_t>(starts_[low + 1]);
  const auto first =
      std::lower_bound(begin, end, high, [](const Side& s, int place) { return s.other < place; });
  const auto last =
      std::upper_bound(first, end, high, [](int place, const Side& s) { return place < s.other; });
  return {first, last};
}

}  // namespace turnlight::rig
