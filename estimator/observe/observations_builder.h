// Observations, keyframe by keyframe: pictures come and go, what is kept of their pixels stays in
// the arrays that the estimate uses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/observe/block_choice.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

inline constexpr std::size_t kAllPixels = std::numeric_limits<std::size_t>::max() / 2;

// Whenever more than `most` pixels are held, some of their blocks are given up, of all keyframes
// alike: what is kept at the end depends on the pictures alone, not on their order in time.
class ObservationsBuilder {
 public:
  // Geometry and rays must outlive the builder and, if it shadows itself, the geometry what is
  // built; keyframes: how many will come.
  ObservationsBuilder(const target::Geometry& geometry, const calib::RayGrid& rays,
                      std::size_t keyframes, std::size_t most);

  // Before the first keyframe: pixels have marks (Observations::at_white), which come with them.
  void MarkPixels() { out_.one_sided = true; }
  // The next keyframe, and what was traced of it; marks: of its pixels, if they have any.
  void Add(const model::Keyframe& keyframe, KeyframeTracer& tracer,
           const cv::Mat1b* marks = nullptr);
  // Usable pixels of what came, whether kept or not.
  std::size_t usable() const { return usable_; }
  // Once, after the last: all pixels, in white. They are still to be completed (Complete).
  Observations Finish();

 private:
  using Rows = std::vector<std::vector<TracedPixel>>;
  // flags: of the keyframe, as the tracer has them.
  void Append(const model::Keyframe& keyframe, const cv::Mat1b& flags, const cv::Mat1b* marks,
              const Rows& rows);
  void Put(const model::Keyframe& keyframe, const TracedPixel& traced, std::size_t at);
  void RememberHeldBack();
  void TakeChannels(const cv::Mat& radiance);
  void Resize(std::size_t size);
  void Reserve(std::size_t size);
  void Thin();
  template <typename Body>
  void ForEachArray(const Body& body);

  const calib::RayGrid* rays_;
  std::size_t keyframes_, most_, usable_ = 0, used_ = 0;
  Observations out_;
  std::vector<std::size_t> begin_;               // of each keyframe that came, then the end
  std::vector<std::size_t> count_;               // of its pixels
  std::array<std::vector<double>, 3> position_;  // in W, until the centroid is known
  std::vector<float> footprint_size_;            // |dw/du| + |dw/dv|
  std::vector<std::uint8_t> held_back_;          // HeldBack::at_white, or 0
};

}  // namespace turnlight::estimator::observe
