#include "rig/session/mesh_winding.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rig/session/mesh_copies.h"
#include "rig/session/mesh_normals.h"
#include "rig/session/mesh_pieces.h"

namespace turnlight::rig {
namespace {

constexpr double kMostArea = 0.8;       // wound one way: the others are wrong
constexpr double kMostNormals = 0.95;   // that agree
constexpr double kMaxUncertain = 0.01;  // of the mesh's area
constexpr double kHollow = 0.02;        // volume over area^1.5 of what is clearly a hollow
// Triangles that are looked at for hollows, so that hostile meshes cannot take hours.
constexpr std::size_t kMaxInsideTests = std::size_t{1} << 26;

// What is done with the faces of a piece.
enum class Verdict { kLikeFirst, kAgainstFirst, kAsTheyAre };

class Winder {
 public:
  Winder(TriangleMesh& mesh, const MeshPieces& pieces, const ReversedCopies& reversed)
      : mesh_(mesh), pieces_(pieces), reversed_(reversed) {}

  void Run() {
    // The largest first: they matter most while there is patience for what is inside what.
    std::vector<const MeshPiece*> order;
    for (const MeshPiece& piece : pieces_.pieces) order.push_back(&piece);
    std::stable_sort(order.begin(), order.end(),
                     [](const MeshPiece* a, const MeshPiece* b) { return a->area > b->area; });
    for (const MeshPiece* piece : order) {
      total_area_ += piece->area;
      Apply(*piece, piece->IsClosed() ? OfClosed(*piece) : OfOpen(*piece));
    }
  }

  Status Check(const std::string& file) const {
    if (uncertain_area_ <= kMaxUncertain * total_area_) return {};
    return InputError(file + ": the winding of " + std::to_string(uncertain_) + All() +
                      "cannot be told: they are parts of open surfaces that are wound both ways;" +
                      " allowed are faces that are all counter-clockwise seen from outside");
  }

  void Remark(const std::string& file, std::vector<std::string>& remarks) const {
    if (turned_ > 0 && turned_ == mesh_.triangles.size())
      remarks.push_back(file + ": all " + std::to_string(turned_) +
                        " faces were wound inwards and were turned round");
    else if (turned_ > 0)
      remarks.push_back(file + ": " + std::to_string(turned_) + All() +
                        "were wound the wrong way and were turned round");
    if (one_sided_ > 0)
      remarks.push_back(file + ": " + std::to_string(one_sided_) + All() +
                        "are parts of surfaces with one side only, as a Moebius strip, whose " +
                        "winding cannot be right everywhere; it was left as it is");
    if (hollow_area_ > 0.5 * total_area_)
      remarks.push_back(file +
                        ": the mesh is open, and its winding makes the hollow side the outside; "
                        "if that is wrong, nothing of it will be seen: turn the faces round");
  }

 private:
  std::string All() const { return " of " + std::to_string(mesh_.triangles.size()) + " faces "; }

  Verdict OfClosed(const MeshPiece& piece) {
    if (piece.volume > 0.0) return Verdict::kLikeFirst;
    return piece.turned_area == 0.0 && IsHollow(piece) ? Verdict::kLikeFirst
                                                       : Verdict::kAgainstFirst;
  }

  // Whether another closed piece is around it.
  bool IsHollow(const MeshPiece& piece) {
    const auto& corner = mesh_.triangles[static_cast<std::size_t>(pieces_.faces[piece.begin])][0];
    const Eigen::Vector3d& point = mesh_.vertices[static_cast<std::size_t>(corner.vertex)];
    for (const MeshPiece& other : pieces_.pieces) {
      if (inside_tests_ >= kMaxInsideTests) return true;
      ++inside_tests_;
      if (&other == &piece || !other.box.contains(piece.box) || !other.IsClosed()) continue;
      inside_tests_ += other.size();
      if (IsInside(mesh_, pieces_, other, point)) return true;
    }
    return false;
  }

  // By the normals of the file, else by what most of it is.
  Verdict OfOpen(const MeshPiece& piece) {
    const auto refuse = [&](std::size_t& counted) {
      counted += piece.size();
      return Verdict::kAsTheyAre;
    };
    if (!piece.orientable) return refuse(one_sided_);
    double area = 0.0, turned_area = 0.0;  // of the faces that are there one way only
    std::size_t with_normals = 0, against = 0;
    for (const int f : pieces_.FacesOf(piece)) {
      const auto face = static_cast<std::size_t>(f);
      const TriangleMesh::Triangle& t = mesh_.triangles[face];
      const bool turned = pieces_.turned[face] == 1;
      const double face_area = reversed_.Has(face) ? 0.0 : 0.5 * AreaVectorOf(mesh_, t).norm();
      area += face_area;
      turned_area += turned ? face_area : 0.0;
      if (t[0].normal < 0 || t[1].normal < 0 || t[2].normal < 0) continue;
      ++with_normals;
      against += IsAgainstNormals(mesh_, t) != turned ? 1 : 0;
    }
    if (area > 0.5 * piece.area && turned_area == 0.0) return OneWay(piece);
    const auto most = kMostNormals * static_cast<double>(with_normals);
    if (2 * with_normals > piece.size()) {
      if (static_cast<double>(against) >= most) return Verdict::kAgainstFirst;
      if (static_cast<double>(with_normals - against) >= most) return Verdict::kLikeFirst;
    }
    if (area > 0.5 * piece.area && turned_area >= kMostArea * area) return Verdict::kAgainstFirst;
    if (area > 0.5 * piece.area && turned_area <= (1.0 - kMostArea) * area)
      return Verdict::kLikeFirst;
    uncertain_area_ += piece.area;
    return refuse(uncertain_);
  }

  // What was wound one way stays so.
  Verdict OneWay(const MeshPiece& piece) {
    if (piece.volume < -kHollow * std::pow(piece.area, 1.5)) hollow_area_ += piece.area;
    return Verdict::kLikeFirst;
  }

  void Apply(const MeshPiece& piece, Verdict verdict) {
    if (verdict == Verdict::kAsTheyAre) return;
    const std::int8_t wrong = verdict == Verdict::kLikeFirst ? 1 : 0;
    for (const int f : pieces_.FacesOf(piece)) {
      const auto face = static_cast<std::size_t>(f);
      if (pieces_.turned[face] != wrong) continue;
      if (reversed_.Has(face)) {
        mesh_.triangles[face] = reversed_.copies[static_cast<std::size_t>(reversed_.of[face])];
      } else {
        std::swap(mesh_.triangles[face][1], mesh_.triangles[face][2]);
        ++turned_;
      }
    }
  }

  TriangleMesh& mesh_;
  const MeshPieces& pieces_;
  const ReversedCopies& reversed_;
  double total_area_ = 0.0, uncertain_area_ = 0.0, hollow_area_ = 0.0;
  std::size_t turned_ = 0, uncertain_ = 0, one_sided_ = 0, inside_tests_ = 0;  // faces
};

}  // namespace

Status RepairWinding(TriangleMesh& mesh, const std::string& file,
                     std::vector<std::string>& remarks) {
  EdgeTable edges = EdgesOf(mesh.triangles, mesh.place);
  const ReversedCopies reversed = RemoveCopies(mesh, edges, file, remarks);
  if (edges.size() != 3 * mesh.triangles.size()) edges = EdgesOf(mesh.triangles, mesh.place);
  const MeshPieces pieces = FindPieces(mesh, edges);
  Winder winder(mesh, pieces, reversed);
  winder.Run();
  if (const Status status = winder.Check(file); !status) return status;
  winder.Remark(file, remarks);
  return MendNormals(mesh, pieces, file, remarks);
}

}  // namespace turnlight::rig
