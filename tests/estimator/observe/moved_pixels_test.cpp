// Proves: pixels seen again from where they were have the positions, normals and directions that
// they had; seen from elsewhere, those that a build of moved keyframes gives; and a lens that is
// shifted sees what pixels as far off saw. Does not prove what follows for an estimate.
#include "estimator/observe/moved_pixels.h"

#include <gtest/gtest.h>

#include "estimator/observe/observation_access.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::estimator::observe {
namespace {

class MovedPixels : public testing::Test {
 protected:
  MovedPixels() {
    rig::sim::SyntheticConfig config;
    config.camera = {80, 60, 130.0, {}};
    config.motion.frames = 3;
    session_ = *rig::sim::SynthesizeInMemory(config);
    keyframes_ = rig::sim::ToKeyframes(*session_);
    geometry_.emplace(session_->target);
    rays_.emplace(session_->camera);
    all_ = BuildObservations(keyframes_, *geometry_, *rays_);
    sample_ = SampleOfKeyframes(all_, 300, 1, nullptr);
    for (const model::Keyframe& keyframe : keyframes_)
      poses_.push_back({keyframe.X_WC, keyframe.X_WT});
  }

  // The largest difference of positions (in R) and of mirrored directions, from those that the
  // observations have of the same pixels.
  double Difference(const Observations& moved, const Observations& built) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      if (moved.pixel[i] == Observations::kNoPixel) continue;
      const std::size_t k = sample_.keyframe[i];
      for (std::size_t j = built.tile_begin[k] * kTile; j < built.tile_begin[k + 1] * kTile; ++j) {
        if (built.pixel[j] != moved.pixel[i]) continue;
        const Eigen::Vector3d shift = (built.reference - moved.reference) / built.radius;
        largest = std::max({largest, (At(moved.position, i) - At(built.position, j) - shift).norm(),
                            (At(moved.normal, i) - At(built.normal, j)).norm(),
                            (At(moved.mirrored, i) - At(built.mirrored, j)).norm()});
      }
    }
    return largest;
  }

  std::optional<rig::sim::SyntheticSession> session_;
  std::vector<model::Keyframe> keyframes_;
  std::optional<target::Geometry> geometry_;
  std::optional<calib::RayGrid> rays_;
  Observations all_;
  PixelSample sample_;
  std::vector<calib::RigPoses> poses_;
  std::vector<std::uint8_t> seen_;
};

TEST_F(MovedPixels, FromWhereTheyWereAreAsTheyWere) {
  EXPECT_GT(sample_.pixels.used, 200u);
  const Observations same = Moved(sample_, poses_, &session_->camera, *geometry_, *rays_, seen_);
  EXPECT_LT(Difference(same, all_), 1e-6);
  EXPECT_EQ(std::count(seen_.begin(), seen_.end(), 1),
            static_cast<std::ptrdiff_t>(sample_.pixels.used));
}

TEST_F(MovedPixels, FromElsewhereAreThoseOfMovedKeyframes) {
  std::vector<model::Keyframe> moved = keyframes_;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    poses_[k].X_WC = {
        calib::Turn(Eigen::Vector3d::UnitX(), 1e-3).rotation * poses_[k].X_WC.rotation,
        poses_[k].X_WC.translation + Eigen::Vector3d(0.3, -0.2, 0.5)};
    moved[k].X_WC = poses_[k].X_WC;
  }
  const Observations built = BuildObservations(moved, *geometry_, *rays_);
  const Observations seen = Moved(sample_, poses_, nullptr, *geometry_, *rays_, seen_);
  EXPECT_EQ(seen.reference, all_.reference);
  EXPECT_LT(Difference(seen, built), 1e-6);
  EXPECT_GT(Difference(seen, all_), 1e-3);
}

TEST_F(MovedPixels, AShiftedLensSeesWhatItsRaysSee) {
  std::vector<double> intrinsics = session_->camera.intrinsics();
  intrinsics[0] *= 1.002;
  intrinsics[2] += 0.3;
  const calib::CameraModel lens = session_->camera.WithIntrinsics(intrinsics);
  const Observations built = BuildObservations(keyframes_, *geometry_, calib::RayGrid(lens));
  const Observations seen = Moved(sample_, poses_, &lens, *geometry_, *rays_, seen_);
  EXPECT_LT(Difference(seen, built), 0.01 * Difference(seen, all_));
}

TEST_F(MovedPixels, WhatLosesTheSurfaceIsToldAndStays) {
  for (calib::RigPoses& pose : poses_) pose.X_WC.translation += 40.0 * pose.X_WC.rotation.col(0);
  const Observations seen = Moved(sample_, poses_, nullptr, *geometry_, *rays_, seen_);
  std::size_t lost = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen.pixel[i] == Observations::kNoPixel || seen_[i] != 0) continue;
    ++lost;
    EXPECT_EQ(seen.position[0][i], sample_.pixels.position[0][i]);
  }
  EXPECT_GT(lost, 10u);
}

}  // namespace
}  // namespace turnlight::estimator::observe
