// Proves, on a sphere whose hits have a closed form: which pixels are off the target, near the
// outline, grazing or beside a clipped one, and that stored normals, mirrored directions and their
// changes across a pixel are those of the surface, averaged over it. Does not prove it of meshes
// (observations_test) or that the margins are the best ones.
#include "estimator/observe/trace_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

constexpr double kFocal = 160.0, kCenterX = 31.5, kCenterY = 23.5;

model::Scene OneLight() {
  model::Scene scene;
  scene.lights.emplace_back();
  return scene;
}

struct SphereHit {
  Vector3d normal, to_viewer;  // in W; the position is the normal, for the radius is 1
  Vector3d Mirrored() const { return 2.0 * normal.dot(to_viewer) * normal - to_viewer; }
};

// Of the image point (x, y): the nearer root of |eye + t ray| = 1.
std::optional<SphereHit> HitAt(const calib::Pose& X_WC, double x, double y) {
  const Vector3d ray =
      (X_WC.rotation * Vector3d((x - kCenterX) / kFocal, (y - kCenterY) / kFocal, 1.0))
          .normalized();
  const double along = ray.dot(X_WC.translation);
  const double root = along * along - X_WC.translation.squaredNorm() + 1.0;
  if (root < 0.0) return std::nullopt;
  return SphereHit{X_WC.translation + (-along - std::sqrt(root)) * ray, -ray};
}

TEST(TraceKeyframe, FlagsAreThoseOfTheSphere) {
  TinyBall ball(OneLight(), 1);
  model::Keyframe& keyframe = ball.keyframes[0];
  keyframe.mask.colRange(40, 64).setTo(0);
  keyframe.image.saturated(20, 25) = 255;
  const FramePixels frame = TraceKeyframe(keyframe, ball.geometry, ball.rays);
  const auto on_target = [&](int row, int column) {
    return column < 40 && HitAt(keyframe.X_WC, column, row).has_value();
  };
  int silhouettes = 0, grazing = 0;
  for (int row = 0; row < 48; ++row)
    for (int column = 0; column < 64; ++column) {
      const std::uint8_t flag = frame.flags(row, column);
      SCOPED_TRACE(testing::Message() << row << ", " << column);
      ASSERT_EQ((flag & kOffTarget) == 0, on_target(row, column));
      EXPECT_EQ((flag & kSaturated) != 0, std::abs(row - 20) <= 1 && std::abs(column - 25) <= 1);
      if ((flag & kOffTarget) != 0) continue;
      bool inside = true, well_inside = true;  // two and four pixels from the outline
      for (int r = std::max(row - 4, 0); r <= std::min(row + 4, 47); ++r)
        for (int c = std::max(column - 4, 0); c <= std::min(column + 4, 63); ++c) {
          if (on_target(r, c)) continue;
          well_inside = false;
          if (std::abs(r - row) <= 2 && std::abs(c - column) <= 2) inside = false;
        }
      if (!inside) EXPECT_NE(flag & kSilhouette, 0);
      if (well_inside) EXPECT_EQ(flag & kSilhouette, 0);
      const SphereHit hit = *HitAt(keyframe.X_WC, column, row);
      EXPECT_EQ((flag & kGrazing) != 0, hit.normal.dot(hit.to_viewer) < 0.25);
      silhouettes += (flag & kSilhouette) != 0 ? 1 : 0;
      grazing += (flag & kGrazing) != 0 ? 1 : 0;
    }
  EXPECT_GT(silhouettes, 100);
  EXPECT_GT(grazing, 30);
}

TEST(TraceKeyframe, GeometryIsTheMeanOverThePixel) {
  const TinyBall ball(OneLight(), 1);
  const calib::Pose& X_WC = ball.keyframes[0].X_WC;
  const FramePixels frame = TraceKeyframe(ball.keyframes[0], ball.geometry, ball.rays);
  ASSERT_EQ(frame.pixel.size(), frame.geometry.size());
  ASSERT_GT(frame.pixel.size(), 500u);
  constexpr int kSide = 9;
  for (std::size_t i = 0; i < frame.pixel.size(); ++i) {
    const double column = frame.pixel[i] % 64, row = frame.pixel[i] / 64;
    Vector3d normal = Vector3d::Zero(), mirrored = Vector3d::Zero();
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const auto hit = HitAt(X_WC, column + kAperture * ((c + 0.5) / kSide - 0.5),
                               row + kAperture * ((r + 0.5) / kSide - 0.5));
        ASSERT_TRUE(hit.has_value());
        normal += hit->normal / (kSide * kSide);
        mirrored += hit->Mirrored() / (kSide * kSide);
      }
    const PixelGeometry& pixel = frame.geometry[i];
    const SphereHit center = *HitAt(X_WC, column, row);
    const double cosine = center.normal.dot(center.to_viewer);
    EXPECT_NEAR(pixel.cosine, cosine, 1e-6);
    // What is left is of the fourth order: it grows where the surface is seen flat.
    const double order = std::pow(1.0 / (8.4 * kFocal) * 8.4 * 8.4 / cosine, 4) / cosine;
    EXPECT_LT((pixel.normal - normal).norm(), 1e-6 + order) << cosine;
    EXPECT_LT((pixel.mirrored - mirrored.normalized()).norm(), 1e-6 + 20.0 * order) << cosine;
    // On the surface, and not below it as the mean of a bent one is.
    EXPECT_NEAR(pixel.position.norm(), 1.0, 1e-4 / (cosine * cosine));
    EXPECT_LT((pixel.face_normal - center.normal).norm(), 1e-6);
    const Vector3d dw =
        HitAt(X_WC, column + 0.5, row)->Mirrored() - HitAt(X_WC, column - 0.5, row)->Mirrored();
    const Vector3d dx =
        HitAt(X_WC, column, row + 0.5)->normal - HitAt(X_WC, column, row - 0.5)->normal;
    EXPECT_LT((pixel.dw_du - dw).norm(), 1e-5);
    EXPECT_LT((pixel.dx_dv - dx).norm(), 1e-5);
    EXPECT_TRUE(pixel.smooth);
  }
}

// A plane may be seen flatter: its footprint stays linear for longer.
TEST(TraceKeyframe, APlaneIsGrazingLater) {
  const target::Geometry plane{calib::TargetShape(calib::PlaneShape{2.0, 2.0})};
  const TinyBall ball(OneLight(), 1);
  for (const double height : {0.05, 0.15}) {  // the cosine, about
    model::Keyframe keyframe = ball.keyframes[0];
    keyframe.X_WC = LookingAtOrigin(8.4 * Vector3d(1.0, 0.0, height).normalized());
    const FramePixels frame = TraceKeyframe(keyframe, plane, ball.rays);
    int on_target = 0, grazing = 0;
    for (const std::uint8_t flag : frame.flags) {
      on_target += (flag & kOffTarget) == 0 ? 1 : 0;
      grazing += (flag & kGrazing) != 0 ? 1 : 0;
    }
    EXPECT_GT(on_target, 20);
    EXPECT_EQ(grazing, height < 0.1 ? on_target : 0);
  }
}

}  // namespace
}  // namespace turnlight::estimator::observe
