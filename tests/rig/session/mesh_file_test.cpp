// Proves: PLY (text, binary of both byte orders) and OBJ give the same mesh; normals, creases and
// splitting follow the closed form; every bad mesh is refused with the reason.
// Does not prove: that any other program's dialect of the formats is read.
#include "rig/session/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include "base/angles.h"

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

using Faces = std::vector<std::vector<int>>;

struct Polygons {
  std::vector<Vector3d> vertices;
  Faces faces;
  std::vector<Vector3d> normals;  // one per vertex, or none
};

std::string TextPly(const Polygons& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "ply\nformat ascii 1.0\ncomment by hand\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!mesh.normals.empty()) out << "property float nx\nproperty float ny\nproperty float nz\n";
  out << "element face " << mesh.faces.size() << "\nproperty list uchar int vertex_indices\n"
      << "end_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    out << mesh.vertices[i].transpose();
    if (!mesh.normals.empty()) out << " " << mesh.normals[i].transpose();
    out << "\n";
  }
  for (const auto& face : mesh.faces) {
    out << face.size();
    for (const int index : face) out << " " << index;
    out << "\n";
  }
  return out.str();
}

std::string Obj(const Polygons& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "# by hand\nmtllib missing.mtl\no thing\n";
  for (const Vector3d& v : mesh.vertices) out << "v " << v.transpose() << "\n";
  for (const Vector3d& n : mesh.normals) out << "vn " << n.transpose() << "\n";
  for (const auto& face : mesh.faces) {
    out << "f";
    for (const int index : face) {
      out << " " << index + 1;
      if (!mesh.normals.empty()) out << "//" << index + 1;
    }
    out << "\n";
  }
  return out.str();
}

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

Polygons Cube() {
  Polygons cube;
  for (int i = 0; i < 8; ++i)
    cube.vertices.emplace_back(i & 1 ? 10 : -10, i & 2 ? 10 : -10, i & 4 ? 10 : -10);
  cube.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return cube;
}

// Rings of latitude of a sphere of radius 50, with quadrilaterals and two poles.
Polygons Sphere(int rings, int sectors) {
  Polygons sphere;
  sphere.vertices = {{0, 0, 50}, {0, 0, -50}};
  const auto at = [&](int ring, int sector) { return 2 + ring * sectors + sector % sectors; };
  for (int r = 0; r < rings; ++r) {
    const double polar = std::numbers::pi * (r + 1) / (rings + 1);
    for (int s = 0; s < sectors; ++s) {
      const double azimuth = 2.0 * std::numbers::pi * s / sectors;
      sphere.vertices.push_back(50.0 * Vector3d(std::sin(polar) * std::cos(azimuth),
                                                std::sin(polar) * std::sin(azimuth),
                                                std::cos(polar)));
    }
  }
  for (int s = 0; s < sectors; ++s) {
    sphere.faces.push_back({0, at(0, s), at(0, s + 1)});
    sphere.faces.push_back({1, at(rings - 1, s + 1), at(rings - 1, s)});
    for (int r = 0; r + 1 < rings; ++r)
      sphere.faces.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)});
  }
  return sphere;
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
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -1\nvn 0 0 1\nvn 0 1 0\n"
      "f 1//1 2//1 3//1\nf -4//-1 -3//-1 -1//-1\n",
      "a.obj");
  ASSERT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.normals[0], Vector3d::UnitZ());
  EXPECT_EQ(mesh.normals[3], Vector3d::UnitY());
  EXPECT_EQ(mesh.faces[1], Eigen::Vector3i(4, 5, 3));
  EXPECT_EQ(mesh.vertices[4], mesh.vertices[0]);
  EXPECT_EQ(mesh.normals[4], Vector3d::UnitY());
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

TEST(MeshFile, NormalsAgainstTheWindingAreRefused) {
  Polygons polygons = Sphere(9, 20);
  for (const Vector3d& v : polygons.vertices) polygons.normals.push_back(-v);
  for (const auto& text :
       {ParseError(TextPly(polygons), "in.ply"), ParseError(Obj(polygons), "in.ply.obj")})
    EXPECT_THAT(text, AllOf(HasSubstr("in.ply"), HasSubstr("360 of 360"), HasSubstr("winding"),
                            HasSubstr("at most 5 %")));
  // Two of the hundreds of faces turned: allowed.
  for (Vector3d& normal : polygons.normals) normal = -normal;
  std::swap(polygons.faces[0][0], polygons.faces[0][1]);
  std::swap(polygons.faces[1][0], polygons.faces[1][1]);
  EXPECT_TRUE(ParseMesh(TextPly(polygons), "in.ply"));
}

TEST(MeshFile, NoFacesAreRefused) {
  EXPECT_THAT(ParseError(TextPly({Cube().vertices, {}, {}}), "empty.ply"),
              AllOf(HasSubstr("empty.ply"), HasSubstr("no faces"), HasSubstr("1 or more")));
  EXPECT_THAT(ParseError(Obj({Cube().vertices, {}, {}}), "empty.obj"), HasSubstr("no faces"));
  EXPECT_THAT(ParseError("", "empty.obj"), HasSubstr("no faces"));
}

TEST(MeshFile, BadIndicesAndNumbersAreRefused) {
  Polygons cube = Cube();
  cube.faces[2][1] = 8;
  for (const auto& text : {ParseError(TextPly(cube), "a.ply"), ParseError(Obj(cube), "a.obj")})
    EXPECT_THAT(text, AllOf(HasSubstr("face 2"), HasSubstr("vertex 8"), HasSubstr("0 to 7")));
  cube.faces[2] = {0, 1};
  EXPECT_THAT(ParseError(TextPly(cube), "a.ply"),
              AllOf(HasSubstr("face 2"), HasSubstr("2 corners"), HasSubstr("3 to 256")));
  EXPECT_THAT(ParseError("v 0 0 0\nf 1 x 1\n", "a.obj"), HasSubstr("face 0 names vertex -1"));
  EXPECT_THAT(ParseError("v 0 0 0\nv 0 nan 0\n", "a.obj"),
              AllOf(HasSubstr("a.obj:2"), HasSubstr("v 0 nan 0"), HasSubstr("3 finite numbers")));
  EXPECT_THAT(ParseError("v 0 0\nf 1 1 1\n", "a.obj"), HasSubstr("a.obj:1"));
  cube = Cube();
  cube.vertices[5].y() = std::nan("");
  EXPECT_THAT(ParseError(BinaryPly(cube, false), "a.ply"),
              AllOf(HasSubstr("vertex 5"), HasSubstr("finite")));
  EXPECT_THAT(ParseError(TextPly(cube), "a.ply"), HasSubstr("cannot be read, after"));
  cube = Cube();
  cube.normals.assign(8, Vector3d::Zero());
  EXPECT_THAT(ParseError(TextPly(cube), "a.ply"),
              AllOf(HasSubstr("normal"), HasSubstr("length 0")));
  EXPECT_THAT(
      ParseError("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n", "a.obj"),
      HasSubstr("face 1: some corners have a normal"));
  EXPECT_THAT(ParseError("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", "a.obj"),
              HasSubstr("face 0 has no area or crosses itself"));
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
  EXPECT_THAT(error("element vertex 1\n" + xyz + "element face 1\n" + list + list),
              HasSubstr("allowed is one list"));
  EXPECT_THAT(error("element vertex 1\n" + xyz + "element face 1\n"),
              HasSubstr("allowed is one list"));
  EXPECT_THAT(error("element vertex 1\n" + xyz + "element face 1\nproperty int flags\n" + list),
              HasSubstr("do not begin with it"));
  EXPECT_THAT(error("element face 1\n" + list + "element vertex 1\n" + xyz),
              HasSubstr("begin with"));
  EXPECT_THAT(error("property float x\n"), HasSubstr("a.ply:3"));
  EXPECT_THAT(error("element vertex 1\nproperty int x\nproperty float y\nproperty float z\n"
                    "element face 1\n" +
                    list),
              HasSubstr("no property x of type float"));
  EXPECT_THAT(error("element vertex 1\nproperty quad x\n"), HasSubstr("property quad x"));
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
