// Proves: a mesh that shows its back is counted as such and refused in words of its winding, never
// of poses or distance. Does not prove: which side of an open surface was meant.
#include "estimator/observe/back_faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimator/observe/observed_scene.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::observe {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// An octahedron about the origin.
calib::MeshShape Octahedron(bool inside_out) {
  calib::MeshShape mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.normals = mesh.vertices;
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  if (inside_out)
    for (Eigen::Vector3i& face : mesh.faces) std::swap(face[0], face[1]);
  return mesh;
}

TEST(BackFaces, AreCounted) {
  const TinyBall ball(TwoLights(), 2);
  for (const bool inside_out : {false, true}) {
    const target::Geometry geometry{calib::TargetShape(Octahedron(inside_out))};
    FlagCounts counts;
    for (const model::Keyframe& keyframe : ball.keyframes)
      CountBackFaces(keyframe, geometry, ball.rays, counts);
    EXPECT_GT(counts.rays, 500u);
    EXPECT_EQ(counts.from_behind, inside_out ? counts.rays : 0u);
  }
  FlagCounts counts;
  CountBackFaces(ball.keyframes[0], ball.geometry, ball.rays, counts);
  EXPECT_GT(counts.rays, 500u);
  EXPECT_EQ(counts.from_behind, 0u);
}

TEST(BackFaces, AreTheRefusalsCause) {
  const TinyBall ball(TwoLights(), 2);
  const target::Geometry geometry{calib::TargetShape(Octahedron(true))};
  const auto scene = ObserveScene(ball.keyframes, geometry, ball.rays);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(scene.error().text,
              AllOf(HasSubstr("winding"), HasSubstr("Turn the faces round"),
                    Not(HasSubstr("check the poses")), Not(HasSubstr("move the camera"))));
}

}  // namespace
}  // namespace turnlight::estimator::observe
