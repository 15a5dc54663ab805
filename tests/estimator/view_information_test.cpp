// Proves: the information that is predicted for a view is that of its picture once it is taken,
// to 10 %, with and without a noise model and for other exposures; what clips tells nothing, and
// neither do views beside the target. Does not prove what follows for sigmas: next_view_test does.
#include "estimator/view_information.h"

#include <gtest/gtest.h>

#include "estimator/model/parameters.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/normal_equations.h"
#include "tests/estimator/noise_weights.h"

namespace turnlight::estimator {
namespace {

// A ball from all around, with its estimate.
struct Ball {
  rig::sim::SyntheticSession session;
  std::vector<model::Keyframe> keyframes;
  target::Geometry geometry;
  calib::RayGrid rays;
  Result<EstimateOutput> output;

  Ball(rig::sim::SyntheticConfig config, bool noise_known)
      : session(*rig::sim::SynthesizeInMemory(config)),
        geometry(session.target),
        rays(session.camera) {
    session.radiometry.reference_exposure_us = 1000.0;
    if (noise_known) session.radiometry.noise = NoiseOfSensor(config, session.radiometry);
    for (rig::sim::SyntheticFrame& frame : session.frames) frame.exposure.exposure_us = 1000.0;
    keyframes = rig::sim::ToKeyframes(session);
    output = EstimateScene(keyframes, geometry, rays, {});
  }
  const FitState& fit() const { return output->estimate.fit; }
  CandidateView View(std::size_t frame, double longer = 1.0) const {
    const rig::sim::SyntheticFrame& f = session.frames[frame];
    calib::Exposure exposure = f.exposure;
    exposure.exposure_us = 1000.0 * longer;
    return {{f.X_WC, f.X_WT}, exposure, f.angle_deg, ""};
  }
  Sensor sensor() const { return {session.radiometry, session.frames[0].image.depth()}; }
  Eigen::MatrixXd Predicted(const CandidateView& view) const {
    return InformationOf(view, fit(), geometry, rays, sensor());
  }
  // Of the picture that was taken.
  Eigen::MatrixXd Taken(std::size_t frame) const {
    observe::Observations part = observe::BuildPart(keyframes[frame], geometry, rays);
    observe::CompleteIn(fit().frame, part);
    solve::EvaluateOptions options;
    options.samples_per_side = solve::FootprintSamples(part, fit().scene.reflectance, 2);
    options.shadows = solve::CastShadows(part, fit().scene);
    return solve::Evaluate(part, fit().scene, options).hessian;
  }
};

// The ratio of the diagonals, where there is anything.
void ExpectAlike(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
  ASSERT_EQ(a.rows(), b.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!(b(i, i) > 1e-9 * b.diagonal().maxCoeff())) continue;
    EXPECT_NEAR(a(i, i) / b(i, i), 1.0, tolerance) << i;
  }
}

TEST(InformationOf, IsThatOfThePictureOnceItIsTaken) {
  for (const bool noise_known : {false, true}) {
    const Ball ball(ShotNoiseBall(3), noise_known);
    ASSERT_TRUE(ball.output) << ball.output.error().text;
    EXPECT_EQ(ball.fit().frame.weighted, noise_known);
    for (const std::size_t frame : {std::size_t{0}, std::size_t{3}})
      ExpectAlike(ball.Predicted(ball.View(frame)), ball.fit().loss_share * ball.Taken(frame), 0.1);
  }
}

TEST(InformationOf, GrowsWithTheExposureWhereTheNoiseIsKnown) {
  const Ball ball(ShotNoiseBall(3), true);
  ASSERT_TRUE(ball.output) << ball.output.error().text;
  const double once = ball.Predicted(ball.View(1, 0.25)).trace();
  const double twice = ball.Predicted(ball.View(1, 0.5)).trace();
  EXPECT_GT(twice, 1.4 * once);
  EXPECT_LT(twice, 2.1 * once);
}

TEST(InformationOf, WhatClipsTellsNothing) {
  const Ball ball(TwoLightBall(1, 0.002, 0.1), false);
  ASSERT_TRUE(ball.output) << ball.output.error().text;
  const model::Parameters parameters(ball.fit().scene, ball.fit().frame.channels);
  const int shape = parameters.Shape(0);
  const double as_taken = ball.Predicted(ball.View(0))(shape, shape);
  EXPECT_GT(as_taken, 0.0);
  EXPECT_LT(ball.Predicted(ball.View(0, 4.0))(shape, shape), 0.5 * as_taken);
  EXPECT_TRUE(ball.Predicted(ball.View(0, 1e4)).isZero(0.0)) << "all is clipped";
}

TEST(InformationOf, ViewsBesideTheTargetHaveNone) {
  const Ball ball(TwoLightBall(1, 0.002, 0.1), false);
  ASSERT_TRUE(ball.output) << ball.output.error().text;
  CandidateView view = ball.View(0);
  view.poses.X_WC.rotation = view.poses.X_WC.rotation * Eigen::Vector3d(-1, 1, -1).asDiagonal();
  EXPECT_TRUE(ball.Predicted(view).isZero(0.0));
}

}  // namespace
}  // namespace turnlight::estimator
