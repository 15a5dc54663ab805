// Proves that the generated mesh lies on its closed form, is closed, has the normals of the
// surface, has hollows, and survives a file. Does not prove anything about how it is rendered.
#include "rig/sim/blob.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <utility>

#include "rig/session/mesh_file.h"

namespace turnlight::rig::sim {
namespace {

const Blob kBlob{40.0, 0.3, 64};

TEST(Blob, VerticesLieOnTheClosedForm) {
  const auto mesh = MakeBlob(kBlob, 5);
  for (const Eigen::Vector3d& p : mesh.vertices)
    EXPECT_NEAR(p.norm(), BlobRadius(kBlob, 5, p.normalized()), 1e-4);
}

TEST(Blob, NormalsAreThoseOfTheSurface) {
  const double step = 1e-6;
  const auto point = [](const Eigen::Vector3d& along) -> Eigen::Vector3d {
    const Eigen::Vector3d d = along.normalized();
    return d * BlobRadius(kBlob, 5, d);
  };
  for (const Eigen::Vector3d& d :
       {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-1, 0.1, -2), Eigen::Vector3d(0.2, -3, 0.4)}) {
    const Eigen::Vector3d unit = d.normalized();
    const Eigen::Vector3d a = unit.unitOrthogonal();
    const Eigen::Vector3d b = unit.cross(a);
    const Eigen::Vector3d du = point(unit + step * a) - point(unit - step * a);
    const Eigen::Vector3d dv = point(unit + step * b) - point(unit - step * b);
    EXPECT_NEAR((du.cross(dv).normalized() - BlobNormal(kBlob, 5, unit)).norm(), 0.0, 1e-7);
  }
}

TEST(Blob, IsClosedAndWoundOutwards) {
  const auto mesh = MakeBlob(kBlob, 5);
  std::map<std::pair<int, int>, int> edges;
  double volume = 0.0;
  for (const Eigen::Vector3i& f : mesh.faces) {
    for (int i = 0; i < 3; ++i) ++edges[{f[i], f[(i + 1) % 3]}];
    volume += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]])) / 6.0;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_GT(volume, 0.0);
  EXPECT_EQ(mesh.vertices.size() + mesh.faces.size() - edges.size() / 2, 2u);  // Euler
}

TEST(Blob, HasHollowsUnlessFlat) {
  // In a hollow a neighbour stands above the tangent plane.
  const auto hollows = [](const Blob& blob) {
    const auto mesh = MakeBlob(blob, 5);
    int count = 0;
    for (const Eigen::Vector3i& f : mesh.faces)
      count += (mesh.vertices[f[1]] - mesh.vertices[f[0]]).dot(mesh.normals[f[0]]) > 0.1;
    return count;
  };
  EXPECT_GT(hollows(kBlob), 50);
  EXPECT_EQ(hollows({40.0, 0.0, 64}), 0);
}

TEST(Blob, SeedsDiffer) {
  EXPECT_NE(MakeBlob(kBlob, 5).vertices[100], MakeBlob(kBlob, 6).vertices[100]);
}

TEST(Blob, SurvivesAFile) {
  const auto mesh = MakeBlob({40.0, 0.3, 16}, 5);
  const auto back = ParseMesh(MeshToPly(mesh), "target.ply");
  ASSERT_TRUE(back) << back.error().text;
  ASSERT_EQ(back->vertices.size(), mesh.vertices.size());
  ASSERT_EQ(back->faces.size(), mesh.faces.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_EQ(back->vertices[i], mesh.vertices[i]);
    EXPECT_NEAR((back->normals[i] - mesh.normals[i]).norm(), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace turnlight::rig::sim
