#include "rig/session/mesh_copies.h"

#include <algorithm>
#include <span>
#include <utility>

namespace turnlight::rig {
namespace {

using CutTriangle = TriangleMesh::Triangle;

int PlaceOf(const TriangleMesh& mesh, const CutTriangle& t, int corner) {
  return mesh.place[static_cast<std::size_t>(t[static_cast<std::size_t>(corner % 3)].vertex)];
}

// For each triangle that coincides with earlier ones the first of them, else -1. Triangles that
// coincide share every edge. Those without area tie their neighbours together and are left alone.
std::vector<int> FirstOfCopies(const TriangleMesh& mesh, const EdgeTable& edges) {
  std::vector<int> first(mesh.triangles.size(), -1);
  std::vector<std::pair<int, int>> across;  // the place across from the edge, the triangle
  edges.ForEachEdge([&](std::span<const EdgeTable::Side> sides) {
    if (sides.size() < 2) return;
    across.clear();
    for (const EdgeTable::Side& side : sides)
      across.emplace_back(
          PlaceOf(mesh, mesh.triangles[static_cast<std::size_t>(side.face())], side.slot() + 2),
          side.face());
    if (across.size() == 2 && across[0].first != across[1].first) return;
    std::sort(across.begin(), across.end());
    for (std::size_t i = 1, begin = 0; i < across.size(); ++i) {
      if (across[i].first != across[begin].first) begin = i;
      const auto copy = static_cast<std::size_t>(across[i].second);
      if (i > begin && !AreaVectorOf(mesh, mesh.triangles[copy]).isZero(0.0))
        first[copy] = across[begin].second;
    }
  });
  return first;
}

// Whether two triangles at the same places are wound differently.
bool AreOpposed(const TriangleMesh& mesh, const CutTriangle& a, const CutTriangle& b) {
  int k = 0;
  while (PlaceOf(mesh, b, k) != PlaceOf(mesh, a, 0)) ++k;
  return PlaceOf(mesh, b, k + 1) != PlaceOf(mesh, a, 1);
}

}  // namespace

ReversedCopies RemoveCopies(TriangleMesh& mesh, const EdgeTable& edges, const std::string& file,
                            std::vector<std::string>& remarks) {
  ReversedCopies reversed;
  const std::vector<int> first = FirstOfCopies(mesh, edges);
  const std::size_t all = first.size();
  if (std::all_of(first.begin(), first.end(), [](int f) { return f < 0; })) return reversed;
  std::vector<int> of(all, -1);
  for (std::size_t f = 0; f < all; ++f) {
    if (first[f] < 0) continue;
    const auto kept = static_cast<std::size_t>(first[f]);
    if (of[kept] >= 0 || !AreOpposed(mesh, mesh.triangles[kept], mesh.triangles[f])) continue;
    of[kept] = static_cast<int>(reversed.copies.size());
    reversed.copies.push_back(mesh.triangles[f]);
  }
  std::size_t count = 0;
  for (std::size_t f = 0; f < all; ++f) {
    if (first[f] >= 0) continue;
    mesh.triangles[count++] = mesh.triangles[f];
    reversed.of.push_back(of[f]);
  }
  mesh.triangles.resize(count);
  remarks.push_back(file + ": " + std::to_string(all - count) + " of " + std::to_string(all) +
                    " faces are copies of others at the same place, " +
                    std::to_string(reversed.copies.size()) +
                    " of them the other way round: one of each was kept");
  return reversed;
}

}  // namespace turnlight::rig
