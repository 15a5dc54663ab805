// Proves that the virtual sphere, its shading and its shadows are where closed formulas put them,
// for distant and near lights, on a board, on the ground and on the target; that taking a picture
// apart and relighting it leaves no seam; that places are in view. Does not prove that the pictures
// please: that takes eyes.
#include "estimator/pictures/sphere.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "base/angles.h"
#include "base/parallel.h"
#include "estimator/pictures/view.h"
#include "estimator/target/renderer.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

calib::Pose LookAt(const Vector3d& eye, const Vector3d& at) {
  const Vector3d z = (at - eye).normalized();
  const Vector3d up = std::abs(z.z()) > 0.99 ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d x = z.cross(up).normalized();
  calib::Pose pose;
  pose.rotation << x, z.cross(x), z;
  pose.translation = eye;
  return pose;
}

model::Light DistantLight(double azimuth_deg, double zenith_deg, double intensity = 1.0) {
  const double azimuth = DegToRad(azimuth_deg), zenith = DegToRad(zenith_deg);
  model::Light light;
  light.direction = {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                     std::cos(zenith)};
  light.intensity = intensity;
  return light;
}

model::Light NearLight(const Vector3d& position) {
  model::Light light;
  light.direction = position.normalized();
  light.inverse_distance = 1.0 / position.norm();
  return light;
}

model::Scene MatteScene(std::vector<model::Light> lights) {
  model::Scene scene;
  scene.lights = std::move(lights);
  scene.reflectance.albedo = {0.8, 0.5, 0.3};
  scene.reflectance.ambient = 0.1;
  scene.reflectance.diffuse = 0.6;
  scene.reflectance.lobes[0].model = model::SpecularModel::kNone;
  return scene;
}

// Everything that a view refers to, and the picture of the target over a background.
struct Stage {
  Stage(model::Scene scene_in, calib::TargetShape shape, const calib::Pose& X_WC,
        const cv::Vec3f& background)
      : scene(std::move(scene_in)), geometry(std::move(shape)) {
    const target::Rendering rendering =
        target::Render(scene, geometry, rays, X_WC, {}, {.samples_per_side = 4});
    photograph = rendering.radiance.clone();
    coverage = rendering.coverage;
    for (int row = 0; row < photograph.rows; ++row)
      for (int column = 0; column < photograph.cols; ++column)
        photograph(row, column) += (1.0f - coverage(row, column)) * background;
    radiance = rendering.radiance;
    pose = X_WC;
  }
  PictureView View() const { return {scene, geometry, camera, rays, pose, {}}; }
  cv::Mat3f WithSphere(const VirtualSphere& sphere) const {
    return InsertSphere(photograph, TakeApart(photograph, coverage), View(), sphere);
  }

  model::Scene scene;
  target::Geometry geometry;
  calib::CameraModel camera = calib::CameraModel::Pinhole(160, 120, 260, 260, 79.5, 59.5);
  calib::RayGrid rays{camera};
  calib::Pose pose;
  cv::Mat3f photograph, radiance;
  cv::Mat1f coverage;
};

// How far a point is from the axis of the shadow that a ball throws, relative to the shadow's
// radius there; infinite on the lit side of the ball.
double InShadow(const model::Light& light, const VirtualSphere& ball, const Vector3d& q) {
  if (light.inverse_distance == 0.0) {
    if (light.direction.dot(q - ball.center) > 0.0) return std::numeric_limits<double>::infinity();
    return light.direction.cross(q - ball.center).norm() / ball.radius;
  }
  const Vector3d lamp = light.direction / light.inverse_distance;
  const Vector3d to_ball = ball.center - lamp, to_point = q - lamp;
  if (to_point.norm() < to_ball.norm()) return std::numeric_limits<double>::infinity();
  const double angle = std::acos(to_ball.normalized().dot(to_point.normalized()));
  return angle / std::asin(ball.radius / to_ball.norm());
}

// Every pixel that shows the board of z = 0 and is not close to an edge of anything: it keeps its
// bits outside the shadow, and is scaled by the model's share inside.
void CheckShadowOnBoard(const model::Light& light) {
  const Stage stage(MatteScene({light}), calib::PlaneShape{400, 400, 1},
                    LookAt({0, -200, 300}, {0, 0, 0}), {0, 0, 0});
  const VirtualSphere ball{{20, 10, 20}, 20, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  int dark = 0, lit = 0;
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const Vector3d ray = stage.pose.rotation * stage.rays.Ray(column, row);
      const Vector3d eye = stage.pose.translation;
      const Vector3d q = eye - eye.z() / ray.z() * ray;
      if (stage.coverage(row, column) < 1.0f || ray.cross(ball.center - eye).norm() < 23.0)
        continue;
      const double in_shadow = InShadow(light, ball, q);
      const cv::Vec3f& before = stage.photograph(row, column);
      const cv::Vec3f& after = result(row, column);
      if (in_shadow > 1.2) {
        ++lit;
        EXPECT_EQ(before, after) << column << ' ' << row;
      } else if (in_shadow < 0.8) {
        ++dark;
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(after[c], 0.1 * stage.scene.reflectance.albedo[c], 1e-5)
              << column << ' ' << row;
      }
    }
  }
  EXPECT_GT(dark, 100);
  EXPECT_GT(lit, 5000);
}

TEST(InsertSphere, ShadowOfADistantLightLiesWhereGeometrySays) {
  CheckShadowOnBoard(DistantLight(200, 50));
  CheckShadowOnBoard(DistantLight(60, 35));
}

TEST(InsertSphere, ShadowOfANearLightLiesWhereGeometrySays) {
  CheckShadowOnBoard(NearLight({-90, -60, 150}));
  CheckShadowOnBoard(NearLight({140, 20, 130}));
}

TEST(InsertSphere, EachLightThrowsItsOwnShadowInItsOwnColour) {
  model::Light red = DistantLight(180, 50, 0.7), blue = DistantLight(270, 40, 0.5);
  red.color = {1, 0.2, 0.1};
  blue.color = {0.1, 0.3, 1};
  const Stage stage(MatteScene({red, blue}), calib::PlaneShape{400, 400, 1},
                    LookAt({0, 0, 400}, {0, 0, 0}), {0, 0, 0});
  const VirtualSphere ball{{0, 0, 15}, 15, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  const auto check = [&](const model::Light& hidden, const model::Light& other) {
    // Beyond the shadow's middle, clear of the ball; only the other light is left there.
    const Vector3d q = ball.center - 15.0 / hidden.direction.z() * hidden.direction;
    const Vector3d on_board = q + 5.0 * Vector3d(q.x(), q.y(), 0.0).normalized();
    ASSERT_LT(InShadow(hidden, ball, on_board), 0.8);
    ASSERT_GT(InShadow(other, ball, on_board), 1.2);
    const auto pixel = stage.camera.Project({stage.pose.Inverse() * on_board})[0];
    const cv::Vec3f& shown =
        result(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(shown[c],
                  stage.scene.reflectance.albedo[c] *
                      (0.1 + 0.6 * other.intensity * other.color[c] * other.direction.z()),
                  1e-5);
  };
  check(red, blue);
  check(blue, red);
}

// The pixels of the ball that are whole, with the point and normal at their centre.
template <typename Check>
int ForBallPixels(const Stage& stage, const VirtualSphere& ball, const Check& check) {
  int count = 0;
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const Vector3d ray = stage.pose.rotation * stage.rays.Ray(column, row);
      const Vector3d to_ball = ball.center - stage.pose.translation;
      const double off = ray.cross(to_ball).norm();
      if (off > ball.radius - 3.0) continue;
      const double t = to_ball.dot(ray) - std::sqrt(ball.radius * ball.radius - off * off);
      const Vector3d p = stage.pose.translation + t * ray;
      check(row, column, p, Vector3d((p - ball.center) / ball.radius));
      ++count;
    }
  }
  return count;
}

TEST(InsertSphere, SphereIsLambertianWhereLitAndAmbientWhereNot) {
  const model::Light light = DistantLight(20, 60);
  const Stage stage(MatteScene({light}), calib::PlaneShape{400, 400, 1},
                    LookAt({0, -200, 300}, {0, 0, 0}), {0, 0, 0});
  const VirtualSphere ball{{-20, 10, 30}, 30, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  int unlit = 0;
  const int pixels =
      ForBallPixels(stage, ball, [&](int row, int column, const Vector3d&, const Vector3d& n) {
        const double nl = n.dot(light.direction);
        if (std::abs(nl) < 0.1) return;  // the terminator crosses the pixel
        unlit += nl < 0.0;
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(result(row, column)[c],
                      stage.scene.reflectance.albedo[c] * (0.1 + 0.6 * std::max(nl, 0.0)), 2e-3);
      });
  EXPECT_GT(pixels, 500);
  EXPECT_GT(unlit, 50);
}

TEST(InsertSphere, HighlightIsWhereTheMirroredRayMeetsTheLight) {
  model::Scene scene = MatteScene({DistantLight(250, 40)});
  scene.reflectance.lobes[0].model = model::SpecularModel::kPhong;
  scene.reflectance.lobes[0].strength = 0.5;
  scene.reflectance.lobes[0].shape = 300;
  const Stage stage(scene, calib::PlaneShape{400, 400, 1}, LookAt({0, -200, 300}, {0, 0, 0}),
                    {0, 0, 0});
  const VirtualSphere ball{{-20, 10, 30}, 30, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  double brightest = 0.0, mirrored_best = -1.0;
  int best[2][2] = {};
  ForBallPixels(stage, ball, [&](int row, int column, const Vector3d& p, const Vector3d& n) {
    const Vector3d v = (stage.pose.translation - p).normalized();
    const double mirrored = (2.0 * n.dot(v) * n - v).dot(stage.scene.lights[0].direction);
    if (mirrored > mirrored_best) {
      mirrored_best = mirrored;
      best[0][0] = row;
      best[0][1] = column;
    }
    if (result(row, column)[1] > brightest) {
      brightest = result(row, column)[1];
      best[1][0] = row;
      best[1][1] = column;
    }
  });
  EXPECT_NEAR(best[0][0], best[1][0], 1);
  EXPECT_NEAR(best[0][1], best[1][1], 1);
}

TEST(InsertSphere, TargetInFrontHidesTheSphere) {
  const Stage stage(MatteScene({DistantLight(0, 10)}), calib::SphereShape{50},
                    LookAt({0, -400, 0}, {0, 0, 0}), {0.3f, 0.3f, 0.3f});
  const cv::Mat3f result = stage.WithSphere({{0, 120, 0}, 30, std::nullopt});
  EXPECT_EQ(cv::norm(result, stage.photograph, cv::NORM_INF), 0.0);
}

TEST(InsertSphere, TargetShadesTheSphere) {
  // The light comes along +y through the target onto a smaller ball behind it, seen from the side.
  model::Light light;
  light.direction = -Vector3d::UnitY();
  const Stage stage(MatteScene({light}), calib::SphereShape{50}, LookAt({400, 0, 0}, {0, 0, 0}),
                    {0, 0, 0});
  const VirtualSphere ball{{0, 90, 0}, 25, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  const int pixels =
      ForBallPixels(stage, ball, [&](int row, int column, const Vector3d&, const Vector3d&) {
        EXPECT_NEAR(result(row, column)[0], 0.8 * 0.1, 1e-6);
      });
  EXPECT_GT(pixels, 200);
}

TEST(InsertSphere, SphereShadesTheTarget) {
  model::Light light;
  light.direction = -Vector3d::UnitY();
  const Stage stage(MatteScene({light}), calib::SphereShape{50}, LookAt({250, -250, 0}, {0, 0, 0}),
                    {0, 0, 0});
  const VirtualSphere ball{{0, -120, 0}, 25, std::nullopt};
  const cv::Mat3f result = stage.WithSphere(ball);
  const auto pixel = stage.camera.Project({stage.pose.Inverse() * Vector3d(0, -50, 0)})[0];
  const cv::Point at(static_cast<int>(std::lround(pixel.x())),
                     static_cast<int>(std::lround(pixel.y())));
  EXPECT_GT(stage.photograph(at)[0], 0.4f);
  EXPECT_NEAR(result(at)[0], 0.8 * 0.1, 1e-5);
}

TEST(InsertSphere, GroundShadowDarkensByIrradianceAndNothingWhereBlack) {
  const model::Light light = DistantLight(180, 40);
  const VirtualSphere ball{{0, -80, -30}, 20, GroundPlane{Vector3d::UnitZ(), -50}};
  for (const float background : {0.0f, 0.4f}) {
    const Stage stage(MatteScene({light}), calib::SphereShape{50}, LookAt({300, 0, 200}, {0, 0, 0}),
                      {background, background, background});
    const cv::Mat3f result = stage.WithSphere(ball);
    // Beyond the shadow's middle, where the ball does not hide it.
    const Vector3d q =
        ball.center - 20.0 / light.direction.z() * light.direction + 10.0 * Vector3d::UnitX();
    const auto pixel = stage.camera.Project({stage.pose.Inverse() * q})[0];
    const double full = 0.1 + 0.6 * light.direction.z();
    EXPECT_NEAR(result(static_cast<int>(std::lround(pixel.y())),
                       static_cast<int>(std::lround(pixel.x())))[1],
                background * 0.1 / full, 1e-5);
  }
}

TEST(InsertSphere, SameBitsForAnyNumberOfThreads) {
  const Stage stage(MatteScene({DistantLight(90, 40)}), calib::SphereShape{50},
                    LookAt({300, 0, 200}, {0, 0, 0}), {0.4f, 0.4f, 0.4f});
  const VirtualSphere ball{{0, -80, -30}, 20, GroundPlane{Vector3d::UnitZ(), -50}};
  SetThreads(1);
  const cv::Mat3f one = stage.WithSphere(ball);
  for (const int threads : {2, 7}) {
    SetThreads(threads);
    EXPECT_EQ(cv::norm(one, stage.WithSphere(ball), cv::NORM_INF), 0.0);
  }
  SetThreads(0);
}

TEST(TakeApart, PartsMakeThePictureAgain) {
  const Stage stage(MatteScene({DistantLight(90, 40)}), calib::SphereShape{50},
                    LookAt({300, 0, 200}, {0, 0, 0}), {0.4f, 0.3f, 0.2f});
  const Matte matte = TakeApart(stage.photograph, stage.coverage);
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const float share = stage.coverage(row, column);
      const cv::Vec3f again =
          share * matte.target(row, column) + (1.0f - share) * matte.background(row, column);
      EXPECT_LT(cv::norm(again, stage.photograph(row, column), cv::NORM_INF), 1e-6);
      if (share < 1.0f) {
        EXPECT_NEAR(matte.background(row, column)[0], 0.4f, 1e-5);
      }
    }
  }
}

TEST(TakeApart, OutlineOfThePhotographBeyondTheModelsIsTaken) {
  const cv::Vec3f background(0.1f, 0.1f, 0.1f), target(1, 1, 1);
  cv::Mat3f picture(40, 40, background);
  cv::Mat1f coverage(40, 40, 0.0f);
  cv::Mat1b mask(40, 40, uchar{0});
  picture(cv::Rect(0, 0, 22, 40)).setTo(cv::Scalar(target[0], target[1], target[2]));
  mask(cv::Rect(0, 0, 22, 40)).setTo(255);
  coverage(cv::Rect(0, 0, 20, 40)).setTo(1.0f);
  const cv::Mat3f black(40, 40, cv::Vec3f());
  EXPECT_EQ(Relit(TakeApart(picture, coverage), black)(20, 21), target);
  EXPECT_LT(cv::norm(Relit(TakeApart(picture, coverage, mask), black)(20, 21), background), 1e-6);
}

TEST(Relit, EqualsTheOriginalOfANoiselessScene) {
  model::Scene scene = MatteScene({DistantLight(90, 40), NearLight({150, 100, 250})});
  scene.reflectance.lobes[0].model = model::SpecularModel::kPhong;
  scene.reflectance.lobes[0].strength = 0.4;
  scene.reflectance.lobes[0].shape = 50;
  for (const calib::TargetShape& shape : {calib::TargetShape(calib::SphereShape{50}),
                                          calib::TargetShape(calib::PlaneShape{120, 90, 1})}) {
    const Stage stage(scene, shape, LookAt({300, 0, 200}, {0, 0, 0}), {0.4f, 0.3f, 0.2f});
    const cv::Mat3f relit = Relit(TakeApart(stage.photograph, stage.coverage), stage.radiance);
    EXPECT_LT(cv::norm(relit, stage.photograph, cv::NORM_INF), 1e-3);
  }
}

bool InView(const Stage& stage, const calib::Pose& X_WC, const VirtualSphere& sphere) {
  const calib::Pose X_CW = X_WC.Inverse();
  for (const Vector3d& d : {Vector3d(X_WC.rotation.col(0)), Vector3d(X_WC.rotation.col(1))}) {
    for (const double side : {-1.0, 1.0}) {
      const auto p =
          stage.camera.Project({X_CW * Vector3d(sphere.center + side * sphere.radius * d)})[0];
      if (!(p.x() > 0 && p.x() < 159 && p.y() > 0 && p.y() < 119)) return false;
    }
  }
  return true;
}

TEST(PlaceSpheres, OnABoardAtOnePlaceOffTheMiddleInAllViews) {
  const Stage stage(MatteScene({DistantLight(30, 35)}), calib::PlaneShape{120, 90, 1},
                    LookAt({200, 0, 200}, {0, 0, 0}), {0, 0, 0});
  std::vector<PictureView> views;
  for (int i = 0; i < 6; ++i) {
    PictureView view = stage.View();
    view.X_WC = LookAt({200 * std::cos(i * 1.05), 200 * std::sin(i * 1.05), 200}, {0, 0, 0});
    // The board turns with the table too.
    view.X_WT.rotation = Eigen::AngleAxisd(0.3 * i, Vector3d::UnitZ()).toRotationMatrix();
    views.push_back(view);
  }
  const auto spheres = PlaceSpheres(views);
  ASSERT_EQ(spheres.size(), 6u);
  const Vector3d first = views[0].X_WT.Inverse() * spheres[0].center;
  EXPECT_GT(first.head<2>().norm(), spheres[0].radius);
  for (int i = 0; i < 6; ++i) {
    const Vector3d p = views[i].X_WT.Inverse() * spheres[i].center;
    EXPECT_LT((p - first).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(p.z(), spheres[i].radius);
    EXPECT_LT(std::abs(p.x()) + spheres[i].radius, 60);
    EXPECT_LT(std::abs(p.y()) + spheres[i].radius, 45);
    EXPECT_TRUE(InView(stage, views[i].X_WC, spheres[i])) << i;
    EXPECT_FALSE(spheres[i].ground);
  }
}

TEST(PlaceSpheres, BesideASphereOnItsGroundInViewAndApart) {
  const Stage stage(MatteScene({DistantLight(30, 35)}), calib::SphereShape{30},
                    LookAt({200, 0, 100}, {0, 0, 0}), {0, 0, 0});
  for (int i = 0; i < 8; ++i) {
    PictureView view = stage.View();
    view.X_WC =
        LookAt({200 * std::cos(i * 0.8), 200 * std::sin(i * 0.8), 20.0 + 40 * i}, {0, 0, 0});
    const VirtualSphere sphere = PlaceSpheres({view})[0];
    EXPECT_TRUE(InView(stage, view.X_WC, sphere)) << i;
    EXPECT_GT(sphere.center.norm(), 30 + sphere.radius);
    ASSERT_TRUE(sphere.ground);
    EXPECT_NEAR(sphere.ground->normal.dot(sphere.center) - sphere.radius, sphere.ground->offset,
                1e-9);
    EXPECT_NEAR(sphere.ground->offset, -30, 1e-9);
    // Neither hides the other: the angle between them is more than the sum of their radii.
    const Vector3d eye = view.X_WC.translation;
    const double apart = std::acos((sphere.center - eye).normalized().dot(-eye.normalized()));
    EXPECT_GT(apart,
              std::asin(30 / eye.norm()) + std::asin(sphere.radius / (sphere.center - eye).norm()))
        << i;
  }
}

TEST(PlaceSpheres, TargetThatFillsThePictureGetsTheSphereInFront) {
  const Stage stage(MatteScene({DistantLight(30, 35)}), calib::SphereShape{50},
                    LookAt({90, 0, 40}, {0, 0, 0}), {0, 0, 0});
  const VirtualSphere sphere = PlaceSpheres({stage.View()})[0];
  EXPECT_TRUE(InView(stage, stage.pose, sphere));
  EXPECT_GT(cv::norm(stage.WithSphere(sphere), stage.photograph, cv::NORM_INF), 0.0);
}

TEST(ChooseGround, IsWorldsUpUnlessTheCameraLooksAlongIt) {
  const target::Geometry sphere{calib::TargetShape(calib::SphereShape{50})};
  const GroundPlane usual = ChooseGround(sphere, LookAt({300, 0, 200}, {0, 0, 0}), {});
  EXPECT_EQ(usual.normal, Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(usual.offset, -50);
  const calib::Pose from_above = LookAt({0, 0, 300}, {0, 0, 0});
  const GroundPlane tilted = ChooseGround(sphere, from_above, {});
  EXPECT_NEAR(tilted.normal.norm(), 1.0, 1e-12);
  EXPECT_NEAR(tilted.normal.dot(-from_above.rotation.col(1)), std::cos(DegToRad(20)), 1e-12);
  EXPECT_NEAR(tilted.offset, -50, 1e-9);
}

}  // namespace
}  // namespace turnlight::estimator::pictures
