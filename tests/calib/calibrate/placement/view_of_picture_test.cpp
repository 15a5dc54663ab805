// Proves: from rendered pictures with noise to X_AT, end to end, for a sphere, a leaning board and
// a mesh off the axis, without masks, with masks alone, and with ambient light subtracted. Does not
// prove it of photographs.
#include "calib/calibrate/placement/view_of_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "rig/sim/studio.h"
#include "rig/sim/synthetic_config.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using testing::HasSubstr;

struct Photographs {
  rig::RigCalibration rig;
  calib::TargetShape shape;
  calib::Pose X_AT;
  std::vector<double> angles_deg;
  std::vector<cv::Mat> lit, ambient;
  std::vector<cv::Mat1b> masks;
};

// Pictures of a target placed at random on the rig's table.
Photographs Take(const rig::sim::SyntheticTarget& target, int views, std::uint64_t seed) {
  rig::sim::SyntheticConfig config;
  config.seed = seed;
  config.target = target;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.focal_px = 1000.0;
  config.sensor.noise_relative = 0.003;
  config.reflectance = rig::sim::RandomReflectance{.albedo = {0.6, 0.8}, .ambient = {0.3, 0.4}};
  const auto studio = rig::sim::BuildStudio(config);
  rig::RigCalibration rig(studio->camera);
  rig.geometry = SampleRig().geometry;
  rig.devices.resolution = {640, 480};
  Photographs taken{
      rig, studio->target, RandomPlace(RandomStream(seed, 1), 10.0), Revolution(views), {}, {}, {}};
  if (std::holds_alternative<calib::SphereShape>(taken.shape)) taken.X_AT.rotation.setIdentity();
  rig.geometry.X_AT = taken.X_AT;
  for (int v = 0; v < views; ++v) {
    const calib::RigPoses poses =
        calib::PosesAt(rig.geometry, taken.angles_deg[static_cast<std::size_t>(v)]);
    const RandomStream random(seed, static_cast<std::uint64_t>(100 + v));
    const auto develop = [&](const cv::Mat3f& radiance) {
      return calib::Linearise(Photograph(config.sensor, studio->radiometry, {}, random, radiance),
                              studio->radiometry, {})
          .radiance;
    };
    const auto lit = RenderPlacement(*studio, poses);
    taken.lit.push_back(develop(0.5 * lit.radiance));
    taken.ambient.push_back(develop(cv::Mat3f(lit.radiance.size(), cv::Vec3f(0.1f, 0.1f, 0.1f))));
    taken.masks.push_back(lit.coverage > 0.5f);
  }
  return taken;
}

Result<Placement> Place(const Photographs& taken, bool masks_alone, PlacementOptions options = {}) {
  std::vector<View> views;
  for (std::size_t v = 0; v < taken.lit.size(); ++v) {
    Pictures pictures{taken.lit[v], {}, {}, {}};
    if (masks_alone) {
      pictures.lit = cv::Mat3f(taken.lit[v].size(), cv::Vec3f());
      pictures.mask = taken.masks[v];
    }
    auto seen = ViewOfPicture(pictures, taken.angles_deg[v], "frame " + std::to_string(v));
    if (!seen) return Forward(seen);
    EXPECT_EQ(seen->from_mask, masks_alone);
    views.push_back(seen->view);
  }
  return PlaceTarget(taken.rig, taken.shape, views, {}, options);
}

void ExpectNear(const Placement& placed, const calib::Pose& truth, bool rotation) {
  const auto error = ErrorOf(placed.X_AT, truth);
  EXPECT_LT(error.tail<3>().norm(), 0.1);
  for (int i = 3; i < 6; ++i)
    EXPECT_LT(std::abs(error[i]), 4.0 * std::sqrt(placed.covariance(i, i))) << i;
  if (rotation) {
    EXPECT_LT(RadToDeg(error.head<3>().norm()), 0.1);
  }
}

TEST(ViewOfPicture, PicturesOfASphereTellWhereItIs) {
  const Photographs taken = Take(calib::SphereShape{35.0}, 6, 11);
  const auto placed = Place(taken, false);
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectNear(*placed, taken.X_AT, false);
  EXPECT_LT(placed->rms, 0.3);
}

TEST(ViewOfPicture, MasksAloneTellItToo) {
  const Photographs taken = Take(calib::SphereShape{35.0}, 6, 12);
  PlacementOptions options;
  options.edge_offset_sigma = kMaskOffsetSigma;
  const auto placed = Place(taken, true, options);
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectNear(*placed, taken.X_AT, false);
}

TEST(ViewOfPicture, PicturesOfABoardTellWhereItIs) {
  const Photographs taken = Take(calib::PlaneShape{80.0, 60.0, 1}, 6, 13);
  const auto placed = Place(taken, false);
  ASSERT_TRUE(placed) << placed.error().text;
  const calib::Pose half = taken.X_AT * calib::Turn(Eigen::Vector3d::UnitZ(), CV_PI);
  ExpectNear(*placed, taken.X_AT.rotation(0, 0) > 0.0 ? taken.X_AT : half, true);
}

TEST(ViewOfPicture, PicturesOfAStandingMeshTellWhereItIs) {
  Photographs taken = Take(rig::sim::Blob{}, 6, 14);
  PlacementOptions options;
  options.upright = true;
  const auto placed = Place(taken, false, options);
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectNear(*placed, taken.X_AT, true);
}

TEST(ViewOfPicture, AmbientLightIsSubtracted) {
  const Photographs taken = Take(calib::SphereShape{35.0}, 1, 15);
  const Pictures pictures{taken.lit[0] + taken.ambient[0], {}, taken.ambient[0], {}};
  const auto with = ViewOfPicture(pictures, 0.0, "frame 0");
  const auto without = ViewOfPicture({taken.lit[0], {}, {}, {}}, 0.0, "frame 0");
  ASSERT_TRUE(with && without);
  const double area = cv::countNonZero(without->mask);
  EXPECT_NEAR(cv::countNonZero(with->mask), area, 0.01 * area);
}

TEST(ViewOfPicture, APictureWithoutATargetIsLeftOut) {
  const auto seen =
      ViewOfPicture({cv::Mat3f(40, 40, cv::Vec3f()), {}, {}, {}}, 30.0, "frame 3 (30.0 deg)");
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->view.outline.empty());
  ASSERT_EQ(seen->remarks.size(), 1u);
  EXPECT_EQ(seen->remarks[0], "frame 3 (30.0 deg): left out, it is all dark");
  const auto sizes = ViewOfPicture({cv::Mat3f(40, 40), cv::Mat3f(20, 40), {}, {}}, 0.0, "frame 0");
  ASSERT_FALSE(sizes);
  EXPECT_THAT(sizes.error().text, HasSubstr("40 x 20"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::placement
