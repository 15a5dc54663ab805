#include "estimator/facets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace turnlight::estimator {
namespace {

constexpr double kFlat = 1e-4;        // radians that a facet turns, of rounding
constexpr double kLeastCurved = 0.1;  // of the area

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

double FacetTurn(const calib::MeshShape& mesh) {
  std::vector<std::pair<double, double>> turns;  // and area
  double area = 0.0, curved = 0.0;
  for (const Eigen::Vector3i& face : mesh.faces) {
    const auto a = static_cast<std::size_t>(face[0]), b = static_cast<std::size_t>(face[1]),
               c = static_cast<std::size_t>(face[2]);
    const double facet =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    const double turn =
        std::max({Angle(mesh.normals[a], mesh.normals[b]), Angle(mesh.normals[b], mesh.normals[c]),
                  Angle(mesh.normals[c], mesh.normals[a])});
    area += facet;
    if (turn <= kFlat) continue;
    curved += facet;
    turns.emplace_back(turn, facet);
  }
  if (curved <= kLeastCurved * area) return 0.0;
  std::sort(turns.begin(), turns.end());
  double below = 0.0;
  for (const auto& [turn, facet] : turns)
    if ((below += facet) >= 0.5 * curved) return turn;
  return turns.back().first;
}

}  // namespace turnlight::estimator
