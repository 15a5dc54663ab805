// Proves: W is where the header says, for boards that lie and boards that stand, cameras beside the
// axis and on it; derivatives are those of differences. Does not prove: that an axis is right.
#include "calib/calibrate/axis/rig_frame.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "base/angles.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {
namespace {

// A board of 100 x 100 flat on a table, printed side up, in W; seen by a camera.
TurningState StateOf(const Pose& X_WC, const Pose& X_WB, bool along_z) {
  const Pose X_CW = X_WC.Inverse();
  TurningState state;
  state.u = (along_z ? 1.0 : -1.0) * X_CW.rotation.col(2);
  state.a = X_CW * Eigen::Vector3d(0, 0, 17);
  state.X_CB = X_CW * X_WB;
  state.scale = along_z ? 1.001 : -1.001;
  return state;
}
const Eigen::Vector3d kMiddle(50, 50, 0);

Pose Lying(double height) {
  Pose X_WB = Turn(Eigen::Vector3d::UnitX(), DegToRad(180.0));
  X_WB.translation = {20, 30, height};
  return X_WB;
}

void ExpectSame(const Pose& found, const Pose& truth) {
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-9);
  EXPECT_LT((found.translation - truth.translation).norm(), 1e-9);
}

TEST(RigFrame, OriginIsWhereTheAxisMeetsTheBoardAndTheCameraIsAtYZero) {
  const Pose X_WC = LookAtOrigin(0.0, DegToRad(30.0), 400.0);
  for (const bool along_z : {true, false}) {
    const TurningState state = StateOf(X_WC, Lying(0.0), along_z);
    const FrameChoice choice = ChooseFrame(state, kMiddle, 0.0);
    EXPECT_TRUE(choice.board_lies);
    ExpectSame(FrameOf(state, choice), X_WC);
    EXPECT_NEAR(ScaleIn(state, choice), 1.001, 1e-12);
  }
  // A board of 3 mm, and W's origin on the table all the same.
  const TurningState state = StateOf(X_WC, Lying(3.0), true);
  ExpectSame(FrameOf(state, ChooseFrame(state, kMiddle, -3.0)), X_WC);
}

TEST(RigFrame, OfAStandingBoardZIsUpwardsInThePicture) {
  const Pose X_WC = LookAtOrigin(0.0, DegToRad(10.0), 400.0);
  Pose X_WB = Turn(Eigen::Vector3d::UnitZ(), DegToRad(90.0)) *
              Turn(Eigen::Vector3d::UnitX(), DegToRad(-90.0));
  X_WB.translation = {40, -50, 50};  // its middle is at height 0
  for (const bool along_z : {true, false}) {
    const TurningState state = StateOf(X_WC, X_WB, along_z);
    const FrameChoice choice = ChooseFrame(state, kMiddle, 0.0);
    EXPECT_FALSE(choice.board_lies);
    ExpectSame(FrameOf(state, choice), X_WC);
  }
}

TEST(RigFrame, UnderACameraOnTheAxisXIsDownwardsInThePicture) {
  const Pose X_WC = LookAtOrigin(0.0, DegToRad(90.0), 400.0);
  const TurningState state = StateOf(X_WC, Lying(0.0), true);
  const FrameChoice choice = ChooseFrame(state, kMiddle, 0.0);
  EXPECT_FALSE(choice.x_to_camera);
  const Pose X_CW = FrameOf(state, choice).Inverse();
  EXPECT_LT((X_CW.rotation.col(0) - Eigen::Vector3d::UnitY()).norm(), 1e-9);
}

TEST(RigFrame, DerivativesAreThoseOfSteps) {
  const TurningState state = StateOf(LookAtOrigin(0.0, DegToRad(30.0), 400.0), Lying(0.0), false);
  const FrameChoice choice = ChooseFrame(state, kMiddle, 0.0);
  Step step;
  for (int i = 0; i < kParameters; ++i) step[i] = 1e-5 * (1 + i % 3) * (i % 2 == 0 ? 1 : -1);
  const Pose before = FrameOf(state, choice), after = FrameOf(Stepped(state, step), choice);
  const Eigen::AngleAxisd turn(after.rotation * before.rotation.transpose());
  Eigen::Matrix<double, kRigParameters, 1> moved;
  moved << turn.angle() * turn.axis(), after.translation - before.translation,
      ScaleIn(Stepped(state, step), choice) - ScaleIn(state, choice);
  EXPECT_LT((moved - ByStep(state, choice) * step).norm(), 1e-3 * moved.norm());
}

}  // namespace
}  // namespace turnlight::calib::calibrate::axis
