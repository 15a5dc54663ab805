// Proves, on a sphere whose hits have a closed form: which pixels are off the target, near the
// outline, grazing or beside a clipped one, and that stored normals, mirrored directions and their
// changes across a pixel are those of the surface, averaged over it; that a large picture, traced
// in steps, gives what the same pixels give in a small one; and that keyframes come in their order,
// few at a time. Does not prove it of meshes (observations_test) or that the margins
// are the best ones.
#include "estimator/observe/keyframe_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

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

struct Traced {
  cv::Mat1b flags;
  std::vector<TracedPixel> pixels;
};

Traced TraceAll(const model::Keyframe& keyframe, const target::Geometry& geometry,
                const calib::RayGrid& rays, int band = 1000, const BlockChoice& choice = {}) {
  KeyframeTracer tracer(keyframe, 0, geometry, rays);
  Traced out;
  for (int row = 0; row < rays.height(); row += band)
    for (const auto& traced : tracer.Rows(row, std::min(row + band, rays.height()), choice))
      out.pixels.insert(out.pixels.end(), traced.begin(), traced.end());
  out.flags = tracer.flags();
  return out;
}

TEST(KeyframeTracer, FlagsAreThoseOfTheSphere) {
  TinyBall ball(OneLight(), 1);
  model::Keyframe& keyframe = ball.keyframes[0];
  keyframe.mask.colRange(40, 64).setTo(0);
  keyframe.image.saturated(20, 25) = 255;
  const Traced frame = TraceAll(keyframe, ball.geometry, ball.rays);
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
      if (!inside) {
        EXPECT_NE(flag & kSilhouette, 0);
      }
      if (well_inside) {
        EXPECT_EQ(flag & kSilhouette, 0);
      }
      const SphereHit hit = *HitAt(keyframe.X_WC, column, row);
      EXPECT_EQ((flag & kGrazing) != 0, hit.normal.dot(hit.to_viewer) < 0.25);
      silhouettes += (flag & kSilhouette) != 0 ? 1 : 0;
      grazing += (flag & kGrazing) != 0 ? 1 : 0;
    }
  EXPECT_GT(silhouettes, 100);
  EXPECT_GT(grazing, 30);
}

TEST(KeyframeTracer, GeometryIsTheMeanOverThePixel) {
  const TinyBall ball(OneLight(), 1);
  const calib::Pose& X_WC = ball.keyframes[0].X_WC;
  const Traced frame = TraceAll(ball.keyframes[0], ball.geometry, ball.rays);
  ASSERT_GT(frame.pixels.size(), 500u);
  constexpr int kSide = 9;
  for (const TracedPixel& traced : frame.pixels) {
    const double column = traced.pixel % 64, row = traced.pixel / 64;
    Vector3d normal = Vector3d::Zero(), mirrored = Vector3d::Zero();
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const auto hit = HitAt(X_WC, column + kAperture * ((c + 0.5) / kSide - 0.5),
                               row + kAperture * ((r + 0.5) / kSide - 0.5));
        ASSERT_TRUE(hit.has_value());
        normal += hit->normal / (kSide * kSide);
        mirrored += hit->Mirrored() / (kSide * kSide);
      }
    const PixelGeometry& pixel = traced.geometry;
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
TEST(KeyframeTracer, APlaneIsGrazingLater) {
  const target::Geometry plane{calib::TargetShape(calib::PlaneShape{2.0, 2.0})};
  const TinyBall ball(OneLight(), 1);
  for (const double height : {0.05, 0.15}) {  // the cosine, about
    model::Keyframe keyframe = ball.keyframes[0];
    keyframe.X_WC = LookingAtOrigin(8.4 * Vector3d(1.0, 0.0, height).normalized());
    const Traced frame = TraceAll(keyframe, plane, ball.rays);
    int on_target = 0, grazing = 0;
    for (const std::uint8_t flag : frame.flags) {
      on_target += (flag & kOffTarget) == 0 ? 1 : 0;
      grazing += (flag & kGrazing) != 0 ? 1 : 0;
    }
    EXPECT_GT(on_target, 20);
    EXPECT_EQ(grazing, height < 0.1 ? on_target : 0);
  }
}

// A ball that fills the middle of a large picture, and that middle alone.
struct LargeBall {
  static constexpr int kWidth = 1400, kHeight = 800, kSide = 600, kLeft = 400, kTop = 100;
  target::Geometry geometry{calib::TargetShape(calib::SphereShape{1.0})};
  calib::RayGrid rays{calib::CameraModel::Pinhole(kWidth, kHeight, 2000.0, 2000.0, 699.5, 399.5)};
  calib::RayGrid middle_rays{
      calib::CameraModel::Pinhole(kSide, kSide, 2000.0, 2000.0, 699.5 - kLeft, 399.5 - kTop)};
  model::Keyframe keyframe, middle;

  LargeBall() {
    keyframe.X_WC = LookingAtOrigin(8.4 * Vector3d(1.0, 0.5, 0.3).normalized());
    cv::Mat3f radiance(kHeight, kWidth, cv::Vec3f(0.2f, 0.3f, 0.4f));
    for (int row = 0; row < kHeight; ++row) radiance.row(row) *= 1.0 + 1e-3 * row;
    radiance(400, 700) = {1e9f, 0.1f, 0.1f};
    keyframe.image.radiance = radiance;
    keyframe.image.saturated = cv::Mat1b::zeros(kHeight, kWidth);
    keyframe.image.saturated(350, 650) = 255;
    keyframe.mask = cv::Mat1b(kHeight, kWidth, std::uint8_t{255});
    keyframe.mask.rowRange(0, 300).setTo(0);
    const cv::Rect box(kLeft, kTop, kSide, kSide);
    middle = keyframe;
    middle.image.radiance = radiance(box).clone();
    middle.image.saturated = keyframe.image.saturated(box).clone();
    middle.mask = keyframe.mask(box).clone();
  }
};

// Rays of the two differ by rounding.
TEST(KeyframeTracer, ALargePictureGivesWhatASmallOneDoes) {
  const LargeBall ball;
  const Traced small = TraceAll(ball.middle, ball.geometry, ball.middle_rays);
  const Traced large = TraceAll(ball.keyframe, ball.geometry, ball.rays, 77);
  const cv::Rect box(LargeBall::kLeft, LargeBall::kTop, LargeBall::kSide, LargeBall::kSide);
  EXPECT_EQ(cv::norm(large.flags(box), small.flags, cv::NORM_INF), 0.0);
  ASSERT_GT(small.pixels.size(), 50000u);
  ASSERT_EQ(large.pixels.size(), small.pixels.size());
  const PixelTracer tracer({ball.keyframe.X_WC, ball.keyframe.X_WT}, ball.geometry, ball.rays);
  for (std::size_t i = 0; i < small.pixels.size(); ++i) {
    const std::uint32_t row = small.pixels[i].pixel / LargeBall::kSide + LargeBall::kTop;
    const std::uint32_t column = small.pixels[i].pixel % LargeBall::kSide + LargeBall::kLeft;
    ASSERT_EQ(large.pixels[i].pixel, row * LargeBall::kWidth + column);
    const PixelGeometry &got = large.pixels[i].geometry, &near = small.pixels[i].geometry;
    const PixelGeometry one = *tracer.Trace(static_cast<int>(column), static_cast<int>(row));
    ASSERT_TRUE(got.position == one.position && got.mirrored == one.mirrored &&
                got.dw_du == one.dw_du && got.cosine == one.cosine);
    ASSERT_LT((got.position - near.position).norm(), 1e-9);
    ASSERT_LT((got.normal - near.normal).norm(), 1e-9);
  }
}

TEST(KeyframeTracer, BlocksThatAreNotKeptGiveNoPixels) {
  const LargeBall ball;
  const BlockChoice half{0.5};
  for (const bool large : {false, true}) {
    const model::Keyframe& keyframe = large ? ball.keyframe : ball.middle;
    const calib::RayGrid& rays = large ? ball.rays : ball.middle_rays;
    std::vector<std::uint32_t> expected, got;
    for (const TracedPixel& traced : TraceAll(keyframe, ball.geometry, rays).pixels)
      if (half.Keeps(0, static_cast<int>(traced.pixel) % rays.width(),
                     static_cast<int>(traced.pixel) / rays.width()))
        expected.push_back(traced.pixel);
    for (const TracedPixel& traced : TraceAll(keyframe, ball.geometry, rays, 50, half).pixels)
      got.push_back(traced.pixel);
    EXPECT_EQ(got, expected);
    EXPECT_GT(got.size(), 20000u);
  }
}

TEST(TraceKeyframes, ComeInTheirOrderAndEndAtTheFirstRefusal) {
  const TinyBall ball(OneLight(), 5);
  model::KeyframeSource source = model::SourceOf(ball.keyframes);
  std::vector<std::size_t> seen;
  const auto put = [&](std::size_t k, const model::Keyframe& keyframe, KeyframeTracer& tracer) {
    seen.push_back(k);
    EXPECT_EQ(keyframe.X_WC.translation, ball.keyframes[k].X_WC.translation);
    EXPECT_GT(tracer.candidates(), 500u);
  };
  EXPECT_TRUE(TraceKeyframes(source, ball.geometry, ball.rays, nullptr, put));
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  seen.clear();
  source.read = [&](std::size_t k) -> Result<model::Keyframe> {
    if (k >= 2) return InputError("frame " + std::to_string(k));
    return ball.keyframes[k];
  };
  const Status refused = TraceKeyframes(source, ball.geometry, ball.rays, nullptr, put);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text, "frame 2");
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1}));
  const StopFlag stop{true};
  const Status stopped = TraceKeyframes(source, ball.geometry, ball.rays, &stop, put);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

TEST(KeyframesInFlight, AreFewWhateverTheirSize) {
  EXPECT_EQ(KeyframesInFlight(24'000'000), 2u);
  EXPECT_EQ(KeyframesInFlight(320 * 240), 27u);
  EXPECT_TRUE(IsTracedWhole(320 * 240));
  EXPECT_FALSE(IsTracedWhole(24'000'000));
}

}  // namespace
}  // namespace turnlight::estimator::observe
