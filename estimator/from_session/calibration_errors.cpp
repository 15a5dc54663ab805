#include "estimator/from_session/calibration_errors.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/angles.h"
#include "calib/radiometry.h"
#include "estimator/from_session/independent_directions.h"
#include "estimator/model/direction_lattice.h"
#include "rig/session_calibration.h"

namespace turnlight::estimator::from_session {
namespace {

constexpr std::size_t kMostViews = 8;  // that a lens is looked at in
constexpr int kPointsOfView = 32;      // on a sphere round the target
// Directions of the lens that are left out move the target's image together by less than this share
// of what all do; then a sigma is off by 5e-5 of itself.
constexpr double kLeastShare = 0.01;

// A part of the calibration with a covariance: its key in the file, the budget's item.
struct CalibratedPart {
  const char* key;
  const std::optional<Eigen::MatrixXd>* covariance;
  uncertainty::BudgetWords words;
};

std::vector<CalibratedPart> PartsOf(const rig::CalibrationCovariances& known) {
  return {
      {"camera_model",
       &known.camera_model,
       {"lens", "intrinsics of the lens", "calibrate intrinsics with more images of the board"}},
      {"X_WC",
       &known.X_WC,
       {"camera-pose", "pose of the camera", "calibrate axis with more angles, or a larger board"}},
      {"X_WA",
       &known.X_WA,
       {"axis", "axis of the table", "calibrate axis with more angles, or a larger board"}},
      {"X_AT",
       &known.X_AT,
       {"target-place", "target's place on the table", "calibrate target with more angles"}},
      {"angle_scale",
       &known.angle_scale,
       {"angle-scale", "scale of the table's angles", "calibrate axis over a whole revolution"}},
      {"angle_offset",
       &known.angle_offset,
       {"angle-offset", "zero of the table's angles", "calibrate axis with more angles"}},
      {"radiometry",
       &known.radiometry,
       {"response", "response of the sensor", "calibrate response with more pictures"}}};
}

// What the keyframes' poses, lens and radiances are made of.
struct Calibrated {
  rig::RigCalibration calibration;
  rig::Session session;
  std::vector<std::size_t> frames;
};

calib::Pose Moved(const calib::Pose& pose, const Eigen::VectorXd& by) {
  const Eigen::Vector3d w = by.head<3>();
  const double angle = w.norm();
  if (angle == 0.0) return {pose.rotation, pose.translation + by.tail<3>()};
  return {calib::Turn(w / angle, angle).rotation * pose.rotation, pose.translation + by.tail<3>()};
}

// The radiometry of the session's pictures: of a bracket's they are in shares of white already.
calib::Radiometry Moved(const calib::Radiometry& session, const calib::Radiometry& raw,
                        const Eigen::VectorXd& by) {
  const double share = (session.white - session.black) / (raw.white - raw.black);
  calib::Radiometry out = session;
  if (!out.saturation) out.saturation = session.white;  // what is clipped stays so
  out.black += share * by[0];
  out.white += share * by[1];
  return out;
}

// A step of every part's parameters: empty where a part has none.
struct Step {
  std::vector<Eigen::VectorXd> of_part;
};

MovedCalibration MovedBy(const std::shared_ptr<const Calibrated>& at, const Step& step) {
  const auto has = [&](std::size_t part) {
    return step.of_part[part].size() > 0 && !step.of_part[part].isZero(0.0);
  };
  calib::TurntableGeometry rig = at->calibration.geometry;
  if (has(1)) rig.X_WC = Moved(rig.X_WC, step.of_part[1]);
  if (has(2)) rig.X_WA = Moved(rig.X_WA, step.of_part[2]);
  if (has(3)) rig.X_AT = Moved(rig.X_AT, step.of_part[3]);
  if (has(4)) rig.angle_scale += step.of_part[4][0];
  if (has(5)) rig.angle_offset_deg += step.of_part[5][0];
  MovedCalibration out;
  for (const std::size_t frame : at->frames)
    out.poses.push_back(calib::PosesAt(rig, *rig::PoseAngleDeg(at->session.frames[frame])));
  if (has(0)) {
    std::vector<double> intrinsics = at->calibration.lens.intrinsics();
    for (std::size_t i = 0; i < intrinsics.size(); ++i)
      intrinsics[i] += step.of_part[0][static_cast<Eigen::Index>(i)];
    out.lens = at->calibration.lens.WithIntrinsics(std::move(intrinsics));
  }
  if (!has(6)) return out;
  const calib::Radiometry radiometry =
      Moved(at->session.radiometry, at->calibration.radiometry, step.of_part[6]);
  out.radiance = [at, radiometry](std::size_t k) -> Result<cv::Mat> {
    const auto images = rig::ReadFrameImages(at->session, at->frames[k]);
    if (!images) return Forward(images);
    return calib::Linearise(images->image, radiometry, at->session.frames[at->frames[k]].exposure)
        .radiance;
  };
  return out;
}

// Points round the target as cameras see them.
std::vector<Eigen::Vector3d> TargetPoints(const Calibrated& at, const target::Geometry& geometry) {
  std::vector<Eigen::Vector3d> p_C;
  const std::size_t views = std::min(kMostViews, at.frames.size());
  for (std::size_t i = 0; i < views; ++i) {
    const rig::FrameRecord& frame = at.session.frames[at.frames[i * at.frames.size() / views]];
    const calib::Pose X_CT = frame.X_WC.Inverse() * frame.X_WT;
    for (const Eigen::Vector3d& direction : model::SphereDirections(kPointsOfView))
      p_C.push_back(X_CT * (geometry.center() + geometry.radius() * direction));
  }
  return p_C;
}

// The lens's directions by how far they move the target's image, those that hardly do left out.
BlockRoot Reduced(const BlockRoot& block, const Calibrated& at, const target::Geometry& geometry) {
  const calib::CameraModel& lens = at.calibration.lens;
  const std::vector<Eigen::Vector3d> p_C = TargetPoints(at, geometry);
  Eigen::MatrixXd moves =
      Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(p_C.size()), block.root.cols());
  const auto project = [&](const Eigen::VectorXd& by) {
    std::vector<double> intrinsics = lens.intrinsics();
    for (std::size_t i = 0; i < intrinsics.size(); ++i)
      intrinsics[i] += by[static_cast<Eigen::Index>(i)];
    return lens.WithIntrinsics(std::move(intrinsics)).Project(p_C);
  };
  constexpr double kStep = 0.01;  // sigmas: a direction that is hardly known bends
  for (Eigen::Index k = 0; k < block.root.cols(); ++k) {
    const auto up = project(kStep * block.root.col(k)), down = project(-kStep * block.root.col(k));
    for (std::size_t i = 0; i < p_C.size(); ++i) {
      const Eigen::Vector2d move = (up[i] - down[i]) / (2.0 * kStep);
      if (move.allFinite()) moves.block<2, 1>(2 * static_cast<Eigen::Index>(i), k) = move;
    }
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(moves, Eigen::ComputeThinV);
  const Eigen::VectorXd& sizes = svd.singularValues();
  Eigen::Index count = sizes.size();
  while (count > 0 && sizes.tail(sizes.size() - count + 1).norm() < kLeastShare * sizes.norm())
    --count;
  const Eigen::MatrixXd turn = svd.matrixV().leftCols(count);
  return {block.root * turn, turn.transpose() * block.inverse};
}

// The covariance of all parts, in their order, with what is known between them.
Eigen::MatrixXd JointCovarianceOf(const rig::CalibrationCovariances& known,
                                  const std::vector<CalibratedPart>& parts) {
  std::vector<Eigen::Index> begin{0};
  for (const CalibratedPart& part : parts)
    begin.push_back(begin.back() + (*part.covariance ? (*part.covariance)->rows() : 0));
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(begin.back(), begin.back());
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (const auto& own = *parts[i].covariance)
      all.block(begin[i], begin[i], own->rows(), own->cols()) = *own;
  if (!known.joint) return all;
  std::vector<Eigen::Index> at;  // of the joint matrix's rows
  for (const std::string& key : known.joint->of)
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (Eigen::Index row = begin[i]; key == parts[i].key && row < begin[i + 1]; ++row)
        at.push_back(row);
  all(at, at) = known.joint->matrix;
  return all;
}

}  // namespace

CalibrationErrors ErrorsOf(const rig::RigCalibration& calibration, const rig::Session& session,
                           const std::vector<std::size_t>& frames,
                           const target::Geometry& geometry) {
  const auto at = std::make_shared<const Calibrated>(Calibrated{calibration, session, frames});
  const std::vector<CalibratedPart> parts = PartsOf(calibration.covariances);
  std::vector<BlockRoot> blocks;
  std::vector<Eigen::Index> rows, first{0};
  for (const CalibratedPart& part : parts) {
    BlockRoot block = RootOf(part.covariance->value_or(Eigen::MatrixXd(0, 0)));
    if (blocks.empty() && block.root.cols() > 0) block = Reduced(block, *at, geometry);
    rows.push_back(block.root.rows());
    first.push_back(first.back() + block.root.cols());
    blocks.push_back(std::move(block));
  }
  const Eigen::MatrixXd root = JointRoot(JointCovarianceOf(calibration.covariances, parts), blocks);
  CalibrationErrors out;
  std::vector<Eigen::Index> column;  // of each item's first direction
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (first[i + 1] == first[i]) continue;
    out.items.push_back({parts[i].words, static_cast<std::size_t>(first[i + 1] - first[i])});
    column.push_back(first[i]);
  }
  out.move = [at, root, rows, column](std::size_t item, std::size_t direction, double sigmas) {
    const Eigen::VectorXd all =
        sigmas * root.col(column[item] + static_cast<Eigen::Index>(direction));
    Step step;
    Eigen::Index row = 0;
    for (const Eigen::Index count : rows) {
      step.of_part.emplace_back(all.segment(row, count));
      row += count;
    }
    return MovedBy(at, step);
  };
  return out;
}

}  // namespace turnlight::estimator::from_session
