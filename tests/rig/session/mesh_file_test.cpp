// Proves: PLY (text, binary of both byte orders) and OBJ give the same mesh; normals, creases and
// splitting follow the closed form; every damaged file is refused with the reason.
// Does not prove: that other programs' dialects are read (mesh_cases_test.cpp has some), nor what
// is mended (mesh_repair_test.cpp, mesh_winding_test.cpp).
#include "rig/session/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/angles.h"
#include "tests/rig/session/mesh_polygons.h"

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

template <typename T>
std::string Bytes(T value, bool big) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

// With properties of no use before, between and after those that are read.
std::string BinaryPly(const Polygons& mesh, bool big) {
  std::string out =
      "ply\r\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\r\n";
  out += "obj_info element vertex 99\r\nelement vertex " + std::to_string(mesh.vertices.size());
  out +=
      "\r\nproperty float x\r\nproperty uchar red\r\nproperty float32 y\r\nproperty double q\r\n";
  out +=
      "property float z\r\nproperty short s\r\nelement face " + std::to_string(mesh.faces.size());
  out += "\r\nproperty list uint uint32 vertex_index\r\nproperty int flags\r\nproperty uchar f\r\n";
  out += "element edge 5\r\nproperty list int float other\r\nend_header\r\n";
  for (const Vector3d& v : mesh.vertices)
    out += Bytes(static_cast<float>(v.x()), big) + "R" + Bytes(static_cast<float>(v.y()), big) +
           Bytes(0.5, big) + Bytes(static_cast<float>(v.z()), big) + Bytes(std::int16_t{7}, big);
  for (const auto& face : mesh.faces) {
    out += Bytes(static_cast<std::uint32_t>(face.size()), big);
    for (const int index : face) out += Bytes(static_cast<std::uint32_t>(index), big);
    out += Bytes(std::int32_t{-1}, big) + "f";
  }
  return out;
}

// Two squares that share the y axis, the second bent down by an angle.
Polygons Hinge(double angle_deg) {
  const double c = std::cos(DegToRad(angle_deg)), s = std::sin(DegToRad(angle_deg));
  return {{{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {c, 0, -s}, {c, 1, -s}},
          {{0, 1, 2, 3}, {1, 4, 5, 2}},
          {}};
}

calib::MeshShape Parsed(const std::string& bytes, const std::string& file) {
  const auto mesh = ParseMesh(bytes, file);
  EXPECT_TRUE(mesh) << mesh.error().text;
  return mesh.value_or(calib::MeshShape{});
}

std::string ParseError(const std::string& bytes, const std::string& file) {
  testing::internal::CaptureStderr();
  const auto mesh = ParseMesh(bytes, file);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(mesh) << bytes;
  return mesh ? "" : mesh.error().text;
}

void ExpectSame(const calib::MeshShape& a, const calib::MeshShape& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  ASSERT_EQ(a.faces, b.faces);
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    EXPECT_LT((a.vertices[i] - b.vertices[i]).norm(), 1e-5);  // float against double
    EXPECT_LT((a.normals[i] - b.normals[i]).norm(), 1e-5);
  }
}

Vector3d FaceNormal(const calib::MeshShape& mesh, const Eigen::Vector3i& face) {
  const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(face[k])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
}

TEST(MeshFile, FormatsAgree) {
  for (const Polygons& polygons : {Cube(), Sphere(9, 12)}) {
    const auto text = Parsed(TextPly(polygons), "a.ply");
    ExpectSame(text, Parsed(BinaryPly(polygons, false), "a.PLY"));
    ExpectSame(text, Parsed(BinaryPly(polygons, true), "a.ply"));
    ExpectSame(text, Parsed(Obj(polygons), "a.obj"));
  }
}

TEST(MeshFile, CubeHasTheNormalsOfItsFaces) {
  const auto cube = Parsed(TextPly(Cube()), "cube.ply");
  EXPECT_EQ(cube.vertices.size(), 24u);  // three sides meet at each of eight corners
  EXPECT_EQ(cube.faces.size(), 12u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(cube.vertices[i], Cube().vertices[i]);
  for (const Eigen::Vector3i& face : cube.faces) {
    const Vector3d normal = FaceNormal(cube, face);
    EXPECT_GT(normal.dot(cube.vertices[static_cast<std::size_t>(face[0])]), 9.9);  // outwards
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((cube.normals[static_cast<std::size_t>(face[k])] - normal).norm(), 1e-12);
  }
}

// Areas below what a double has all its digits for.
TEST(MeshFile, NormalsOfTinyFacesAreUnit) {
  for (const char* size : {"1e-155", "1e-160", "2.5e-161"}) {
    const std::string text = std::string("v 0 0 0\nv ") + size + " 0 0\nv 0 " + size + " " + size +
                             "\nv 0 0 " + size + "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    const auto mesh = ParseMesh(text, "tiny.obj");
    ASSERT_TRUE(mesh) << mesh.error().text;
    for (const Eigen::Vector3d& normal : mesh->normals) EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
  }
}

TEST(MeshFile, FineSphereHasRadialNormals) {
  const Polygons polygons = Sphere(99, 200);
  const auto sphere = Parsed(Obj(polygons), "sphere.obj");
  ASSERT_EQ(sphere.vertices.size(), polygons.vertices.size());
  for (std::size_t i = 0; i < sphere.vertices.size(); ++i) {
    EXPECT_LT((sphere.vertices[i] - polygons.vertices[i]).norm(), 1e-12);
    EXPECT_LT((sphere.normals[i] - sphere.vertices[i].normalized()).norm(), 1e-3);
  }
}

// Angles weigh, not areas and not the number of triangles that a square is cut into.
TEST(MeshFile, MeansAreWeightedByAngle) {
  const Polygons polygons{
      {{0, 0, 0}, {1, 0, 0}, {0, 7, 0}, {-3, 0, 0.5}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  const auto mesh = Parsed(Obj(polygons), "a.obj");
  ASSERT_EQ(mesh.vertices.size(), 4u);
  const Vector3d a = FaceNormal(mesh, mesh.faces[0]), b = FaceNormal(mesh, mesh.faces[1]);
  // Both angles at vertex 0 are right angles; at vertex 2 they are atan(1/7) and that of the other.
  EXPECT_LT((mesh.normals[0] - (a + b).normalized()).norm(), 1e-12);
  const double first = std::atan2(1.0, 7.0), second = std::atan2(std::hypot(3.0, 0.5), 7.0);
  EXPECT_LT((mesh.normals[2] - (first * a + second * b).normalized()).norm(), 1e-12);
  EXPECT_LT((mesh.normals[1] - a).norm(), 1e-12);
}

TEST(MeshFile, CreasesBeginAboveThirtyDegrees) {
  const auto smooth = Parsed(TextPly(Hinge(29.9)), "a.ply");
  EXPECT_EQ(smooth.vertices.size(), 6u);
  const Vector3d half(std::sin(DegToRad(14.95)), 0.0, std::cos(DegToRad(14.95)));
  EXPECT_LT((smooth.normals[1] - half).norm(), 1e-6);
  const auto creased = Parsed(TextPly(Hinge(30.1)), "a.ply");
  EXPECT_EQ(creased.vertices.size(), 8u);  // the two vertices of the hinge are split
  EXPECT_LT((creased.normals[1] - Vector3d::UnitZ()).norm(), 1e-6);
  EXPECT_EQ(creased.vertices[6], creased.vertices[1]);
  EXPECT_EQ(Parsed(Obj(Hinge(30.0)), "a.obj").vertices.size(), 6u);
}

// The sides of a fine cone meet at small angles, though opposite ones are far from parallel.
TEST(MeshFile, GentleStepsAroundAVertexStayTogether) {
  Polygons cone{{{0, 0, 1}}, {}, {}};
  for (int i = 0; i < 36; ++i) {
    cone.vertices.emplace_back(std::cos(DegToRad(10.0 * i)), std::sin(DegToRad(10.0 * i)), 0.0);
    cone.faces.push_back({0, i + 1, (i + 1) % 36 + 1});
  }
  const auto mesh = Parsed(Obj(cone), "cone.obj");
  EXPECT_EQ(mesh.vertices.size(), 37u);
  EXPECT_LT((mesh.normals[0] - Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(MeshFile, VerticesAtOnePlaceAreSmoothedTogether) {
  Polygons seam = Hinge(20.0);
  seam.vertices.push_back(seam.vertices[1]);
  seam.vertices.push_back(seam.vertices[2]);
  seam.faces[1] = {6, 4, 5, 7};
  const auto mesh = Parsed(Obj(seam), "seam.obj");
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.normals[1], mesh.normals[6]);
  EXPECT_LT((mesh.normals[1] - Parsed(Obj(Hinge(20.0)), "a.obj").normals[1]).norm(), 1e-12);
}

TEST(MeshFile, NormalsOfTheFileAreKeptAndNormalised) {
  Polygons polygons = Hinge(80.0);
  for (std::size_t i = 0; i < 6; ++i) polygons.normals.push_back(Vector3d(0.1 * double(i), 0.0, 2));
  for (const auto& mesh : {Parsed(TextPly(polygons), "a.ply"), Parsed(Obj(polygons), "a.obj")}) {
    ASSERT_EQ(mesh.vertices.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_LT((mesh.normals[i] - polygons.normals[i].normalized()).norm(), 1e-7);
  }
}

TEST(MeshFile, ObjVerticesWithSeveralNormalsAreCopied) {
  const auto mesh = Parsed(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -1\nvn 0 0 1\nvn 0 -1 0\n"
      "f 1//1 2//1 3//1\nf -3//-1 -4//-1 -1//-1\n",
      "a.obj");
  ASSERT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.normals[0], Vector3d::UnitZ());
  EXPECT_EQ(mesh.normals[3], Vector3d(0, -1, 0));
  EXPECT_EQ(mesh.faces[1], Eigen::Vector3i(4, 5, 3));
  EXPECT_EQ(mesh.vertices[4], mesh.vertices[1]);
  EXPECT_EQ(mesh.normals[4], Vector3d(0, -1, 0));
}

TEST(MeshFile, PolygonsAreCoveredOnce) {
  // An L of area 3, and a comb whose fan from its first corner would leave it.
  const Polygons ell{
      {{2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}}, {{0, 1, 2, 3, 4, 5}}, {}};
  const Polygons comb{{{0, 0, 1},
                       {5, 0, 1},
                       {5, 3, 1},
                       {4, 3, 1},
                       {4, 1, 1},
                       {3, 1, 1},
                       {3, 3, 1},
                       {2, 3, 1},
                       {2, 1, 1},
                       {1, 1, 1},
                       {1, 3, 1},
                       {0, 3, 1}},
                      {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}},
                      {}};
  for (const auto& [polygons, area] : {std::pair(ell, 3.0), {comb, 11.0}}) {
    const auto mesh = Parsed(Obj(polygons), "a.obj");
    EXPECT_EQ(mesh.faces.size(), polygons.vertices.size() - 2);
    double sum = 0.0;
    for (const Eigen::Vector3i& face : mesh.faces) {
      const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(face[k])]; };
      const double part = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).z();
      EXPECT_GT(part, 0.0);
      sum += part;
    }
    EXPECT_NEAR(sum, area, 1e-12);
  }
}

TEST(MeshFile, NoFacesAreRefused) {
  EXPECT_THAT(ParseError(TextPly({Cube().vertices, {}, {}}), "empty.ply"),
              AllOf(HasSubstr("empty.ply"), HasSubstr("no faces"), HasSubstr("1 or more")));
  EXPECT_THAT(ParseError(Obj({Cube().vertices, {}, {}}), "empty.obj"), HasSubstr("no faces"));
  EXPECT_THAT(ParseError("", "empty.obj"), HasSubstr("no faces"));
}

TEST(MeshFile, LinesThatAreNoNumbersAreNamed) {
  EXPECT_THAT(ParseError("v 0 0 0\nv 0 none 0\n", "a.obj"),
              AllOf(HasSubstr("a.obj:2"), HasSubstr("v 0 none 0"), HasSubstr("3 numbers")));
  EXPECT_THAT(ParseError("v 0 0\nf 1 1 1\n", "a.obj"), HasSubstr("a.obj:1"));
  EXPECT_THAT(ParseError("v 0,5 0 0\n", "a.obj"), HasSubstr("v 0,5 0 0"));
  for (const char* face : {"1 x 1", "1/2/3/4 1 1", "/1 1 1", "1.5 1 1", "1//x 1 1", "1\\2 1 1"})
    EXPECT_THAT(ParseError("v 0 0 0\nf " + std::string(face) + "\n", "a.obj"),
                AllOf(HasSubstr("a.obj:2"), HasSubstr("corners v, v/t, v//n or v/t/n")))
        << face;
  EXPECT_THAT(ParseError("v 0 0 0\nf 1 \\\n 1 \\\n x\n", "a.obj"), HasSubstr("a.obj:2"));
}

// Numbers in every spelling, and points that are none.
TEST(MeshFile, NumbersInText) {
  const auto mesh = Parsed(
      "v +1.5 -2e0 .25\nv 1e-999 1.#QNAN 1e999\nv nan -inf -1.#IND\nv 0 0 0 1 0.5 0.5 0.5\n"
      "v 0 1 0 # a comment\nf 1 4 5 # and one more\n",
      "a.obj");
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.vertices[0], Vector3d(1.5, -2, 0.25));
}

// "1e16" is no whole number of a type that PLY has; text of floats has the precision of floats.
TEST(MeshFile, DeclaredTypesOfText) {
  const auto text = [](const std::string& type, const std::string& x) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty " + type + " x\nproperty " + type +
           " y\nproperty " + type +
           " z\nelement face 1\nproperty list uint16 int16 vertex_index\nend_header\n" + x +
           " 0 0 1 0\n0 0 1 0\n3 0 1 2\n";
  };
  EXPECT_EQ(Parsed(text("double", "0.1"), "a.ply").vertices[0].x(), 0.1);
  EXPECT_EQ(Parsed(text("float", "0.1"), "a.ply").vertices[0].x(), 0.1f);
  EXPECT_EQ(Parsed(text("uchar", "7"), "a.ply").vertices[0].x(), 7.0);
  EXPECT_THAT(ParseError(text("double", "zero"), "a.ply"),
              HasSubstr("cannot be read, after 0 of 3 elements vertex"));
}

TEST(MeshFile, TruncatedPlyIsRefused) {
  for (const std::string& whole : {TextPly(Cube()), BinaryPly(Cube(), false)}) {
    ASSERT_TRUE(ParseMesh(whole, "a.ply"));
    for (std::size_t length = 0; length + 2 < whole.size(); ++length)
      EXPECT_THAT(ParseError(whole.substr(0, length), "a.ply"), HasSubstr("a.ply")) << length;
  }
}

TEST(MeshFile, HostileHeadersAreRefused) {
  const std::string begin = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const auto error = [&](const std::string& header) {
    return ParseError(begin + header + "end_header\n0 0 0\n", "a.ply");
  };
  EXPECT_THAT(error("element vertex 4000000000\n" + xyz + "element face 1\n" + list),
              AllOf(HasSubstr("truncated"), HasSubstr("4000000000")));
  EXPECT_THAT(error("element vertex 1\n" + xyz + "element face 1\n"),
              HasSubstr("face has no list vertex_indices"));
  EXPECT_THAT(error("element vertex 1\n" + xyz + "element edge 1\n" + list),
              AllOf(HasSubstr("no mesh"), HasSubstr("vertex, edge"), HasSubstr("tristrips")));
  EXPECT_THAT(
      error("element vertex 1\n" + xyz + "element vertex 1\n" + xyz + "element face 0\n" + list),
      HasSubstr("one vertex"));
  EXPECT_THAT(error("property float x\n"), HasSubstr("a.ply:3"));
  EXPECT_THAT(error("element vertex 1\nproperty list uchar int x\nproperty float y\n"
                    "property float z\nelement face 1\n" +
                    list),
              HasSubstr("no property x"));
  EXPECT_THAT(error("element vertex 1\nproperty quad x\n"), HasSubstr("property quad x"));
  EXPECT_THAT(error("element vertex 1\nproperty list float int x\n"), HasSubstr("list float int"));
  EXPECT_THAT(error("element vertex 1\nproperty \x1b[31m x\n"), Not(HasSubstr("\x1b")));
  EXPECT_THAT(error("element none 18446744073709551615\nelement vertex 1\n" + xyz +
                    "element face 1\n" + list),
              HasSubstr("after 0 of 1 elements face"));
  EXPECT_THAT(ParseError("plx\n", "a.ply"), HasSubstr("not a PLY file"));
  EXPECT_THAT(ParseError("", "a.stl"), AllOf(HasSubstr(".stl"), HasSubstr(".ply and .obj")));
}

TEST(MeshFile, MissingFileIsNamed) {
  const auto mesh = ReadMesh("/nowhere/target.ply");
  ASSERT_FALSE(mesh);
  EXPECT_THAT(mesh.error().text, HasSubstr("/nowhere/target.ply"));
}

}  // namespace
}  // namespace turnlight::rig
