#include "rig/session/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;
using Sides = std::span<const EdgeTable::Side>;

constexpr double kMaxOpen = 0.05;  // of a closed piece's area
// Volume over area^1.5: 0.094 for a ball, 0 for a sheet.
constexpr double kMinVolume = 1e-6;

class PieceFinder {
 public:
  PieceFinder(const TriangleMesh& mesh, const EdgeTable& edges) : mesh_(mesh), edges_(edges) {
    const std::size_t faces = mesh.triangles.size();
    piece_.assign(faces, -1);
    out_.faces.reserve(faces);
    out_.turned.assign(faces, 0);
    neighbour_.assign(3 * faces, -1);
  }

  MeshPieces Run() {
    edges_.ForEachEdge([&](Sides sides) {
      if (sides.size() != 2) return;
      neighbour_[static_cast<std::size_t>(sides[0].index)] = sides[1].index;
      neighbour_[static_cast<std::size_t>(sides[1].index)] = sides[0].index;
    });
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
      if (piece_[f] < 0) Spread(static_cast<int>(f));
    centers_.assign(out_.pieces.size(), Vector3d::Zero());
    edges_.ForEachEdge([&](Sides sides) {
      if (sides.size() != 2) AddBorders(sides);
    });
    for (std::size_t p = 0; p < out_.pieces.size(); ++p) Measure(p);
    return std::move(out_);
  }

 private:
  // The corner that a side leaves, or goes to.
  int PlaceOf(int side, int step) const {
    const auto& corner = mesh_.triangles[static_cast<std::size_t>(side / 3)]
                                        [static_cast<std::size_t>((side % 3 + step) % 3)];
    return mesh_.place[static_cast<std::size_t>(corner.vertex)];
  }
  const Vector3d& PointOf(int face, std::size_t slot) const {
    const auto& corner = mesh_.triangles[static_cast<std::size_t>(face)][slot];
    return mesh_.vertices[static_cast<std::size_t>(corner.vertex)];
  }

  // A new piece, from its first face on.
  void Spread(int first) {
    const int number = static_cast<int>(out_.pieces.size());
    MeshPiece& piece = out_.pieces.emplace_back();
    piece.begin = out_.faces.size();
    out_.faces.push_back(first);
    piece_[static_cast<std::size_t>(first)] = number;
    for (std::size_t i = piece.begin; i < out_.faces.size(); ++i) {
      const int face = out_.faces[i];
      for (int side = 3 * face; side < 3 * face + 3; ++side) {
        const int other = neighbour_[static_cast<std::size_t>(side)];
        if (other < 0) continue;
        // Two faces are wound alike if they run along their edge in opposite ways.
        const bool alike = PlaceOf(side, 0) == PlaceOf(other, 1);
        const auto turned =
            static_cast<std::int8_t>(out_.turned[static_cast<std::size_t>(face)] ^ (alike ? 0 : 1));
        const auto next = static_cast<std::size_t>(other / 3);
        if (piece_[next] < 0) {
          piece_[next] = number;
          out_.turned[next] = turned;
          out_.faces.push_back(other / 3);
        } else if (out_.turned[next] != turned) {
          piece.orientable = false;
        }
      }
    }
    piece.end = out_.faces.size();
  }

  // An edge of one, three or more faces is open for those pieces whose faces do not cancel there.
  void AddBorders(Sides sides) {
    std::vector<std::pair<int, int>> runs;  // a piece, and whether it runs up or down the edge
    for (const EdgeTable::Side& side : sides) {
      const auto face = static_cast<std::size_t>(side.face());
      const bool up = (PlaceOf(side.index, 1) == side.other) != (out_.turned[face] == 1);
      runs.emplace_back(piece_[face], up ? 1 : -1);
    }
    std::sort(runs.begin(), runs.end());
    const int face = sides[0].face();
    const auto slot = static_cast<std::size_t>(sides[0].slot());
    const Vector3d& a = PointOf(face, slot);
    const Vector3d& b = PointOf(face, (slot + 1) % 3);
    const double length = (b - a).norm();
    for (auto it = runs.begin(); it != runs.end();) {
      const auto number = static_cast<std::size_t>(it->first);
      int sum = 0;
      for (; it != runs.end() && static_cast<std::size_t>(it->first) == number; ++it)
        sum += it->second;
      if (sum == 0) continue;
      out_.pieces[number].border += length;
      centers_[number] += length * 0.5 * (a + b);
    }
  }

  // Volumes are about the middle of the border: a flat cap on it then adds nothing.
  void Measure(std::size_t number) {
    MeshPiece& piece = out_.pieces[number];
    const Vector3d middle = piece.border > 0.0 ? Vector3d(centers_[number] / piece.border)
                                               : PointOf(out_.faces[piece.begin], 0);
    for (std::size_t i = piece.begin; i < piece.end; ++i) {
      const int face = out_.faces[i];
      const Vector3d a = PointOf(face, 0) - middle, b = PointOf(face, 1) - middle,
                     c = PointOf(face, 2) - middle;
      const double area = 0.5 * (b - a).cross(c - a).norm();
      const bool turned = out_.turned[static_cast<std::size_t>(face)] == 1;
      piece.area += area;
      piece.turned_area += turned ? area : 0.0;
      piece.volume += (turned ? -1.0 : 1.0) * a.dot(b.cross(c)) / 6.0;
      for (std::size_t k = 0; k < 3; ++k) piece.box.extend(PointOf(face, k));
    }
  }

  const TriangleMesh& mesh_;
  const EdgeTable& edges_;
  std::vector<int> piece_;      // by face
  std::vector<int> neighbour_;  // by side: the other side of its edge
  std::vector<Vector3d> centers_;
  MeshPieces out_;
};

}  // namespace

bool MeshPiece::IsClosed() const {
  // No hole of this border has more area.
  const double open = border * border / (4.0 * std::numbers::pi);
  return orientable && open <= kMaxOpen * area &&
         std::abs(volume) > kMinVolume * std::pow(area, 1.5);
}

MeshPieces FindPieces(const TriangleMesh& mesh, const EdgeTable& edges) {
  return PieceFinder(mesh, edges).Run();
}

// The sum of the solid angles: van Oosterom and Strackee, "The Solid Angle of a Plane Triangle"
// (1983).
bool IsInside(const TriangleMesh& mesh, const MeshPieces& pieces, const MeshPiece& piece,
              const Vector3d& point) {
  double sum = 0.0;
  for (std::size_t i = piece.begin; i < piece.end; ++i) {
    const auto face = static_cast<std::size_t>(pieces.faces[i]);
    const auto& t = mesh.triangles[face];
    const Vector3d a = mesh.vertices[static_cast<std::size_t>(t[0].vertex)] - point;
    const Vector3d b = mesh.vertices[static_cast<std::size_t>(t[1].vertex)] - point;
    const Vector3d c = mesh.vertices[static_cast<std::size_t>(t[2].vertex)] - point;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    const double angle =
        2.0 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + a.dot(c) * y + b.dot(c) * x);
    sum += pieces.turned[face] == 1 ? -angle : angle;
  }
  return std::abs(sum) > 2.0 * std::numbers::pi;
}

}  // namespace turnlight::rig
