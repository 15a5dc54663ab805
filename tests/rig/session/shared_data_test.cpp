// Proves: the sessions handed to the project from outside, written by other programs, are read
// whole. Does not prove: that their pictures mean what their truth says; the estimator's tests do.
#include <gtest/gtest.h>

#include <filesystem>

#include "rig/session/session.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

class SharedData : public testing::TestWithParam<const char*> {};

TEST_P(SharedData, IsReadWhole) {
  const fs::path root = fs::path(TURNLIGHT_SHARED_DATA) / GetParam();
  if (!fs::exists(root)) GTEST_SKIP() << root << " is absent";
  const auto session = ReadSession(root);
  ASSERT_TRUE(session) << session.error().text;
  ASSERT_FALSE(session->frames.empty());
  const auto target = ReadTarget(*session);
  ASSERT_TRUE(target) << target.error().text;
  for (std::size_t i = 0; i < session->frames.size(); ++i) {
    const auto images = ReadFrameImages(*session, i);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_EQ(images->image.cols, session->camera->width());
    EXPECT_EQ(images->image.rows, session->camera->height());
    EXPECT_GT(cv::countNonZero(images->mask), 0);
  }
  const auto report = VerifySession(root);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_EQ(report->problems, std::vector<std::string>());
  EXPECT_EQ(report->frames, session->frames.size());
  EXPECT_EQ(report->content_sha256.size(), 64u);
}

INSTANTIATE_TEST_SUITE_P(Sessions, SharedData,
                         testing::Values("pov_matte_sphere_1", "pov_orbit_plane_1",
                                         "pov_orbit_sphere_3", "pov_table_mesh_2", "uw_gray_00",
                                         "uw_gray_03", "uw_gray_04", "uw_gray_05", "uw_gray_06",
                                         "uw_gray_08"));

TEST(SharedMesh, KeepsItsVerticesAndNormals) {
  const fs::path root = fs::path(TURNLIGHT_SHARED_DATA) / "pov_table_mesh_2";
  if (!fs::exists(root)) GTEST_SKIP() << root << " is absent";
  const auto session = ReadSession(root);
  ASSERT_TRUE(session) << session.error().text;
  const auto target = ReadTarget(*session);
  ASSERT_TRUE(target) << target.error().text;
  const auto& mesh = std::get<calib::MeshShape>(*target);
  EXPECT_EQ(mesh.vertices.size(), 6144u);
  EXPECT_EQ(mesh.faces.size(), 12096u);
  // The first line of its values.
  EXPECT_LT((mesh.vertices[0] - Eigen::Vector3d(0.047424, 0.0, 47.423761)).norm(), 1e-5);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.158783, -0.000283, 0.987313).normalized();
  EXPECT_LT((mesh.normals[0] - normal).norm(), 1e-6);
}

}  // namespace
}  // namespace turnlight::rig
