// What a ray meets: the target as something that can be traced. All arguments are in T.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "calib/target_shape.h"

namespace turnlight::estimator::target {

struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;            // unit, for shading (interpolated on a mesh)
  Eigen::Vector3d geometric_normal;  // unit, of the face; the same side as the winding says
  double distance = 0.0;             // along the ray, in units of the direction's length
  std::uint32_t primitive = 0;       // face of a mesh, else 0
};

// Immutable once built; safe to use from several threads. Meshes are traced by Embree over a tree
// built in a fixed order, and the hit found is recomputed in double.
class Geometry {
 public:
  // The shape must be valid (positive sizes; a mesh with faces, indices in range, unit normals).
  explicit Geometry(calib::TargetShape shape);
  ~Geometry();
  Geometry(Geometry&&) noexcept;
  Geometry& operator=(Geometry&&) noexcept;

  // The first surface along the ray that faces it. direction need not be unit. A one-sided plane
  // seen from behind is not there; a two-sided one shows a normal towards the ray's origin. A mesh
  // face seen from its back hides what lies behind it and gives nothing itself.
  std::optional<SurfacePoint> Intersect(const Eigen::Vector3d& origin,
                                        const Eigen::Vector3d& direction) const;
  // Whether the first surface along the ray is seen from its back, so that Intersect gives nothing.
  bool SeesBack(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  // Whether anything of the target lies strictly between a surface point and what is at
  // origin + direction * max_distance (infinity for a distant light). normal is the geometric
  // normal at the point, along which the start is lifted to clear the surface itself; direction is
  // unit.
  bool Occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& geometric_normal,
                const Eigen::Vector3d& direction,
                double max_distance = std::numeric_limits<double>::infinity()) const;

  // False for shapes that cannot shadow themselves (sphere, plane): Occluded is then always false.
  bool CanShadowItself() const;

  // A sphere that holds the whole target.
  const Eigen::Vector3d& center() const { return center_; }
  double radius() const { return radius_; }
  const calib::TargetShape& shape() const { return *shape_; }

 private:
  struct MeshTracer;
  std::unique_ptr<const calib::TargetShape> shape_;  // does not move: the tracer refers to it
  std::unique_ptr<MeshTracer> mesh_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double radius_ = 1.0;
};

}  // namespace turnlight::estimator::target
