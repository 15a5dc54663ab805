// Proves, in closed form: which floor a wall keeps its light off, for distant and near lights, and
// which pixels lie on the edge of a cast or an attached shadow; a light that hardly moved keeps
// what was cast. Does not prove that leaving edges out is enough: unknown_errors_test and
// bench/studies do.
#include "estimator/solve/shadows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimator/observe/observation_access.h"
#include "tests/estimator/floor_and_wall.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Vector3d;

// Pixels straight above the floor in front of the wall, half a unit apart along x and one along y:
// row 0 is half a unit from the wall.
struct FloorPixels {
  static constexpr int kWidth = 101, kRows = 40;
  target::Geometry geometry{calib::TargetShape(FloorAndWall())};
  observe::Observations all;

  FloorPixels() {
    all.channels = 1;
    all.radius = geometry.radius();
    all.caster = &geometry;
    all.width = kWidth;
    all.X_TW = {calib::Pose()};
    all.used = std::size_t{kRows} * kWidth;
    all.Resize((all.used + observe::kTile - 1) / observe::kTile * observe::kTile);
    all.tile_begin = {0, all.tiles()};
    for (std::size_t i = 0; i < all.used; ++i) {
      all.pixel[i] = static_cast<std::uint32_t>(i);
      observe::Put(Vector3d(static_cast<double>(i % kWidth) * 0.5 - 25.0, Y(i), 0.0) / all.radius,
                   i, all.position);
      for (auto* normals : {&all.normal, &all.face_normal, &all.mirrored})
        observe::Put(Vector3d::UnitZ(), i, *normals);
    }
  }
  static double Y(std::size_t i) { return 19.5 - static_cast<double>(i / kWidth); }
};

model::Scene OneLightFrom(const Vector3d& direction, double inverse_distance = 0.0) {
  model::Scene scene;
  scene.lights = {{direction.normalized(), inverse_distance, 1.0, Vector3d::Ones()}};
  return scene;
}

// From beyond the wall, 45 degrees high: the shadow is as long as the wall is high.
TEST(CastShadows, FloorBehindAWallIsDarkAsFarAsTheLightIsLow) {
  const FloorPixels floor;
  const model::Scene scene = OneLightFrom({0, 1, 1});
  const Shadows shadows = CastShadows(floor.all, scene);
  ASSERT_EQ(shadows.lit.size(), 1u);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < floor.all.used; ++i) {
    const double y = FloorPixels::Y(i);
    EXPECT_EQ((*shadows.lit[0])[i], y < 10.0 ? 1 : 0) << y;
    EXPECT_EQ((*shadows.blocked[0])[i], y < 10.0 ? 0 : 1) << y;
    const bool edge = y > 9.0 && y < 11.0;
    EXPECT_EQ((*shadows.usable)[i], edge ? 0 : 1) << y;
    left_out += edge ? 1 : 0;
  }
  EXPECT_EQ(shadows.left_out, left_out);
  EXPECT_TRUE(SameShadows(shadows, CastShadows(floor.all, scene)));
}

// A lamp behind the wall at (0, 40, 20): its rays over the wall's top come down at y = 0. In front
// of the wall, or below the floor, it casts none.
TEST(CastShadows, ANearLightsShadowEndsWhereItsRaysDo) {
  const FloorPixels floor;
  const double radius = floor.all.radius;
  const auto lamp = [&](const Vector3d& at) {
    return CastShadows(floor.all, OneLightFrom(at, radius / at.norm()));
  };
  const Shadows behind = lamp({0, 40, 20}), before = lamp({0, 19.9, 20}), below = lamp({0, 40, -9});
  for (std::size_t i = 0; i < floor.all.used; ++i) {
    const bool dark = FloorPixels::Y(i) > 0.0;
    EXPECT_EQ((*behind.blocked[0])[i], dark ? 1 : 0) << FloorPixels::Y(i);
    EXPECT_EQ((*behind.lit[0])[i], dark ? 0 : 1) << FloorPixels::Y(i);
    EXPECT_EQ((*before.lit[0])[i], 1);
    EXPECT_EQ((*below.lit[0])[i] + (*below.blocked[0])[i], 0) << "faces away";
  }
}

TEST(CastShadows, ALightThatHardlyMovedKeepsItsPlanes) {
  const FloorPixels floor;
  const model::Scene scene = OneLightFrom({0, 1, 1});
  const Shadows shadows = CastShadows(floor.all, scene);
  model::Scene moved = scene;
  moved.lights[0].direction = (moved.lights[0].direction + Vector3d(0, 0.009, 0)).normalized();
  const Shadows kept = CastShadows(floor.all, moved, shadows, 0.01);
  EXPECT_EQ(kept.lit[0], shadows.lit[0]);
  EXPECT_EQ(kept.lights[0].direction, scene.lights[0].direction) << "small steps must not add up";
  EXPECT_NE(CastShadows(floor.all, moved, shadows, 0.005).lit[0], shadows.lit[0]);
  moved.lights[0] = scene.lights[0];
  moved.lights[0].inverse_distance = 0.02;
  EXPECT_NE(CastShadows(floor.all, moved, shadows, 0.01).lit[0], shadows.lit[0]);
}

// Where blocks were given up, what lies beside them could hide an edge: it is left out too.
TEST(CastShadows, BesideABlockThatWasGivenUpEdgesAreNotKnown) {
  FloorPixels floor;
  const observe::BlockChoice half{0.5};
  const auto kept = [&](std::size_t row, std::size_t column) {
    return half.Keeps(0, static_cast<int>(column), static_cast<int>(row));
  };
  std::size_t to = 0;
  for (std::size_t i = 0; i < floor.all.used; ++i) {
    if (!kept(i / FloorPixels::kWidth, i % FloorPixels::kWidth)) continue;
    observe::Put(observe::At(floor.all.position, i), to, floor.all.position);
    floor.all.pixel[to++] = static_cast<std::uint32_t>(i);
  }
  std::fill(floor.all.pixel.begin() + static_cast<std::ptrdiff_t>(to), floor.all.pixel.end(),
            observe::Observations::kNoPixel);
  floor.all.blocks = half;
  const Shadows shadows = CastShadows(floor.all, OneLightFrom({0, 1, 1}));
  std::size_t beside = 0, usable = 0;
  for (std::size_t i = 0; i < to; ++i) {
    const std::size_t row = floor.all.pixel[i] / FloorPixels::kWidth;
    const std::size_t column = floor.all.pixel[i] % FloorPixels::kWidth;
    bool known = true;
    for (std::size_t r = row > 0 ? row - 1 : 0; r <= row + 1; ++r)
      for (std::size_t c = column > 0 ? column - 1 : 0; c <= column + 1; ++c)
        if (c < FloorPixels::kWidth && !kept(r, c)) known = false;
    const double y = FloorPixels::Y(floor.all.pixel[i]);
    const bool edge = y > 9.0 && y < 11.0;
    EXPECT_EQ((*shadows.usable)[i], !edge && known ? 1 : 0) << row << " " << column;
    beside += known ? 0 : 1;
    usable += (*shadows.usable)[i];
  }
  EXPECT_GT(beside, 100u);
  EXPECT_GT(usable, 500u);
}

TEST(CastShadows, ABallHasNoPlanesAndASampleNoEdges) {
  RandomObservations random(1000, 1, 1);
  for (auto& component : random.observations.footprint)
    std::fill(component.begin(), component.end(), observe::ToBFloat16(0.05f));
  const Shadows whole = CastShadows(random.observations, TwoLights());
  EXPECT_TRUE(whole.lit.empty());
  EXPECT_GT(whole.left_out, 0u);
  random.observations.subsampled = true;
  const Shadows sample = CastShadows(random.observations, TwoLights());
  EXPECT_EQ(sample.usable, nullptr);
  EXPECT_EQ(sample.left_out, 0u);
  EXPECT_EQ(sample.lights.size(), 2u);
}

TEST(SameShadows, AreThoseOfTheSameBytes) {
  const auto plane = [](std::uint8_t value) {
    return std::make_shared<const std::vector<std::uint8_t>>(10, value);
  };
  const Shadows a{.lights = {}, .lit = {plane(1)}, .blocked = {plane(0)}, .usable = plane(1)};
  Shadows b = a;
  b.lit = {plane(1)};
  b.blocked = {plane(1)};  // is not in the model
  EXPECT_TRUE(SameShadows(a, b));
  b.lit = {plane(0)};
  EXPECT_FALSE(SameShadows(a, b));
  b.lit.clear();
  EXPECT_FALSE(SameShadows(a, b));
  b = a;
  b.usable = nullptr;
  EXPECT_FALSE(SameShadows(a, b));
}

TEST(AwayFromTerminators, LeavesOutExactlyWhatIsNearAnEdge) {
  constexpr double kChange = 0.0625;  // of the mirrored ray per pixel: exact in bfloat16
  RandomObservations random(5000, 1, 2);
  observe::Observations& all = random.observations;
  for (const std::size_t k : {0u, 4u})
    std::fill(all.footprint[k].begin(), all.footprint[k].end(), observe::ToBFloat16(kChange));
  const std::vector<model::Light> lights = TwoLights(0.3, 0.0).lights;
  std::vector<std::uint8_t> last(all.size(), 1);
  for (const double margin : {0.0, 1.0, 2.0, 4.0}) {
    const PixelMask away = AwayFromTerminators(all, lights, margin);
    ASSERT_EQ(away->size(), all.size());
    std::size_t near = 0;
    for (std::size_t i = 0; i < random.points.size(); ++i) {
      const RandomPoint& p = random.points[i];
      // Across a footprint of kChange by kChange the normal turns by so much at most.
      const double turn = kChange / p.normal.dot(p.viewer);
      double closest = 1.0;
      for (const model::Light& light : lights)
        closest = std::min(closest, std::abs(p.normal.dot(light.Toward(p.position).normalized())));
      if (std::abs(closest - 0.5 * margin * turn) > 1e-6) {
        EXPECT_EQ((*away)[i] == 0, closest < 0.5 * margin * turn) << i << " margin " << margin;
      }
      EXPECT_LE((*away)[i], last[i]) << "a larger margin gave one back";
      near += (*away)[i] == 0 ? 1 : 0;
    }
    for (std::size_t i = random.points.size(); i < all.size(); ++i) EXPECT_EQ((*away)[i], 1);
    EXPECT_EQ(near > 100, margin > 0.0) << margin;
    last = *away;
  }
}

TEST(AwayFromTerminators, NoLightNoEdge) {
  const RandomObservations random(300, 1, 2);
  const PixelMask away = AwayFromTerminators(random.observations, {}, 4.0);
  EXPECT_EQ(std::count(away->begin(), away->end(), 0), 0);
}

}  // namespace
}  // namespace turnlight::estimator::solve
