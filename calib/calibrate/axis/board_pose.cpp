#include "calib/calibrate/axis/board_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/statistics.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {
namespace {

// IPPE takes points before a pinhole camera; beyond this angle from their mean there is no such.
constexpr double kSmallestCosine = 0.1;
constexpr std::size_t kFewestForHomography = 4;
// Of a tilt's fit: a guess from a homography is no least-squares fit, so that this is wide.
constexpr double kFarOff = 6.0;          // medians of the distances
constexpr double kFarOffAtLeast = 2e-4;  // of the distance to the board: 0.2 px at 1000 px
constexpr int kRounds = 3;
// Of distances in the picture: a tilt that fits so much worse than the other is no candidate.
constexpr double kWorseTilt = 2.0;

struct Rays {
  std::vector<std::size_t> place;  // in the view
  std::vector<cv::Point3d> p_B;
  std::vector<cv::Point2d> normalised;  // in the camera D
  Eigen::Matrix3d R_CD;                 // D looks at the middle of the points
};

Rays RaysOf(const board::Board& board, const CameraModel& camera, const board::BoardView& view) {
  const auto points = BoardPoints(board);
  std::vector<Eigen::Vector2d> pixels;
  for (const board::SeenPoint& seen : view.points) pixels.push_back(seen.pixel);
  const auto rays = camera.Unproject(pixels);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays)
    if (ray.allFinite()) middle += ray;
  Rays found;
  found.R_CD =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), middle).toRotationMatrix();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d ray = found.R_CD.transpose() * rays[i];
    if (!ray.allFinite() || ray.z() < kSmallestCosine) continue;
    const Eigen::Vector3d& p = points[view.points[i].point];
    found.place.push_back(i);
    found.p_B.emplace_back(p.x(), p.y(), p.z());
    found.normalised.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  return found;
}

// Corners in a row have no homography.
bool SpansPlane(const std::vector<cv::Point3d>& points) {
  Eigen::MatrixX2d places(points.size(), 2);
  for (std::size_t i = 0; i < points.size(); ++i)
    places.row(static_cast<Eigen::Index>(i)) << points[i].x, points[i].y;
  if (points.size() < kFewestForHomography) return false;
  places.rowwise() -= places.colwise().mean().eval();
  const Eigen::Matrix2d spread = places.transpose() * places;
  return spread.determinant() > 1e-4 * spread.trace() * spread.trace();
}

std::vector<Pose> Solve(const Rays& rays, const std::vector<bool>& fits) {
  std::vector<cv::Point3d> p_B;
  std::vector<cv::Point2d> normalised;
  for (std::size_t i = 0; i < rays.place.size(); ++i) {
    if (!fits[rays.place[i]]) continue;
    p_B.push_back(rays.p_B[i]);
    normalised.push_back(rays.normalised[i]);
  }
  std::vector<Pose> poses;
  if (!SpansPlane(p_B)) return poses;
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::solvePnPGeneric(p_B, normalised, cv::Matx33d::eye(), cv::noArray(), turns, shifts, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return poses;
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const auto* w = turns[i].ptr<double>();
    const auto* t = shifts[i].ptr<double>();
    const Eigen::Vector3d turn(w[0], w[1], w[2]), shift(t[0], t[1], t[2]);
    if (!turn.allFinite() || !shift.allFinite() || shift.z() <= 0.0) continue;
    const double angle = turn.norm();
    const Pose X_DB{
        angle > 0.0 ? Turn(turn / angle, angle).rotation : Eigen::Matrix3d::Identity().eval(),
        shift};
    poses.push_back(Pose{rays.R_CD, Eigen::Vector3d::Zero()} * X_DB);
  }
  return poses;
}

// How far each point is from where the pose has it, in the picture of D.
std::vector<double> Misses(const Rays& rays, const Pose& X_CB) {
  std::vector<double> misses;
  for (std::size_t i = 0; i < rays.place.size(); ++i) {
    const Eigen::Vector3d p_D =
        rays.R_CD.transpose() *
        (X_CB * Eigen::Vector3d(rays.p_B[i].x, rays.p_B[i].y, rays.p_B[i].z));
    misses.push_back(std::hypot(p_D.x() / p_D.z() - rays.normalised[i].x,
                                p_D.y() / p_D.z() - rays.normalised[i].y));
  }
  return misses;
}

// Which points of the view lie near where the pose has them; of the others the fit should be free.
std::vector<bool> Fitting(const Rays& rays, const Pose& X_CB, std::size_t places) {
  const std::vector<double> misses = Misses(rays, X_CB);
  std::vector<double> sorted = misses;
  const double limit = std::max(kFarOff * Median(sorted), kFarOffAtLeast);
  std::vector<bool> fits(places, false);
  for (std::size_t i = 0; i < misses.size(); ++i) fits[rays.place[i]] = misses[i] <= limit;
  return fits;
}

double MedianMiss(const Rays& rays, const Pose& X_CB) {
  std::vector<double> misses = Misses(rays, X_CB);
  return Median(misses);
}

}  // namespace

BoardPoses GuessBoardPoses(const board::Board& board, const CameraModel& camera,
                           const board::BoardView& view) {
  const Rays rays = RaysOf(board, camera, view);
  BoardPoses guess;
  guess.fits.assign(view.points.size(), false);
  for (const std::size_t place : rays.place) guess.fits[place] = true;
  for (int round = 0; round < kRounds; ++round) {
    guess.X_CB = Solve(rays, guess.fits);
    if (guess.X_CB.empty()) break;
    guess.fits = Fitting(rays, guess.X_CB.front(), view.points.size());
  }
  if (guess.X_CB.size() > 1 &&
      MedianMiss(rays, guess.X_CB[1]) > kWorseTilt * MedianMiss(rays, guess.X_CB[0]))
    guess.X_CB.resize(1);
  return guess;
}

}  // namespace turnlight::calib::calibrate::axis
