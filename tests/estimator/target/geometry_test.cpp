// Proves, against closed forms: where rays meet a sphere, a plane and a mesh, with which normals,
// from which sides, and what stands between a point of a mesh and a light. Does not prove it for
// meshes of strangers: mesh_file_test reads those, independent_data_test compares pictures of them.
#include "estimator/target/geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/directions.h"
#include "tests/estimator/floor_and_wall.h"

namespace turnlight::estimator::target {
namespace {

using Eigen::Vector3d;

TEST(Geometry, RaysMeetASphereOnItsNearSide) {
  const Geometry sphere{calib::TargetShape(calib::SphereShape{2.0})};
  EXPECT_FALSE(sphere.CanShadowItself());
  EXPECT_EQ(sphere.radius(), 2.0);
  const RandomStream random(1, 1);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector3d eye = 7.0 * RandomUnit(random, i);
    const Vector3d point = 2.0 * RandomUnit(random, 1000 + i);
    const double facing = (eye - point).dot(point);
    if (std::abs(facing) < 1e-3) continue;
    // Towards a point on the near side the ray meets it; towards one on the far side, another.
    const auto hit = sphere.Intersect(eye, 0.5 * (point - eye));
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->position.norm(), 2.0, 1e-12);
    EXPECT_LT((hit->normal - hit->position / 2.0).norm(), 1e-12);
    EXPECT_LT((eye + hit->distance * 0.5 * (point - eye) - hit->position).norm(), 1e-11);
    if (facing > 0.0) {
      EXPECT_NEAR(hit->distance, 2.0, 1e-8);
      EXPECT_LT((hit->position - point).norm(), 1e-7);
    } else {
      EXPECT_LT(hit->distance, 2.0);
    }
    EXPECT_FALSE(sphere.Intersect(eye, eye - point).has_value()) << "behind the eye";
  }
  EXPECT_TRUE(sphere.Intersect({1.999, 0, 5}, {0, 0, -1}).has_value());
  EXPECT_FALSE(sphere.Intersect({2.001, 0, 5}, {0, 0, -1}).has_value());
}

TEST(Geometry, APlaneHasAnEdgeAndOneSideOrTwo) {
  const Geometry one{calib::TargetShape(calib::PlaneShape{4.0, 2.0})};
  const Geometry two{calib::TargetShape(calib::PlaneShape{4.0, 2.0, 2})};
  EXPECT_NEAR(one.radius(), std::sqrt(5.0), 1e-15);
  const auto hit = one.Intersect({1.0, 0.5, 3.0}, {0.25, 0.0, -1.5});
  ASSERT_TRUE(hit.has_value());
  EXPECT_LT((hit->position - Vector3d(1.5, 0.5, 0.0)).norm(), 1e-15);
  EXPECT_EQ(hit->normal, Vector3d::UnitZ());
  EXPECT_NEAR(hit->distance, 2.0, 1e-15);
  EXPECT_TRUE(one.Intersect({1.99, 0.99, 3.0}, -Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(one.Intersect({2.01, 0.0, 3.0}, -Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(one.Intersect({0.0, 1.01, 3.0}, -Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(one.Intersect({0.0, 0.0, 3.0}, Vector3d::UnitX()).has_value());
  EXPECT_FALSE(one.Intersect({0.0, 0.0, -3.0}, Vector3d::UnitZ()).has_value());
  const auto behind = two.Intersect({0.0, 0.0, -3.0}, Vector3d::UnitZ());
  ASSERT_TRUE(behind.has_value());
  EXPECT_EQ(behind->normal, Vector3d(-Vector3d::UnitZ()));
}

TEST(Geometry, AMeshIsMetInDoublePrecisionWhereverItStands) {
  for (const double away : {0.0, 1e4}) {
    calib::MeshShape shape = FloorAndWall();
    for (Vector3d& vertex : shape.vertices) vertex.x() += away;
    const Geometry mesh{calib::TargetShape(shape)};
    EXPECT_TRUE(mesh.CanShadowItself());
    const RandomStream random(2, 2);
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vector3d point(away + random.Uniform(3 * i, -49, 49),
                           random.Uniform(3 * i + 1, -49, 15), 0.0);
      const Vector3d eye = point + 500.0 * Vector3d(0.1, -0.3, 1.0);
      const auto hit = mesh.Intersect(eye, point - eye);
      ASSERT_TRUE(hit.has_value());
      EXPECT_LT((hit->position - point).norm(), 1e-9);
      EXPECT_LT((hit->geometric_normal - Vector3d::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(hit->distance, 1.0, 1e-11);
      EXPECT_LT(hit->primitive, 2u);
    }
    // From the front the wall is what is seen; from behind it hides the floor and shows nothing.
    const auto wall = mesh.Intersect({away, -100, 5}, {0, 1, 0});
    ASSERT_TRUE(wall.has_value());
    EXPECT_LT((wall->geometric_normal + Vector3d::UnitY()).norm(), 1e-12);
    EXPECT_NEAR(wall->position.y(), 20.0, 1e-9);
    EXPECT_FALSE(mesh.Intersect({away, 100, 5}, {0, -1, -0.05}).has_value());
  }
}

// As a survey gives it: coordinates of millions about a target of 2, no more lost than a double
// must.
TEST(Geometry, AMeshAtMapCoordinatesIsMetWithoutLoss) {
  const Vector3d place(482311.25, 5407899.75, 310.5);
  calib::MeshShape shape = FloorAndWall();
  for (Vector3d& vertex : shape.vertices) vertex = place + 0.02 * vertex;
  const Geometry mesh{calib::TargetShape(shape)};
  EXPECT_EQ(mesh.center().z(), place.z() + 0.1);
  const RandomStream random(3, 2);
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vector3d point = place + Vector3d(random.Uniform(2 * i, -0.98, 0.98),
                                            random.Uniform(2 * i + 1, -0.98, 0.3), 0);
    const Vector3d eye = point + Vector3d(1, -3, 10);
    const auto hit = mesh.Intersect(eye, point - eye);
    ASSERT_TRUE(hit.has_value());
    EXPECT_LT((hit->position - point).norm(), 1e-8);
    EXPECT_EQ(hit->position.z(), place.z());
    EXPECT_FALSE(mesh.SeesBack(eye, point - eye));
  }
  EXPECT_TRUE(mesh.SeesBack(place - Vector3d::UnitZ(), Vector3d::UnitZ()));
  EXPECT_FALSE(mesh.SeesBack(place - Vector3d::UnitZ(), -Vector3d::UnitZ()));
}

TEST(Geometry, InterpolatesTheNormalsOfAMesh) {
  calib::MeshShape shape;
  shape.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  shape.normals = {Vector3d(0, 0, 1), Vector3d(1, 0, 1).normalized(),
                   Vector3d(0, 1, 1).normalized()};
  shape.faces = {{0, 1, 2}};
  const Geometry mesh{calib::TargetShape(shape)};
  const auto hit = mesh.Intersect({0.25, 0.5, 3.0}, {0, 0, -1});
  ASSERT_TRUE(hit.has_value());
  const Vector3d expected =
      (0.25 * shape.normals[0] + 0.25 * shape.normals[1] + 0.5 * shape.normals[2]).normalized();
  EXPECT_LT((hit->normal - expected).norm(), 1e-12);
  EXPECT_LT((hit->geometric_normal - Vector3d::UnitZ()).norm(), 1e-15);
}

// The wall is 10 high: its shadow from 45 degrees is as long.
TEST(Geometry, WhatStandsBetweenAPointAndALight) {
  const Geometry mesh{calib::TargetShape(FloorAndWall())};
  const Vector3d up = Vector3d::UnitZ(), from_behind = Vector3d(0, 1, 1).normalized();
  for (const double y : {19.0, 15.0, 10.1}) EXPECT_TRUE(mesh.Occluded({3, y, 0}, up, from_behind));
  for (const double y : {9.9, 0.0}) EXPECT_FALSE(mesh.Occluded({3, y, 0}, up, from_behind));
  EXPECT_FALSE(mesh.Occluded({3, 15, 0}, up, Vector3d(0, -1, 1).normalized()));
  // A light between the point and the wall is not hidden by it.
  const double to_wall = 5.0 * std::sqrt(2.0);
  EXPECT_FALSE(mesh.Occluded({3, 15, 0}, up, from_behind, 0.99 * to_wall));
  EXPECT_TRUE(mesh.Occluded({3, 15, 0}, up, from_behind, 1.01 * to_wall));
  const Geometry sphere{calib::TargetShape(calib::SphereShape{1.0})};
  EXPECT_FALSE(sphere.Occluded({0, 0, 1}, up, -up)) << "a convex shape only turns away";
}

}  // namespace
}  // namespace turnlight::estimator::target
