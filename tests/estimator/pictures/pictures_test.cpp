// Proves which pictures an estimate gets, their names, sizes and exposure, that the same estimate
// gives the same bits on any number of threads, and that input with nothing to show does not crash.
// Does not prove what is in each picture: sphere_test and plots_test do.
#include "estimator/pictures/pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "estimator/target/renderer.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

struct Case {
  Case(int width, int keyframes, int channels = 3, int samples = 2)
      : camera(calib::CameraModel::Pinhole(width, width * 3 / 4, 1.6 * width, 1.6 * width,
                                           0.5 * width - 0.5, 0.375 * width - 0.5)) {
    LightEstimate light;
    light.light.direction = Vector3d(1, 0.5, 1).normalized();
    light.direction_at_reference = light.light.direction;
    output.estimate.lights.push_back(light);
    output.estimate.reflectance.albedo = {1.0, 0.7, 0.5};
    output.estimate.reflectance.ambient = 0.05;
    output.estimate.reflectance.diffuse = 0.3;
    output.estimate.reflectance.lobes[0].strength = 0.2;
    output.estimate.reflectance.lobes[0].shape = 40;
    output.estimate.history = {{0, 0.1}, {1, 0.001}};
    output.map.intensity = cv::Mat1f(90, 180, 0.2f);
    const calib::RayGrid rays(camera);
    model::Scene scene{{light.light}, output.estimate.reflectance};
    for (int i = 0; i < keyframes; ++i) {
      calib::Pose X_WC;
      X_WC.rotation << 0, 0.5, -std::sqrt(0.75), 1, 0, 0, 0, -std::sqrt(0.75), -0.5;
      X_WC.translation = -420.0 * X_WC.rotation.col(2);
      const target::Rendering rendering =
          target::Render(scene, geometry, rays, X_WC, {}, {.samples_per_side = samples});
      cv::Mat radiance = rendering.radiance;
      if (channels == 1) cv::extractChannel(radiance, radiance, 0);
      const cv::Mat1b nothing(radiance.size(), uchar{0});
      this->keyframes.push_back({{radiance, nothing, {}}, 255 - nothing, X_WC, {}});
    }
    for (const std::size_t i : ShownKeyframes(this->keyframes.size()))
      output.residuals[i] = cv::Mat1f(this->keyframes[i].image.radiance.size(), 0.001f);
  }
  std::vector<NamedPicture> Make() const {
    return MakePictures(model::SourceOf(keyframes), geometry, camera, output).value();
  }

  calib::CameraModel camera;
  target::Geometry geometry{calib::TargetShape(calib::SphereShape{50})};
  std::vector<model::Keyframe> keyframes;
  EstimateOutput output;
};

std::vector<std::string> Names(const std::vector<NamedPicture>& pictures) {
  std::vector<std::string> names;
  names.reserve(pictures.size());
  for (const NamedPicture& picture : pictures) names.push_back(picture.name);
  return names;
}

TEST(MakePictures, AtMostSixEvenlySpacedKeyframes) {
  EXPECT_THAT(Names(Case(64, 9).Make()),
              testing::ElementsAre("comparison_000.png", "comparison_001.png", "comparison_003.png",
                                   "comparison_004.png", "comparison_006.png", "comparison_007.png",
                                   "residual_000.png", "residual_001.png", "residual_003.png",
                                   "residual_004.png", "residual_006.png", "residual_007.png",
                                   "intensity_map.png", "convergence.png"));
  EXPECT_THAT(Names(Case(64, 1).Make()),
              testing::ElementsAre("comparison_000.png", "residual_000.png", "intensity_map.png",
                                   "convergence.png"));
}

TEST(MakePictures, CorrelationsOfTwoErrorsAreDrawn) {
  Case scene(64, 1);
  scene.output.estimate.correlation.quantities = {{"ambient", "", {}, 0.1},
                                                  {"diffuse", "", {}, 0.1}};
  scene.output.estimate.correlation.matrix = Eigen::Matrix2d::Identity();
  EXPECT_EQ(Names(scene.Make()).back(), "correlation.png");
}

TEST(MakePictures, NothingToShowIsLeftOut) {
  Case nothing(64, 0);
  nothing.output = {};
  EXPECT_TRUE(nothing.Make().empty());
}

TEST(MakePictures, SmallPicturesAreEnlargedAndLargeOnesReduced) {
  const auto panel_width = [](int width) {
    return (Case(width, 1).Make()[0].image.cols - 2 * 24 - 2 * 16) / 3;
  };
  EXPECT_EQ(panel_width(100), 500);
  EXPECT_EQ(panel_width(320), 640);
  EXPECT_EQ(panel_width(480), 480);
  EXPECT_EQ(panel_width(1000), 500);
}

TEST(MakePictures, RelitPanelEqualsTheOriginalOfANoiselessScene) {
  // Sampled as the pictures are: 6 x 6 where they are enlarged, and 4 x 4 of two pixels as one.
  const std::pair<int, int> cases[] = {{100, 6}, {1000, 2}};
  for (const auto& [width, samples] : cases) {
    const cv::Mat3b page = Case(width, 1, 3, samples).Make()[0].image;
    const int size = 500, height = 375;
    const cv::Mat3b original = page({24, 44, size, height});
    const cv::Mat3b relit = page({24 + size + 16, 44, size, height});
    EXPECT_GT(cv::mean(original)[0], 10.0);
    EXPECT_LE(cv::norm(original, relit, cv::NORM_INF), 1.0) << width;
  }
}

TEST(MakePictures, ExposureShowsTheBrightestAtNineTenths) {
  Case flat(100, 1);
  flat.output.estimate.lights.clear();
  flat.keyframes[0].image.radiance.setTo(cv::Scalar(0.02, 0.01, 0.005));
  const cv::Mat3b page = flat.Make()[0].image;
  // 0.9, 0.45 and 0.225 in sRGB.
  const cv::Vec3b& shown = page(60, 40);
  EXPECT_NEAR(shown[0], 243, 1);
  EXPECT_NEAR(shown[1], 179, 1);
  EXPECT_NEAR(shown[2], 130, 1);
}

TEST(MakePictures, GreyAndStrangePicturesAreDrawn) {
  EXPECT_EQ(Case(64, 1, 1).Make().size(), 4u);
  Case strange(64, 2);
  strange.keyframes[0].image.radiance.setTo(cv::Scalar::all(NAN));
  strange.keyframes[1].image.radiance.setTo(cv::Scalar::all(0.0));
  strange.output.residuals[0].setTo(NAN);
  strange.output.map.intensity.setTo(NAN);
  strange.output.estimate.lights.clear();
  EXPECT_EQ(strange.Make().size(), 6u);
}

TEST(MakePictures, SameBitsForAnyNumberOfThreads) {
  const Case scene(160, 2);
  SetThreads(1);
  const auto one = scene.Make();
  for (const int threads : {2, 7}) {
    SetThreads(threads);
    const auto again = scene.Make();
    ASSERT_EQ(again.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_EQ(cv::norm(one[i].image, again[i].image, cv::NORM_INF), 0.0) << one[i].name;
  }
  SetThreads(0);
}

TEST(MakePictures, AResidualThatWasAskedForBesidesIsDrawn) {
  Case scene(64, 9);
  scene.output.residuals[8] = scene.output.residuals[0].clone();
  EXPECT_THAT(Names(scene.Make()), testing::Contains("residual_008.png"));
}

TEST(MakePictures, AKeyframeThatCannotBeReadIsAnError) {
  const Case scene(64, 2);
  model::KeyframeSource source = model::SourceOf(scene.keyframes);
  source.read = [](std::size_t) -> Result<model::Keyframe> { return InputError("gone"); };
  const auto made = MakePictures(source, scene.geometry, scene.camera, scene.output);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().text, "gone");
}

}  // namespace
}  // namespace turnlight::estimator::pictures
