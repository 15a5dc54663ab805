// Proves: meshes as other programs write them, one small file each in cases/, give the surface that
// they mean, with a remark where something was mended. Does not prove: more dialects than these.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "rig/session/mesh_file.h"

namespace turnlight::rig {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

struct ReadableMesh {
  const char* file;
  std::size_t triangles;
  const char* remark;  // a part of it; empty: there is none
  Vector3d middle = Vector3d::Zero();
};

std::ostream& operator<<(std::ostream& out, const ReadableMesh& c) { return out << c.file; }

class MeshCase : public testing::TestWithParam<ReadableMesh> {};

// Each is of a cube of edge 2, with normals along the axes and its sides seen from outside.
TEST_P(MeshCase, IsReadAsMeant) {
  const ReadableMesh& c = GetParam();
  std::vector<std::string> remarks;
  const auto path =
      std::filesystem::path(TURNLIGHT_SOURCE_DIR) / "tests/rig/session/cases" / c.file;
  const auto mesh = ReadMesh(path, &remarks);
  ASSERT_TRUE(mesh) << mesh.error().text;
  EXPECT_EQ(mesh->faces.size(), c.triangles);
  for (const Vector3d& vertex : mesh->vertices)
    EXPECT_EQ((vertex - c.middle).cwiseAbs(), Vector3d::Ones());
  for (const Eigen::Vector3i& face : mesh->faces) {
    const auto at = [&](int k) { return mesh->vertices[static_cast<std::size_t>(face[k])]; };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    EXPECT_GT(normal.dot(at(0) - c.middle), 0.5);
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((mesh->normals[static_cast<std::size_t>(face[k])] - normal).norm(), 1e-12);
  }
  if (*c.remark == '\0')
    EXPECT_THAT(remarks, IsEmpty());
  else
    EXPECT_THAT(remarks, testing::ElementsAre(HasSubstr(c.remark)));
}

INSTANTIATE_TEST_SUITE_P(
    Files, MeshCase,
    testing::Values(
        ReadableMesh{"cube_texcoord_after.ply", 12, ""},
        ReadableMesh{"cube_flags_before.ply", 12, ""},
        ReadableMesh{"cube_other_elements.ply", 12, ""},
        ReadableMesh{"cube_double_offset_be.ply", 12, "", {482311.25, 5407899.75, 310.5}},
        ReadableMesh{"cube_tristrips.ply", 4, ""}, ReadableMesh{"cube_cr_only.ply", 12, ""},
        ReadableMesh{"cube_bom.obj", 12, ""},
        ReadableMesh{"cube_stray_nan.ply", 12, "1 vertex that no face names was left out"},
        ReadableMesh{"cube_one_bad_face.ply", 12, "2 of 14 faces cannot be used and were left out"},
        ReadableMesh{"cube_continued_lines.obj", 12, ""},
        ReadableMesh{"cube_empty_normals.obj", 12, ""},
        ReadableMesh{"cube_texture_no_normals.obj", 12, ""},
        ReadableMesh{"cube_some_normals.obj", 12,
                     "30 of 36 corners of triangles have no usable normal"},
        ReadableMesh{"cube_inside_out.ply", 12,
                     "all 12 faces were wound inwards and were turned round"},
        ReadableMesh{"cube_mixed_winding.ply", 12, "6 of 12 faces were wound the wrong way"},
        ReadableMesh{
            "cube_both_sides.ply", 12,
            "12 of 24 faces are copies of others at the same place, 12 of them the other"}),
    [](const auto& info) {
      const std::string file = info.param.file;
      return file.substr(0, file.find('.'));
    });

}  // namespace
}  // namespace turnlight::rig
