// Proves: a step changes the calibration as its parts' covariances count; the root of the stored
// covariance gives it back, joint and singular ones too; each cause moves what it should alone.
#include "calib/calibrate/drift/rig_change.h"

#include <gtest/gtest.h>

#include "tests/calib/calibrate/drift/drift_scenes.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(RigChange, AStepChangesEachPart) {
  const rig::RigCalibration rig = PlacedRig();
  const Layout layout(rig);
  ASSERT_EQ(layout.size, 12 + 6 + 6 + 1 + 1 + 6);
  VectorXd step = VectorXd::Zero(layout.size);
  step[2] = 1.5;
  step[layout.X_WC + 4] = -0.25;
  step[layout.angle_scale] = 0.01;
  step[layout.angle_offset] = 2.0;
  step[layout.object] = 0.1;
  const rig::RigCalibration changed = Changed(rig, layout, step);
  EXPECT_DOUBLE_EQ(changed.lens.intrinsics()[2], rig.lens.intrinsics()[2] + 1.5);
  EXPECT_DOUBLE_EQ(changed.geometry.X_WC.translation.y(), rig.geometry.X_WC.translation.y() - 0.25);
  EXPECT_DOUBLE_EQ(changed.geometry.angle_scale, rig.geometry.angle_scale + 0.01);
  EXPECT_DOUBLE_EQ(changed.geometry.angle_offset_deg, rig.geometry.angle_offset_deg + 2.0);
  const Pose turned = Turn(Eigen::Vector3d::UnitX(), 0.1);
  EXPECT_LT((changed.geometry.X_AT.rotation - turned.rotation * rig.geometry.X_AT.rotation).norm(),
            1e-12);
}

TEST(RigChange, TheRootGivesTheStoredCovarianceBack) {
  rig::RigCalibration rig = PlacedRig();
  // X_AT and the scale go together.
  MatrixXd joint = MatrixXd::Zero(7, 7);
  joint.topLeftCorner(6, 6) = *rig.covariances.X_AT;
  joint(6, 6) = 1e-8;
  joint(6, 3) = joint(3, 6) = 1e-6;
  rig.covariances.joint = rig::JointCovariance{{"X_AT", "angle_scale"}, joint};
  const Layout layout(rig);
  const MatrixXd root = StoredRoot(rig, layout, true);
  const MatrixXd covariance = root * root.transpose();
  EXPECT_NEAR(covariance(layout.angle_scale, layout.object + 3), 1e-6, 1e-12);
  EXPECT_LT((covariance.block(layout.object, layout.object, 6, 6) - *rig.covariances.X_AT).norm(),
            1e-12);
  EXPECT_EQ(covariance.block(0, 0, 12, 12).norm(), 0.0);
  const MatrixXd without = StoredRoot(rig, layout, false);
  EXPECT_EQ((without.transpose().col(0)).size(), without.cols());
  EXPECT_EQ(without.middleRows(layout.object, 6).norm(), 0.0);
}

TEST(RigChange, SaysWhichPartsHaveNoCovariance) {
  rig::RigCalibration rig = PlacedRig();
  EXPECT_TRUE(WithoutCovariance(rig, true).empty());
  rig.covariances.X_AT.reset();
  rig.covariances.camera_model.reset();
  EXPECT_EQ(WithoutCovariance(rig, true), (std::vector<std::string>{"camera_model", "X_AT"}));
  EXPECT_EQ(WithoutCovariance(rig, false), std::vector<std::string>{"camera_model"});
  EXPECT_EQ(Layout(rig).X_WC, 4);
}

TEST(RigChange, ALensThatChangesKeepsItsPixelsSquare) {
  const rig::RigCalibration rig = PlacedRig();
  const MatrixXd steps = StepsOf(Cause::kLens, rig, Layout(rig));
  EXPECT_DOUBLE_EQ(steps(0, 0) / rig.lens.intrinsics()[0], steps(1, 0) / rig.lens.intrinsics()[1]);
  EXPECT_EQ(StepsOf(Cause::kAngles, rig, Layout(rig)).cols(), 2);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::drift
