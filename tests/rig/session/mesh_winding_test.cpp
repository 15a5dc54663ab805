// Proves: the winding of closed meshes is mended whatever part of it is wrong, hollows stay,
// normals follow, and what cannot be told is refused. Does not prove: that a bowl is not a dome;
// nobody can.
#include "rig/session/mesh_winding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "rig/session/mesh_file.h"
#include "tests/rig/session/mesh_polygons.h"

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Wound {
  calib::MeshShape mesh;
  std::vector<std::string> remarks;
  std::string error;
  double volume = 0.0;
};

Wound Wind(const std::string& text, const std::string& file = "a.obj") {
  Wound out;
  auto mesh = ParseMesh(text, file, &out.remarks);
  if (!mesh) {
    out.error = mesh.error().text;
    return out;
  }
  out.mesh = std::move(*mesh);
  const auto& v = out.mesh.vertices;
  for (const Eigen::Vector3i& f : out.mesh.faces)
    out.volume += v[static_cast<std::size_t>(f[0])].dot(
                      v[static_cast<std::size_t>(f[1])].cross(v[static_cast<std::size_t>(f[2])])) /
                  6.0;
  return out;
}

// The outside is found whichever faces are turned, in a soup of single triangles as well.
TEST(MeshWinding, ClosedMeshesAreMended) {
  const Polygons sphere = Sphere(9, 20);
  const double volume = Wind(Obj(sphere)).volume;
  std::mt19937 random(1);
  for (const double share : {0.01, 0.3, 0.5, 0.9, 1.0}) {
    Polygons mixed = sphere;
    for (auto& face : mixed.faces)
      if (std::uniform_real_distribution<>()(random) < share) Turn(face);
    Polygons soup;
    for (const auto& face : mixed.faces) {
      soup.faces.emplace_back();
      for (const int index : face) {
        soup.faces.back().push_back(static_cast<int>(soup.vertices.size()));
        soup.vertices.push_back(mixed.vertices[static_cast<std::size_t>(index)]);
      }
    }
    for (const Polygons& mesh : {mixed, soup}) {
      const Wound wound = Wind(Obj(mesh));
      EXPECT_NEAR(wound.volume, volume, 1e-6 * volume) << share << wound.error;
      EXPECT_THAT(wound.remarks, ElementsAre(HasSubstr("were turned round")));
    }
  }
}

TEST(MeshWinding, SmallHolesDoNotMatter) {
  Polygons sphere = Turned(Sphere(19, 40));
  sphere.faces.resize(sphere.faces.size() - 3);
  const Wound wound = Wind(Obj(sphere));
  EXPECT_GT(wound.volume, 0.0);
  EXPECT_THAT(wound.remarks, ElementsAre(HasSubstr("wound inwards")));
}

// A hollow is wound the other way; a second body beside it is not.
TEST(MeshWinding, HollowsStay) {
  const Polygons hollow = Turned(Cube({1, 2, 3}, 2.0));
  const Wound inside = Wind(Obj(Both(Cube(), hollow)));
  EXPECT_NEAR(inside.volume, 8000.0 - 64.0, 1e-6);
  EXPECT_THAT(inside.remarks, IsEmpty());
  const Wound beside = Wind(Obj(Both(Cube(), Turned(Cube({100, 0, 0}, 2.0)))));
  EXPECT_NEAR(beside.volume, 8000.0 + 64.0, 1e-6);
  EXPECT_THAT(beside.remarks, ElementsAre(HasSubstr("12 of 24 faces")));
}

TEST(MeshWinding, CopiesAreLeftOut) {
  for (const Polygons& cube : {Cube(), Turned(Cube())}) {
    Polygons doubled = cube;
    doubled.faces.insert(doubled.faces.end(), cube.faces.begin(), cube.faces.end());
    const Polygons separate = Both(cube, Turned(cube));
    for (const Polygons& mesh : {doubled, separate}) {
      const Wound wound = Wind(Obj(mesh));
      EXPECT_EQ(wound.mesh.faces.size(), 12u);
      EXPECT_NEAR(wound.volume, 8000.0, 1e-6);
      EXPECT_THAT(wound.remarks, Contains(HasSubstr("12 of 24 faces are copies")));
    }
  }
  const Polygons sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}}, {}};
  EXPECT_THAT(Wind(Obj(sheet)).error, HasSubstr("winding of 1 of 1 faces cannot be told"));
}

// The upper half of a sphere, open below.
Polygons Dome() {
  Polygons dome = Sphere(9, 20);
  std::erase_if(dome.faces, [&](const std::vector<int>& face) {
    return dome.vertices[static_cast<std::size_t>(face[2])].z() < -1.0 || face[0] == 1 ||
           dome.vertices[static_cast<std::size_t>(face[0])].z() < -1.0;
  });
  return dome;
}

TEST(MeshWinding, OpenSurfaces) {
  EXPECT_THAT(Wind(Obj(Dome())).remarks, ElementsAre(HasSubstr("vertices that no face names")));
  EXPECT_THAT(Wind(Obj(Turned(Dome()))).remarks, Contains(HasSubstr("winding makes the hollow")));
  Polygons few = Dome();
  for (std::size_t i = 0; i < few.faces.size(); i += 10) Turn(few.faces[i]);
  const Wound mended = Wind(Obj(few));
  EXPECT_GT(mended.volume, 0.0);
  EXPECT_THAT(mended.remarks, Contains(HasSubstr("wound the wrong way")));
  Polygons half = Dome();
  for (std::size_t i = 0; i < half.faces.size(); i += 2) Turn(half.faces[i]);
  EXPECT_THAT(Wind(Obj(half)).error, AllOf(HasSubstr("winding"), HasSubstr("cannot be told")));
  for (const Vector3d& v : half.vertices) half.normals.push_back(v);
  EXPECT_GT(Wind(Obj(half)).volume, 0.0);
}

TEST(MeshWinding, NormalsOfTheFile) {
  Polygons sphere = Sphere(9, 20);
  for (const Vector3d& v : sphere.vertices) sphere.normals.push_back(-v);
  for (const Polygons& mesh : {sphere, Turned(sphere)}) {
    const Wound wound = Wind(Obj(mesh));
    EXPECT_GT(wound.volume, 0.0) << wound.error;
    EXPECT_THAT(wound.remarks, Contains(HasSubstr("360 of 360 faces pointed inwards")));
    for (std::size_t i = 0; i < wound.mesh.vertices.size(); ++i)
      EXPECT_GT(wound.mesh.normals[i].dot(wound.mesh.vertices[i]), 49.9);
  }
  for (std::size_t i = 0; i < sphere.normals.size(); i += 2) sphere.normals[i] *= -1.0;
  EXPECT_THAT(Wind(Obj(sphere)).remarks, ElementsAre(HasSubstr("contradict their closed surface"),
                                                     HasSubstr("no usable normal")));
  Polygons dome = Dome();
  for (const Vector3d& v : dome.vertices) dome.normals.push_back(-v);
  EXPECT_THAT(Wind(Obj(dome), "in.obj").error,
              AllOf(HasSubstr("in.obj"), HasSubstr("against their winding"), HasSubstr("5 %")));
}

// Neither hangs, nor is it told wrongly.
TEST(MeshWinding, OneSidedAndManyOnAnEdge) {
  Polygons strip;
  for (int i = 0; i < 20; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 20.0;
    const Vector3d out(std::cos(a), std::sin(a), 0.0);
    const Vector3d across = 3.0 * (std::cos(a / 2) * out + std::sin(a / 2) * Vector3d::UnitZ());
    strip.vertices.insert(strip.vertices.end(), {10.0 * out - across, 10.0 * out + across});
    if (i < 19) strip.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  }
  strip.faces.push_back({38, 1, 0, 39});
  EXPECT_THAT(Wind(Obj(strip)).remarks, ElementsAre(HasSubstr("one side only")));
  Polygons book{{{0, 0, 0}, {0, 0, 1}}, {}, {}};
  for (int i = 0; i < 50; ++i) {
    book.vertices.emplace_back(std::cos(0.1 * i), std::sin(0.1 * i), 0.0);
    book.faces.push_back({0, 1, i + 2});
  }
  EXPECT_EQ(Wind(Obj(book)).mesh.faces.size(), 50u);
}

}  // namespace
}  // namespace turnlight::rig
