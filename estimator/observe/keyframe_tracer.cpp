#include "estimator/observe/keyframe_tracer.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <variant>

#include "base/parallel.h"
#include "estimator/observe/broken_pixels.h"

namespace turnlight::estimator::observe {
namespace {

// n.v below which a pixel is grazing: at the limb of a curved surface the geometry changes by more
// than its own size across a pixel; a plane's footprint stays linear for longer.
constexpr double kGrazingCurved = 0.25;
constexpr double kGrazingPlane = 0.1;
constexpr int kSilhouetteMargin = 2;  // pixels
// Pixels of a picture of which all geometry may be held at once, 216 bytes each.
constexpr std::size_t kSmallPicture = std::size_t{1} << 20;

cv::Mat1b Eroded(const cv::Mat1b& mask, int margin) {
  cv::Mat1b result;
  cv::erode(mask, result, cv::Mat1b::ones(2 * margin + 1, 2 * margin + 1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(255));
  return result;
}

// Where the target is, and some pixels round it, so that neighbourhoods are as in the picture.
cv::Rect Surroundings(const cv::Mat1b& target) {
  constexpr int kMargin = 4;
  const cv::Rect box = cv::boundingRect(target);
  if (box.empty()) return box;
  return cv::Rect(box.x - kMargin, box.y - kMargin, box.width + 2 * kMargin,
                  box.height + 2 * kMargin) &
         cv::Rect({0, 0}, target.size());
}

bool IsTaken(std::uint8_t flag) { return flag == 0 || flag == (kSaturated | kHeldBack); }

struct InFlight {
  Result<model::Keyframe> keyframe = model::Keyframe{};
  KeyframeTracer tracer;
};

}  // namespace

KeyframeTracer::KeyframeTracer(const model::Keyframe& keyframe, std::uint32_t index,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               Clipped clipped)
    : index_(index),
      geometry_(&geometry),
      rays_(&rays),
      poses_{keyframe.X_WC, keyframe.X_WT},
      grazing_(std::holds_alternative<calib::PlaneShape>(geometry.shape()) ? kGrazingPlane
                                                                           : kGrazingCurved),
      flags_(rays.height(), rays.width(), std::uint8_t{kOffTarget}) {
  const bool small = IsTracedWhole(keyframe.mask.total());
  MarkPicture(keyframe, small ? TraceWhole(keyframe.mask) : TraceMiddles(keyframe.mask), clipped);
  candidates_ = flags_.total() - static_cast<std::size_t>(cv::countNonZero(flags_));
  for (auto& row : rows_)
    for (const TracedPixel& traced : row)
      if (!traced.geometry.smooth)
        flags_(static_cast<int>(traced.pixel) / flags_.cols,
               static_cast<int>(traced.pixel) % flags_.cols) |= kSilhouette;
}

// Both mark what is off the target or grazing, and give the target as a mask.
cv::Mat1b KeyframeTracer::TraceWhole(const cv::Mat1b& mask) {
  const PixelTracer tracer(poses_, *geometry_, *rays_);
  cv::Mat1b target(flags_.size(), std::uint8_t{0});
  rows_.resize(static_cast<std::size_t>(flags_.rows));
  ParallelFor(rows_.size(), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < flags_.cols; ++column) {
      if (mask(row, column) == 0) continue;
      const auto pixel = tracer.Trace(column, row);
      if (!pixel) continue;
      target(row, column) = 255;
      flags_(row, column) = pixel->cosine < grazing_ ? kGrazing : 0;
      rows_[r].push_back({static_cast<std::uint32_t>(row * flags_.cols + column), *pixel});
    }
  });
  return target;
}

cv::Mat1b KeyframeTracer::TraceMiddles(const cv::Mat1b& mask) {
  const PixelTracer tracer(poses_, *geometry_, *rays_);
  cv::Mat1b target(flags_.size(), std::uint8_t{0});
  ParallelFor(static_cast<std::size_t>(flags_.rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < flags_.cols; ++column) {
      if (mask(row, column) == 0) continue;
      const auto cosine = tracer.Cosine(column, row);
      if (!cosine) continue;
      target(row, column) = 255;
      flags_(row, column) = *cosine < grazing_ ? kGrazing : 0;
    }
  });
  return target;
}

// Adds what the picture and the target's outline say.
void KeyframeTracer::MarkPicture(const model::Keyframe& keyframe, const cv::Mat1b& target,
                                 Clipped clipped) {
  const cv::Rect box = Surroundings(target);
  // Charge and interpolation spill over from what is far too bright; noise does not.
  cv::Mat1b implausible(flags_.size(), std::uint8_t{0}), white = implausible.clone();
  if (clipped == Clipped::kHeldBack)
    cv::dilate(keyframe.image.saturated, white, cv::Mat1b::ones(3, 3));
  cv::Mat1b broken;
  if (!box.empty()) {
    broken = FindBrokenPixels(keyframe.image.radiance(box), target(box));
    cv::Mat1b inside_box = implausible(box);
    inside_box |= (broken & kImplausible) != 0;
  }
  cv::dilate(implausible, implausible, cv::Mat1b::ones(3, 3));
  const cv::Mat1b inside = Eroded(target, kSilhouetteMargin);
  for (int row = 0; row < flags_.rows; ++row)
    for (int column = 0; column < flags_.cols; ++column) {
      std::uint8_t& flag = flags_(row, column);
      if (implausible(row, column) != 0)
        flag |= kSaturated;
      else if (white(row, column) != 0)
        flag |= kSaturated | kHeldBack;
      if (target(row, column) == 0) continue;
      if (inside(row, column) == 0) flag |= kSilhouette;
      const std::uint8_t found = broken(row - box.y, column - box.x);
      if ((found & kOutlier) != 0) flag |= kUnlikeOthers;
      if ((found & kFloored) != 0) flag |= kLostInNoise;
    }
}

void KeyframeTracer::LeaveOut(const cv::Mat1b& pixels) { flags_ |= (pixels != 0) & kNotTaken; }

std::vector<TracedPixel> KeyframeTracer::TracedRow(int row, const BlockChoice& choice) {
  const PixelTracer tracer(poses_, *geometry_, *rays_);
  const std::vector<bool> kept = choice.KeptInRow(index_, row, flags_.cols);
  std::vector<TracedPixel> out;
  for (int column = 0; column < flags_.cols; ++column) {
    if ((flags_(row, column) & kOffTarget) != 0) continue;
    if (!kept[static_cast<std::size_t>(column / BlockChoice::kSide)]) continue;
    const auto pixel = tracer.Trace(column, row);
    if (!pixel || !pixel->smooth) flags_(row, column) |= kSilhouette;
    if (IsTaken(flags_(row, column)))
      out.push_back({static_cast<std::uint32_t>(row * flags_.cols + column), *pixel});
  }
  return out;
}

std::vector<std::vector<TracedPixel>> KeyframeTracer::Rows(int begin, int end,
                                                           const BlockChoice& choice) {
  std::vector<std::vector<TracedPixel>> out(static_cast<std::size_t>(end - begin));
  if (rows_.empty()) {
    ParallelFor(out.size(),
                [&](std::size_t i) { out[i] = TracedRow(begin + static_cast<int>(i), choice); });
    return out;
  }
  ParallelFor(out.size(), [&](std::size_t i) {
    const int row = begin + static_cast<int>(i);
    const std::vector<bool> kept = choice.KeptInRow(index_, row, flags_.cols);
    out[i] = std::move(rows_[static_cast<std::size_t>(row)]);
    std::erase_if(out[i], [&](const TracedPixel& traced) {
      const int column = static_cast<int>(traced.pixel) - row * flags_.cols;
      return !IsTaken(flags_(row, column)) ||
             !kept[static_cast<std::size_t>(column / BlockChoice::kSide)];
    });
  });
  return out;
}

std::size_t KeyframesInFlight(std::size_t picture_pixels) {
  return std::max<std::size_t>(2 * kSmallPicture / std::max<std::size_t>(picture_pixels, 1), 2);
}

bool IsTracedWhole(std::size_t picture_pixels) { return picture_pixels <= kSmallPicture; }

Status TraceKeyframes(
    const model::KeyframeSource& keyframes, const target::Geometry& geometry,
    const calib::RayGrid& rays, const StopFlag* stop,
    const std::function<void(std::size_t index, const model::Keyframe&, KeyframeTracer&)>& put,
    Clipped clipped) {
  const std::size_t at_a_time =
      KeyframesInFlight(static_cast<std::size_t>(rays.width()) * rays.height());
  for (std::size_t first = 0; first < keyframes.size(); first += at_a_time) {
    std::vector<InFlight> batch(std::min(at_a_time, keyframes.size() - first));
    ParallelFor(batch.size(), [&](std::size_t i) {
      if (StopRequested(stop)) return;
      batch[i].keyframe = keyframes.read(first + i);
      if (!batch[i].keyframe) return;
      batch[i].tracer = KeyframeTracer(*batch[i].keyframe, static_cast<std::uint32_t>(first + i),
                                       geometry, rays, clipped);
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (StopRequested(stop)) return InterruptedError();
      if (!batch[i].keyframe) return Forward(batch[i].keyframe);
      put(first + i, *batch[i].keyframe, batch[i].tracer);
      batch[i] = {};
    }
  }
  return {};
}

}  // namespace turnlight::estimator::observe
