// How well some light or other explains the pictures with given poses: a quick measure, to compare
// many ways in which poses may be wrong.
//
// The pictures are fitted by ambient light, and by white distant lights in a lattice of directions
// with Lambert's term and two Phong lobes each, all at least 0; what is beside the target by one
// constant. Shadows are left out. So a good measure tells that poses are right; a bad one only that
// others do better.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/consistency/small_views.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::consistency {

// What sampled pixels would see of the target with some poses.
struct Design {
  std::vector<std::vector<std::uint32_t>> seen;  // of each pose: samples that hit the target
  Eigen::MatrixXf columns;                       // a row for each of those, pose by pose
  Eigen::MatrixXf gram;                          // columns^T columns
};

class Explainer {
 public:
  // All must outlive it. With stop set its answers come at once, and are of no use.
  Explainer(const SmallViews& views, const target::Geometry& geometry, const calib::RayGrid& rays,
            const StopFlag* stop);

  Design DesignOf(const std::vector<calib::RigPoses>& poses) const;

  // Root mean square of what is left, in radiance, over all sampled pixels, where pose k is that of
  // the picture of view picture[k]. Infinite where it is no number, and with stop set.
  double Residual(const Design& design, const std::vector<std::size_t>& picture) const;

  // From an order of the pictures to one that leaves no more: the pictures are given to the poses
  // whose model they are most like, the model is fitted anew, and so on.
  std::vector<std::size_t> Reassigned(const Design& design, std::vector<std::size_t> picture) const;

  // Of what the poses see of the target the share that is inside the masks: 1 without masks, 0 if
  // they see nothing.
  double ShareInMasks(const Design& design, const std::vector<std::size_t>& picture) const;

 private:
  struct Fit {
    Eigen::VectorXf model;  // of the design's rows
    double beside = 0.0;    // radiance of what is not the target
    double residual = 0.0;
  };
  Fit FitTo(const Design& design, const std::vector<std::size_t>& picture) const;

  struct Sampled {
    std::uint32_t row = 0, column = 0;
  };
  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  const StopFlag* stop_;
  std::vector<Sampled> samples_;                // of every view
  std::vector<std::vector<bool>> inside_;       // the mask, by view and sample
  std::vector<std::vector<float>> radiance_;    // by view and sample; 0 outside the mask
  std::vector<Eigen::Vector3d> wide_, narrow_;  // directions of lights
};

}  // namespace turnlight::estimator::consistency
