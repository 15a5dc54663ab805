// Proves: faces that cannot be used and vertices without a face are left out and counted, and
// refused where they leave more holes than allowed. Does not prove: that no other fault is in
// files.
#include "rig/session/mesh_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig/session/mesh_file.h"
#include "tests/rig/session/mesh_polygons.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Mended {
  std::size_t triangles = 0, vertices = 0;
  std::vector<std::string> remarks;
  std::string error;
};

Mended Mend(const Polygons& mesh) {
  Mended out;
  const auto read = ParseMesh(Obj(mesh), "a.obj", &out.remarks);
  if (read) {
    out.triangles = read->faces.size();
    out.vertices = read->vertices.size();
  } else {
    out.error = read.error().text;
  }
  return out;
}

TEST(MeshRepair, CleanMeshesAreLeftAlone) {
  const Mended sphere = Mend(Sphere(9, 20));
  EXPECT_EQ(sphere.triangles, 360u);
  EXPECT_THAT(sphere.remarks, IsEmpty());
}

// Whatever their number: no ray goes through where they were.
TEST(MeshRepair, FacesThatLeaveNoHole) {
  Polygons cube = Cube();
  cube.vertices.insert(cube.vertices.end(), {{0, 0, std::nan("")}, {0, 0, 1e19}, {-10, -10, 0}});
  cube.faces.insert(cube.faces.end(), {{0, 1},        // too few
                                       {0, 2, 1, 3},  // crosses itself
                                       {0, 1, 99},    // not there
                                       {0, 1, -1},    // not there either
                                       {0, 1, 8},     // not finite
                                       {0, 1, 9},     // too large
                                       {0, 0, 1},     // no area
                                       {0, 1, 1, 0, 0}});
  const Mended mended = Mend(cube);
  EXPECT_EQ(mended.triangles, 12u) << mended.error;
  EXPECT_THAT(mended.remarks,
              ElementsAre(AllOf(HasSubstr("a.obj: 8 of 14 faces"), HasSubstr("leaves no hole"),
                                HasSubstr("face 6 has corners at fewer than 3 places")),
                          HasSubstr("3 vertices that no face names were left out")));
}

TEST(MeshRepair, HolesAreRefusedAboveOnePercent) {
  Polygons cube = Cube();
  cube.faces[2][1] = 8;
  EXPECT_THAT(Mend(cube).error, AllOf(HasSubstr("1 of 6 faces"), HasSubstr("at most 1 %"),
                                      HasSubstr("face 2 names vertex 8"), HasSubstr("0 to 7")));
  cube = Cube();
  cube.vertices[5].y() = std::nan("");
  EXPECT_THAT(Mend(cube).error,
              AllOf(HasSubstr("3 of 6 faces"), HasSubstr("vertex 5"), HasSubstr("not finite")));
  Polygons sphere = Sphere(19, 40);  // 800 faces
  sphere.faces[5] = {0, 1, 5000};
  EXPECT_THAT(Mend(sphere).error, IsEmpty());
  sphere = Sphere(19, 40);
  sphere.vertices[100].x() = std::nan("");
  const Mended mended = Mend(sphere);
  EXPECT_EQ(mended.triangles, 2u * 18 * 40 + 80 - 8) << mended.error;
  EXPECT_THAT(mended.remarks[0], HasSubstr("of which 4 leave a hole"));
}

TEST(MeshRepair, NothingLeftIsRefused) {
  EXPECT_THAT(Mend({Cube().vertices, {{0, 1}, {1, 0}}, {}}).error,
              AllOf(HasSubstr("none of 2 faces can be used"), HasSubstr("face 0 has")));
  EXPECT_THAT(Mend({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, {}}).error,
              HasSubstr("no face of the mesh has an area"));
  EXPECT_THAT(Mend({{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}, {}}).error,
              HasSubstr("face 0 crosses itself"));
}

// A corner in the middle of a side, a corner named twice, and a triangle that only ties the sides
// together: the surface is whole.
TEST(MeshRepair, TiesAreNoHoles) {
  Polygons cube = Cube();
  cube.vertices.emplace_back(0, -10, -10);  // on the edge of 0 and 1
  cube.faces[0] = {0, 2, 3, 1, 8, 8};
  cube.faces.push_back({0, 8, 1});
  const Mended mended = Mend(Turned(cube));
  EXPECT_EQ(mended.error, "");
  EXPECT_THAT(mended.remarks,
              ElementsAre(HasSubstr("12 of 14 faces were wound the wrong way"),
                          HasSubstr("2 triangles without area"), HasSubstr("1 vertex")));
}

TEST(MeshRepair, NormalsThatAreNone) {
  Polygons cube = Cube();
  cube.normals.assign(8, Eigen::Vector3d::Zero());
  EXPECT_THAT(Mend(cube).remarks, ElementsAre(HasSubstr("36 of 36 corners")));
  for (std::size_t i = 0; i < 8; ++i) cube.normals[i] = cube.vertices[i];
  cube.normals[3].x() = std::nan("");
  const Mended mended = Mend(cube);
  EXPECT_THAT(mended.remarks, ElementsAre(HasSubstr("of 36 corners")));
  EXPECT_EQ(mended.triangles, 12u) << mended.error;
}

}  // namespace
}  // namespace turnlight::rig
