// One keyframe: which of its pixels are used, why the others are not, and what they see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/observe/block_choice.h"
#include "estimator/observe/trace_pixels.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Why a pixel is not used; the bits of a flag picture. 0: used.
enum PixelFlag : std::uint8_t {
  kOffTarget = 1,      // the ray misses the target, or the mask says it is not the target
  kSaturated = 2,      // clipped, implausible, or one of the 8 neighbours of such a pixel
  kSilhouette = 4,     // within two pixels of the outline, or across a jump of depth or normal
  kGrazing = 8,        // seen too flat for its footprint to be trusted
  kUnlikeOthers = 16,  // an outlier among its neighbours
  kLostInNoise = 32,   // cut off at the sensor's floor
  kNotTaken = 64,      // of many alike, others were taken
  kHeldBack = 128,     // with kSaturated: clipped or beside it, and finite; see Clipped
};

// What becomes of pixels at white and their neighbours: they are held back until a model is known
// that can tell what they are worth (Observations::held_back), or kept as all others.
enum class Clipped { kHeldBack, kKept };

struct TracedPixel {
  std::uint32_t pixel = 0;  // row * width + column
  PixelGeometry geometry;
};

// Traces a keyframe in two steps, so that little is held of a large picture: first all that the
// picture and the rays through the pixels' middles say, then the pixels' width in some rows at a
// time. Of a small picture everything is traced at once. Both steps run in parallel,
// deterministically; what they give does not depend on which way it was done.
class KeyframeTracer {
 public:
  KeyframeTracer() = default;
  // The first step. Geometry and rays must outlive the tracer; the keyframe need not.
  KeyframeTracer(const model::Keyframe& keyframe, std::uint32_t index,
                 const target::Geometry& geometry, const calib::RayGrid& rays,
                 Clipped clipped = Clipped::kHeldBack);

  // Used pixels of rows [begin, end) in blocks that are kept, and those held back, row by row; each
  // row can be asked for once.
  std::vector<std::vector<TracedPixel>> Rows(int begin, int end, const BlockChoice& choice);

  // Before any rows: pixels that are not 0 here are not taken.
  void LeaveOut(const cv::Mat1b& pixels);

  // One byte of PixelFlag bits per pixel. Jumps of depth and normal are known of the rows that were
  // asked for, where blocks are kept.
  const cv::Mat1b& flags() const { return flags_; }
  // How many pixels would be used if no jump of depth or normal were.
  std::size_t candidates() const { return candidates_; }

 private:
  cv::Mat1b TraceWhole(const cv::Mat1b& mask);
  cv::Mat1b TraceMiddles(const cv::Mat1b& mask);
  void MarkPicture(const model::Keyframe& keyframe, const cv::Mat1b& target, Clipped clipped);
  std::vector<TracedPixel> TracedRow(int row, const BlockChoice& choice);

  std::uint32_t index_ = 0;
  const target::Geometry* geometry_ = nullptr;
  const calib::RayGrid* rays_ = nullptr;
  calib::RigPoses poses_;
  double grazing_ = 0.0;
  cv::Mat1b flags_;
  std::size_t candidates_ = 0;
  std::vector<std::vector<TracedPixel>> rows_;  // of a small picture: all that meet the target
};

// How many keyframes of this size are in memory at a time, at least 2: what they hold together is
// bounded whatever the number of threads.
std::size_t KeyframesInFlight(std::size_t picture_pixels);
// Whether a picture is so small that all geometry of its target is held at once.
bool IsTracedWhole(std::size_t picture_pixels);

// Reads keyframes and takes their first step, KeyframesInFlight at a time; `put` has them one by
// one in their order, in the thread that calls. Fails as the source does (the first refusal in the
// order of the keyframes), and with kInterrupted when stop (optional) was set.
Status TraceKeyframes(
    const model::KeyframeSource& keyframes, const target::Geometry& geometry,
    const calib::RayGrid& rays, const StopFlag* stop,
    const std::function<void(std::size_t index, const model::Keyframe&, KeyframeTracer&)>& put,
    Clipped clipped = Clipped::kHeldBack);

}  // namespace turnlight::estimator::observe
