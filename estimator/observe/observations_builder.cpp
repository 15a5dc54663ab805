#include "estimator/observe/observations_builder.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

constexpr int kBandPixels = 1 << 18;  // of a picture: about so many are traced before they are put

bool AllChannelsAreEqual(const cv::Mat& radiance) {
  if (radiance.channels() == 1) return true;
  const cv::Mat3f colour = radiance;
  return std::all_of(colour.begin(), colour.end(), [](const cv::Vec3f& value) {
    return value[0] == value[1] && value[1] == value[2];
  });
}

std::size_t WholeTiles(std::size_t pixels) { return (pixels + kTile - 1) / kTile * kTile; }

}  // namespace

ObservationsBuilder::ObservationsBuilder(const target::Geometry& geometry,
                                         const calib::RayGrid& rays, std::size_t keyframes,
                                         std::size_t most)
    : rays_(&rays), keyframes_(keyframes), most_(most), begin_{0} {
  out_.radius = geometry.radius();
  out_.channels = 1;
  out_.weighted = keyframes > 0;
  out_.width = rays.width();
  if (!geometry.CanShadowItself()) return;
  out_.caster = &geometry;
}

template <typename Body>
void ObservationsBuilder::ForEachArray(const Body& body) {
  for (std::vector<double>& component : position_) body(0.0, component);
  body(0.0f, footprint_size_);
  body(std::uint8_t{0}, held_back_);
  ForEachOwnPlane(body, out_);
}

void ObservationsBuilder::Resize(std::size_t size) {
  ForEachArray([size](auto filling, auto& array) { array.resize(size, filling); });
}

void ObservationsBuilder::Reserve(std::size_t size) {
  ForEachArray([size](auto, auto& array) { array.reserve(size); });
}

// Grey until a keyframe is not: what came before has then the same in every channel.
void ObservationsBuilder::TakeChannels(const cv::Mat& radiance) {
  if (out_.channels == 3 || AllChannelsAreEqual(radiance)) return;
  out_.channels = 3;
  for (std::size_t c = 1; c < 3; ++c) {
    out_.radiance[c].reserve(out_.radiance[0].capacity());
    out_.radiance[c] = out_.radiance[0];
  }
}

void ObservationsBuilder::Add(const model::Keyframe& keyframe, KeyframeTracer& tracer,
                              const cv::Mat1b* marks) {
  if (keyframe.image.variance.empty()) DropWeights(out_);
  TakeChannels(keyframe.image.radiance);
  if (out_.caster != nullptr) out_.X_TW.push_back(keyframe.X_WT.Inverse());
  usable_ += tracer.candidates();
  if (count_.empty())
    Reserve(std::min(keyframes_ * (tracer.candidates() + tracer.candidates() / 8 + kTile),
                     most_ + kBandPixels + keyframes_ * kTile));
  count_.push_back(0);
  begin_.push_back(begin_.back());
  const int height = rays_->height(), band = std::max(kBandPixels / rays_->width(), 1);
  for (int row = 0; row < height; row += band) {
    const Rows rows = tracer.Rows(row, std::min(row + band, height), out_.blocks);
    Append(keyframe, tracer.flags(), marks, rows);
    while (used_ > most_) Thin();
  }
  begin_.back() = begin_[begin_.size() - 2] + WholeTiles(count_.back());
  Resize(begin_.back());
}

void ObservationsBuilder::Append(const model::Keyframe& keyframe, const cv::Mat1b& flags,
                                 const cv::Mat1b* marks, const Rows& rows) {
  std::vector<std::size_t> at{begin_[begin_.size() - 2] + count_.back()};
  for (const auto& row : rows) at.push_back(at.back() + row.size());
  Resize(at.back());
  count_.back() += at.back() - at.front();
  used_ += at.back() - at.front();
  ParallelFor(rows.size(), [&](std::size_t r) {
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const auto pixel = static_cast<int>(rows[r][i].pixel);
      Put(keyframe, rows[r][i], at[r] + i);
      if (marks != nullptr) out_.at_white[at[r] + i] = marks->data[pixel];
      if ((flags(pixel / flags.cols, pixel % flags.cols) & kHeldBack) == 0) continue;
      const bool clipped = keyframe.image.saturated(pixel / flags.cols, pixel % flags.cols) != 0;
      held_back_[at[r] + i] = clipped ? kAtWhite : kBesideWhite;
    }
  });
}

void ObservationsBuilder::Put(const model::Keyframe& keyframe, const TracedPixel& traced,
                              std::size_t at) {
  const PixelGeometry& g = traced.geometry;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    position_[k][at] = g.position[i];
    out_.normal[k][at] = static_cast<float>(g.normal[i]);
    out_.mirrored[k][at] = static_cast<float>(g.mirrored[i]);
    out_.footprint[k][at] = ToBFloat16(static_cast<float>(g.dw_du[i]));
    out_.footprint[3 + k][at] = ToBFloat16(static_cast<float>(g.dw_dv[i]));
    out_.step[k][at] = ToBFloat16(static_cast<float>(g.dx_du[i] / out_.radius));
    out_.step[3 + k][at] = ToBFloat16(static_cast<float>(g.dx_dv[i] / out_.radius));
    if (out_.caster != nullptr) out_.face_normal[k][at] = static_cast<float>(g.face_normal[i]);
  }
  const cv::Mat& image = keyframe.image.radiance;
  const int row = static_cast<int>(traced.pixel) / image.cols;
  const int column = static_cast<int>(traced.pixel) % image.cols;
  const float* value =
      image.ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * image.channels();
  for (int c = 0; c < out_.channels; ++c)
    out_.radiance[static_cast<std::size_t>(c)][at] = value[image.channels() == 1 ? 0 : c];
  if (out_.weighted) out_.variance[at] = keyframe.image.variance(row, column);
  if (out_.caster != nullptr) out_.keyframe[at] = static_cast<std::uint32_t>(count_.size() - 1);
  out_.pixel[at] = traced.pixel;
  footprint_size_[at] = static_cast<float>(g.dw_du.norm() + g.dw_dv.norm());
}

// Gives up the blocks that the next smaller choice does not keep; what stays moves up.
void ObservationsBuilder::Thin() {
  out_.blocks = out_.blocks.Fewer();
  std::vector<std::uint8_t> kept(out_.pixel.size(), 0);
  const auto old_begin = begin_;
  const auto old_count = count_;
  const int width = rays_->width();
  ParallelFor(count_.size(), [&](std::size_t k) {
    std::vector<bool> in_row;
    int of_row = -1;
    std::size_t count = 0;
    for (std::size_t i = old_begin[k]; i < old_begin[k] + old_count[k]; ++i) {
      const int row = static_cast<int>(out_.pixel[i]) / width;
      const int column = static_cast<int>(out_.pixel[i]) % width;
      if (row != of_row)
        in_row = out_.blocks.KeptInRow(static_cast<std::uint32_t>(k), of_row = row, width);
      kept[i] = in_row[static_cast<std::size_t>(column / BlockChoice::kSide)] ? 1 : 0;
      count += kept[i];
    }
    count_[k] = count;
  });
  for (std::size_t k = 0; k + 1 < count_.size(); ++k)
    begin_[k + 1] = begin_[k] + WholeTiles(count_[k]);
  begin_.back() = begin_[count_.size() - 1];  // where the last, unfinished keyframe begins
  used_ = 0;
  for (const std::size_t count : count_) used_ += count;
  const std::size_t size = begin_.back() + count_.back();
  ForEachArray([&](auto filling, auto& array) {
    for (std::size_t k = 0; k < count_.size(); ++k) {
      std::size_t to = begin_[k];
      for (std::size_t i = old_begin[k]; i < old_begin[k] + old_count[k]; ++i)
        if (kept[i] != 0) array[to++] = array[i];
      if (k + 1 < count_.size())
        std::fill(array.begin() + static_cast<std::ptrdiff_t>(to),
                  array.begin() + static_cast<std::ptrdiff_t>(begin_[k + 1]), filling);
    }
    array.resize(size);
  });
}

// What was held back becomes filling, and is remembered.
void ObservationsBuilder::RememberHeldBack() {
  for (std::size_t i = 0; i < out_.size(); ++i)
    if (held_back_[i] != 0) out_.held_back.push_back({i, out_.pixel[i], held_back_[i]});
  held_back_ = {};
  out_.used = used_;
  HoldBack(out_);
}

Observations ObservationsBuilder::Finish() {
  RememberHeldBack();
  for (std::size_t k = 0; k < count_.size(); ++k) out_.tile_begin.push_back(begin_[k + 1] / kTile);
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < out_.size(); ++i)
    if (out_.pixel[i] != Observations::kNoPixel)
      sum += Vector3d(position_[0][i], position_[1][i], position_[2][i]);
  if (out_.used > 0) out_.reference = sum / static_cast<double>(out_.used);
  for (std::size_t k = 0; k < 3; ++k) {
    out_.position[k].assign(out_.size(), 0.0f);
    const double origin = out_.reference[static_cast<Eigen::Index>(k)];
    const auto about_reference = [&](std::size_t i) {
      return static_cast<float>((position_[k][i] - origin) / out_.radius);
    };
    for (std::size_t i = 0; i < out_.size(); ++i)
      if (out_.pixel[i] != Observations::kNoPixel) out_.position[k][i] = about_reference(i);
    for (const HeldBack& held : out_.held_back)
      out_.position[k][held.at] = about_reference(held.at);
    position_[k] = {};
  }
  out_.tile_footprint.assign(out_.tiles(), 0.0f);
  for (std::size_t i = 0; i < out_.size(); ++i)
    out_.tile_footprint[i / kTile] = std::max(out_.tile_footprint[i / kTile], footprint_size_[i]);
  footprint_size_ = {};
  if (out_.weighted) out_.weight.assign(out_.size(), 1.0f);
  return std::move(out_);
}

}  // namespace turnlight::estimator::observe
