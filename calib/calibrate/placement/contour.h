// The contour generator of a shape: where its surface turns away from the camera, as far as it
// bounds the picture of the whole shape. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/camera_model.h"
#include "calib/pose.h"
#include "calib/target_shape.h"
#include "estimator/target/geometry.h"

namespace turnlight::calib::calibrate::placement {

struct Segment {
  Eigen::Vector3d a_T, b_T;  // its ends on the shape
  Eigen::Vector2d a, b;      // their image points
  Eigen::Vector2d normal;    // unit, away from the target
};

// Planes and meshes. Safe to use from several threads.
class ContourFinder {
 public:
  explicit ContourFinder(const calib::TargetShape& shape);

  // In no order; pieces of at most kLongestPiece pixels. Empty: nothing is before the camera, or a
  // one-sided plane is seen from behind.
  std::vector<Segment> Find(const calib::Pose& X_CT, const calib::CameraModel& camera) const;

 private:
  struct Edge {
    int a, b;         // vertices
    int face, other;  // faces at it; other = -1: only one
  };
  struct Piece;
  void CollectEdges();
  std::vector<Piece> FindPieces(const Eigen::Vector3d& p_TC) const;

  calib::MeshShape mesh_;  // a plane is two triangles
  int plane_sides_ = 0;    // 0: not a plane
  std::vector<Eigen::Vector3d> face_normals_;
  std::vector<Edge> edges_;
  std::shared_ptr<const estimator::target::Geometry> geometry_;
};

inline constexpr double kLongestPiece = 8.0;

}  // namespace turnlight::calib::calibrate::placement
