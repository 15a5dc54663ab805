// What is odd about a keyframe, in words.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/consistency/small_views.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::consistency {

struct FrameJudgement;

// How much less of the target than other masks one may let through.
inline constexpr double kMaskStep = 0.05;

// Per view, the share of what its target covers that is inside its mask.
std::vector<double> MasksOnTarget(const SmallViews& views, const target::Geometry& geometry,
                                  const calib::RayGrid& rays);

class Oddness {
 public:
  // models: of each view as the frames that are not odd tell it (ModelPictures); usual: what is
  // left of one of them. The views must outlive it.
  Oddness(const SmallViews& views, std::vector<cv::Mat1f> models, std::vector<bool> odd,
          double usual);

  // What explains frame k, simplest first: "is black", "is dimmer than the others tell, 0.5
  // times, ...", "has the same picture as frame 6", ...; of what nothing explains, how much is
  // left.
  std::string Of(std::size_t k, const FrameJudgement& judged) const;

 private:
  std::string Emptiness(std::size_t k) const;
  std::string Copy(std::size_t k) const;
  std::string OtherFrame(std::size_t k) const;
  std::string Turn(std::size_t k) const;
  std::string Shift(std::size_t k) const;
  double LeftAs(std::size_t picture, std::size_t pose) const;

  const SmallViews& views_;
  std::vector<cv::Mat1f> models_;
  std::vector<bool> odd_;
  double usual_;
};

}  // namespace turnlight::estimator::consistency
