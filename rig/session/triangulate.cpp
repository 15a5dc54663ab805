#include "rig/session/triangulate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace turnlight::rig {
namespace {

using Triangle = std::array<int, 3>;

constexpr std::size_t kMaxClipped = 256;  // corners

// Newell's normal: twice the area, along the normal.
Eigen::Vector3d AreaVector(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  return sum;
}

// Signed area along the polygon's normal.
double Turn(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal, int a,
            int b, int c) {
  const Eigen::Vector3d& origin = corners[static_cast<std::size_t>(a)];
  return (corners[static_cast<std::size_t>(b)] - origin)
      .cross(corners[static_cast<std::size_t>(c)] - origin)
      .dot(normal);
}

// Whether two sides that are not neighbours cross, as seen along the normal.
bool CrossesItself(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal) {
  const int count = static_cast<int>(corners.size());
  const auto apart = [&](int a, int b, int c, int d) {
    const double left = Turn(corners, normal, a, b, c), right = Turn(corners, normal, a, b, d);
    return (left > 0.0 && right < 0.0) || (left < 0.0 && right > 0.0);
  };
  for (int a = 0; a < count; ++a)
    for (int c = a + 2; c < count; ++c) {
      const int b = a + 1, d = (c + 1) % count;
      if (d != a && apart(a, b, c, d) && apart(c, d, a, b)) return true;
    }
  return false;
}

// Whether the corner at `at` of the remaining ring can be cut off: it turns inwards and no other
// corner lies in its triangle.
bool IsEar(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal,
           const std::vector<int>& ring, const Triangle& ear) {
  const int a = ear[0], b = ear[1], c = ear[2];  // clang 14 captures no structured bindings
  if (Turn(corners, normal, a, b, c) <= 0.0) return false;
  return std::none_of(ring.begin(), ring.end(), [&](int p) {
    return p != a && p != b && p != c && Turn(corners, normal, a, b, p) >= 0.0 &&
           Turn(corners, normal, b, c, p) >= 0.0 && Turn(corners, normal, c, a, p) >= 0.0;
  });
}

std::vector<Triangle> ClipEars(const std::vector<Eigen::Vector3d>& corners,
                               const Eigen::Vector3d& normal) {
  std::vector<Triangle> triangles;
  std::vector<int> ring(corners.size());
  std::iota(ring.begin(), ring.end(), 0);
  while (ring.size() > 3) {
    bool cut = false;
    for (std::size_t i = 0; i < ring.size() && !cut; ++i) {
      const Triangle ear{ring[(i + ring.size() - 1) % ring.size()], ring[i],
                         ring[(i + 1) % ring.size()]};
      cut = IsEar(corners, normal, ring, ear);
      if (!cut) continue;
      triangles.push_back(ear);
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (!cut) return {};
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

}  // namespace

std::vector<Triangle> Triangulate(const std::vector<Eigen::Vector3d>& corners) {
  const Eigen::Vector3d normal = AreaVector(corners);
  std::vector<Triangle> fan;
  bool covers = true;
  for (int i = 1; i + 1 < static_cast<int>(corners.size()); ++i) {
    fan.push_back({0, i, i + 1});
    const double turn = Turn(corners, normal, 0, i, i + 1);
    // A turn of exactly 0 is a triangle without area, unless the halves of a bow tie cancelled.
    covers = covers && (turn > 0.0 || (turn == 0.0 && !normal.isZero(0.0)) || corners.size() == 3);
  }
  if (covers) return fan;
  if (normal.isZero(0.0) || corners.size() > kMaxClipped || CrossesItself(corners, normal))
    return {};
  return ClipEars(corners, normal);
}

}  // namespace turnlight::rig
