#include "estimator/observations.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "estimator/broken_pixels.h"

namespace turnlight::estimator {
namespace {

using Eigen::Vector3d;

// n.v below which a pixel is grazing: at the limb of a curved surface the geometry changes by more
// than its own size across a pixel; a plane's footprint stays linear for longer.
constexpr double kGrazingCurved = 0.25;
constexpr double kGrazingPlane = 0.1;
constexpr int kSilhouetteMargin = 2;  // pixels

// One pixel's geometry in W.
struct PixelGeometry {
  Vector3d position, normal, face_normal, mirrored;
  Vector3d dw_du = Vector3d::Zero(), dw_dv = Vector3d::Zero();
  Vector3d dx_du = Vector3d::Zero(), dx_dv = Vector3d::Zero();
  double cosine = 0.0;  // n.v
  bool smooth = false;  // the footprint lies on one smooth piece of surface
};

Vector3d Mirror(const Vector3d& to_viewer, const Vector3d& normal) {
  return (2.0 * normal.dot(to_viewer) * normal - to_viewer).normalized();
}

// The mean over a pixel of what has these values at its centre and in the middle of its edges,
// exact for second-order surfaces: f + a^2 (f_uu + f_vv) / 24. At the limb it is 1e-4 off the
// centre.
Vector3d MeanOver(const Vector3d& center, const Vector3d& left, const Vector3d& right,
                  const Vector3d& up, const Vector3d& down) {
  return center + (left + right + up + down - 4.0 * center) * (kAperture * kAperture / 6.0);
}

struct Hit {
  Vector3d mirrored_T;
  SurfacePoint point;
  Vector3d to_viewer_T;
};

class FrameTracer {
 public:
  FrameTracer(const Keyframe& keyframe, const Geometry& geometry, const calib::RayGrid& rays)
      : keyframe_(keyframe),
        geometry_(geometry),
        rays_(rays),
        X_TC_(keyframe.X_WT.Inverse() * keyframe.X_WC) {}

  std::optional<PixelGeometry> Trace(int column, int row) const {
    const auto center = TraceRay(column, row, 0.0, 0.0);
    if (!center) return std::nullopt;
    PixelGeometry pixel;
    const Eigen::Matrix3d& R_WT = keyframe_.X_WT.rotation;
    pixel.position = keyframe_.X_WT * center->point.position;
    pixel.normal = R_WT * center->point.normal;
    pixel.face_normal = R_WT * center->point.geometric_normal;
    pixel.mirrored = R_WT * center->mirrored_T;
    pixel.cosine = std::min(center->point.normal.dot(center->to_viewer_T),
                            center->point.geometric_normal.dot(center->to_viewer_T));
    const auto left = TraceRay(column, row, -0.5, 0.0), right = TraceRay(column, row, 0.5, 0.0);
    const auto up = TraceRay(column, row, 0.0, -0.5), down = TraceRay(column, row, 0.0, 0.5);
    if (!left || !right || !up || !down) return pixel;
    pixel.normal = R_WT * MeanOver(center->point.normal, left->point.normal, right->point.normal,
                                   up->point.normal, down->point.normal);
    const Vector3d& n = center->point.geometric_normal;
    const Vector3d bend =
        MeanOver(center->point.position, left->point.position, right->point.position,
                 up->point.position, down->point.position) -
        center->point.position;
    pixel.position = keyframe_.X_WT * (center->point.position + bend - n.dot(bend) * n);
    pixel.mirrored = R_WT * MeanOver(center->mirrored_T, left->mirrored_T, right->mirrored_T,
                                     up->mirrored_T, down->mirrored_T)
                                .normalized();
    pixel.dw_du = R_WT * (right->mirrored_T - left->mirrored_T);
    pixel.dw_dv = R_WT * (down->mirrored_T - up->mirrored_T);
    pixel.dx_du = R_WT * (right->point.position - left->point.position);
    pixel.dx_dv = R_WT * (down->point.position - up->point.position);
    pixel.smooth = Smooth(*left, *center, *right) && Smooth(*up, *center, *down);
    return pixel;
  }

 private:
  std::optional<Hit> TraceRay(int column, int row, double du, double dv) const {
    const Vector3d ray = rays_.Ray(column, row, du, dv);
    if (!ray.allFinite()) return std::nullopt;
    const Vector3d direction = X_TC_.rotation * ray;
    auto point = geometry_.Intersect(X_TC_.translation, direction);
    if (!point) return std::nullopt;
    const Vector3d to_viewer = -direction.normalized();
    return Hit{Mirror(to_viewer, point->normal), *point, to_viewer};
  }

  // Three points in a row on one smooth piece: the middle one is near the mean of the others, both
  // in place (a jump of depth) and in mirrored direction (a crease).
  bool Smooth(const Hit& a, const Hit& b, const Hit& c) const {
    const double bend = (a.point.position + c.point.position - 2.0 * b.point.position).norm();
    const double step = (a.point.position - c.point.position).norm();
    const double turn_bend = (a.mirrored_T + c.mirrored_T - 2.0 * b.mirrored_T).norm();
    const double turn = (a.mirrored_T - c.mirrored_T).norm();
    return bend <= 0.3 * step + 1e-9 * geometry_.radius() && turn_bend <= 0.3 * turn + 0.002;
  }

  const Keyframe& keyframe_;
  const Geometry& geometry_;
  const calib::RayGrid& rays_;
  calib::Pose X_TC_;
};

// A keyframe's usable pixels, before they are packed.
struct FramePixels {
  std::vector<PixelGeometry> geometry;
  std::vector<std::uint32_t> pixel;
  cv::Mat1b flags;
};

cv::Mat1b Eroded(const cv::Mat1b& mask, int margin) {
  cv::Mat1b result;
  cv::erode(mask, result, cv::Mat1b::ones(2 * margin + 1, 2 * margin + 1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(255));
  return result;
}

FramePixels TraceKeyframe(const Keyframe& keyframe, const Geometry& geometry,
                          const calib::RayGrid& rays) {
  const int width = rays.width(), height = rays.height();
  const FrameTracer tracer(keyframe, geometry, rays);
  std::vector<std::optional<PixelGeometry>> traced(static_cast<std::size_t>(width) * height);
  cv::Mat1b target(height, width, std::uint8_t{0});
  ParallelFor(static_cast<std::size_t>(height), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < width; ++column) {
      if (keyframe.mask(row, column) == 0) continue;
      auto& pixel = traced[r * width + column];
      pixel = tracer.Trace(column, row);
      if (pixel) target(row, column) = 255;
    }
  });
  const cv::Mat1b inside = Eroded(target, kSilhouetteMargin);
  const cv::Mat1b broken = FindBrokenPixels(keyframe.image.radiance, target);
  // Charge and interpolation spill over from what is far too bright; noise does not.
  cv::Mat1b saturated = keyframe.image.saturated | ((broken & kImplausible) != 0);
  cv::dilate(saturated, saturated, cv::Mat1b::ones(3, 3));
  const double grazing =
      std::holds_alternative<calib::PlaneShape>(geometry.shape()) ? kGrazingPlane : kGrazingCurved;
  FramePixels out;
  out.flags.create(height, width);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::size_t index = static_cast<std::size_t>(row) * width + column;
      const auto& pixel = traced[index];
      std::uint8_t flag = 0;
      if (!pixel) flag |= kOffTarget;
      if (saturated(row, column) != 0) flag |= kSaturated;
      if ((broken(row, column) & kOutlier) != 0) flag |= kUnlikeOthers;
      if ((broken(row, column) & kFloored) != 0) flag |= kLostInNoise;
      if (pixel && (inside(row, column) == 0 || !pixel->smooth)) flag |= kSilhouette;
      if (pixel && pixel->cosine < grazing) flag |= kGrazing;
      out.flags(row, column) = flag;
      if (flag != 0) continue;
      out.geometry.push_back(*pixel);
      out.pixel.push_back(static_cast<std::uint32_t>(index));
    }
  return out;
}

bool ChannelsAreEqual(const std::vector<Keyframe>& keyframes) {
  for (const Keyframe& keyframe : keyframes) {
    const cv::Mat& image = keyframe.image.radiance;
    if (image.channels() == 1) continue;
    const cv::Mat3f colour = image;
    for (const cv::Vec3f& value : colour)
      if (value[0] != value[1] || value[1] != value[2]) return false;
  }
  return true;
}

void Resize(Observations& out, std::size_t size) {
  for (int i = 0; i < 3; ++i) {
    // Filling has a unit normal and view, so that nothing it computes before its weight of 0 is
    // NaN.
    const float unit = i == 2 ? 1.0f : 0.0f;
    out.position[i].assign(size, 0.0f);
    out.normal[i].assign(size, unit);
    out.mirrored[i].assign(size, unit);
    if (i < out.channels) out.radiance[i].assign(size, 0.0f);
  }
  for (auto& component : out.footprint) component.assign(size, 0);
  for (auto& component : out.step) component.assign(size, 0);
  if (out.caster != nullptr) {
    for (auto& component : out.face_normal) component.assign(size, 0.0f);
    out.keyframe.assign(size, 0);
  }
  out.pixel.assign(size, Observations::kNoPixel);
  out.tile_footprint.assign(size / kTile, 0.0f);
}

void Pack(const Keyframe& keyframe, const FramePixels& frame, std::uint32_t index,
          Observations& out) {
  const std::size_t first_tile = out.tile_begin[index];
  const cv::Mat& image = keyframe.image.radiance;
  for (std::size_t i = 0; i < frame.pixel.size(); ++i) {
    const std::size_t at = first_tile * kTile + i;
    const PixelGeometry& g = frame.geometry[i];
    const Vector3d x = (g.position - out.reference) / out.radius;
    for (int k = 0; k < 3; ++k) {
      out.position[k][at] = static_cast<float>(x[k]);
      out.normal[k][at] = static_cast<float>(g.normal[k]);
      out.mirrored[k][at] = static_cast<float>(g.mirrored[k]);
      out.footprint[k][at] = ToBFloat16(static_cast<float>(g.dw_du[k]));
      out.footprint[3 + k][at] = ToBFloat16(static_cast<float>(g.dw_dv[k]));
      out.step[k][at] = ToBFloat16(static_cast<float>(g.dx_du[k] / out.radius));
      out.step[3 + k][at] = ToBFloat16(static_cast<float>(g.dx_dv[k] / out.radius));
    }
    const int row = static_cast<int>(frame.pixel[i]) / image.cols;
    const int column = static_cast<int>(frame.pixel[i]) % image.cols;
    const float* value =
        image.ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * image.channels();
    for (int c = 0; c < out.channels; ++c) out.radiance[c][at] = value[c];
    if (out.caster != nullptr) {
      out.keyframe[at] = index;
      for (int k = 0; k < 3; ++k) out.face_normal[k][at] = static_cast<float>(g.face_normal[k]);
    }
    out.pixel[at] = frame.pixel[i];
    float& largest = out.tile_footprint[at / kTile];
    largest = std::max(largest, static_cast<float>(g.dw_du.norm() + g.dw_dv.norm()));
  }
}

}  // namespace

BFloat16 ToBFloat16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<BFloat16>((bits + 0x7FFFu + (bits >> 16 & 1u)) >> 16);
}

float FromBFloat16(BFloat16 value) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(value) << 16);
}

Observations BuildObservations(const std::vector<Keyframe>& keyframes, const Geometry& geometry,
                               const calib::RayGrid& rays, std::vector<cv::Mat1b>* flags) {
  std::vector<FramePixels> frames(keyframes.size());
  ParallelFor(keyframes.size(),
              [&](std::size_t k) { frames[k] = TraceKeyframe(keyframes[k], geometry, rays); });
  Observations out;
  out.radius = geometry.radius();
  out.channels = ChannelsAreEqual(keyframes) ? 1 : 3;
  if (geometry.CanShadowItself()) {
    out.caster = &geometry;
    out.width = rays.width();
    for (const Keyframe& keyframe : keyframes) out.X_TW.push_back(keyframe.X_WT.Inverse());
  }
  Vector3d sum = Vector3d::Zero();
  for (const FramePixels& frame : frames) {
    for (const PixelGeometry& pixel : frame.geometry) sum += pixel.position;
    out.used += frame.pixel.size();
    out.tile_begin.push_back(out.tile_begin.back() + (frame.pixel.size() + kTile - 1) / kTile);
  }
  if (out.used > 0) out.reference = sum / static_cast<double>(out.used);
  Resize(out, out.tile_begin.back() * kTile);
  ParallelFor(keyframes.size(), [&](std::size_t k) {
    Pack(keyframes[k], frames[k], static_cast<std::uint32_t>(k), out);
  });
  if (flags) {
    flags->clear();
    for (FramePixels& frame : frames) flags->push_back(std::move(frame.flags));
  }
  return out;
}

namespace {

// How much a pixel tells: its difference from its neighbours in the row, in grey.
std::vector<float> RowGradient(const Observations& all) {
  std::vector<float> gradient(all.size(), 0.0f);
  const auto grey = [&](std::size_t i) {
    float sum = 0.0f;
    for (int c = 0; c < all.channels; ++c) sum += all.radiance[c][i];
    return sum / static_cast<float>(all.channels);
  };
  for (std::size_t i = 1; i + 1 < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel && all.pixel[i - 1] + 1 == all.pixel[i] &&
        all.pixel[i] + 1 == all.pixel[i + 1])
      gradient[i] = std::abs(grey(i + 1) - grey(i - 1));
  return gradient;
}

template <typename T>
void Gather(const std::vector<T>& from, const std::vector<std::size_t>& picked,
            std::vector<T>& to) {
  for (std::size_t i = 0; i < picked.size(); ++i) to[i] = from[picked[i]];
}

// The pixels at these places, in one run of tiles.
Observations Picked(const Observations& all, const std::vector<std::size_t>& picked) {
  Observations out;
  out.channels = all.channels;
  out.reference = all.reference;
  out.radius = all.radius;
  out.caster = all.caster;
  out.width = all.width;
  out.X_TW = all.X_TW;
  out.subsampled = true;
  out.used = picked.size();
  out.tile_begin.push_back((picked.size() + kTile - 1) / kTile);
  Resize(out, out.tile_begin.back() * kTile);
  for (int k = 0; k < 3; ++k) {
    Gather(all.position[k], picked, out.position[k]);
    Gather(all.normal[k], picked, out.normal[k]);
    Gather(all.mirrored[k], picked, out.mirrored[k]);
    if (k < all.channels) Gather(all.radiance[k], picked, out.radiance[k]);
  }
  for (int k = 0; k < 6; ++k) {
    Gather(all.footprint[k], picked, out.footprint[k]);
    Gather(all.step[k], picked, out.step[k]);
  }
  Gather(all.pixel, picked, out.pixel);
  if (out.caster != nullptr) {
    for (int k = 0; k < 3; ++k) Gather(all.face_normal[k], picked, out.face_normal[k]);
    Gather(all.keyframe, picked, out.keyframe);
  }
  for (std::size_t i = 0; i < picked.size(); ++i)
    out.tile_footprint[i / kTile] =
        std::max(out.tile_footprint[i / kTile], all.tile_footprint[picked[i] / kTile]);
  return out;
}

}  // namespace

Observations Concatenate(const std::vector<Observations>& parts) {
  Observations out;
  out.channels = 1;
  Vector3d sum = Vector3d::Zero();
  std::size_t tiles = 0;
  for (const Observations& part : parts) {
    out.radius = part.radius;
    out.caster = part.caster;
    out.width = part.width;
    out.X_TW.insert(out.X_TW.end(), part.X_TW.begin(), part.X_TW.end());
    if (part.used > 0) out.channels = std::max(out.channels, part.channels);
    out.used += part.used;
    sum += static_cast<double>(part.used) * part.reference;
    tiles += part.tiles();
    out.tile_begin.push_back(tiles);
  }
  if (out.used > 0) out.reference = sum / static_cast<double>(out.used);
  Resize(out, tiles * kTile);
  std::size_t at = 0;
  std::uint32_t first_keyframe = 0;
  const auto put = [&at](const auto& from, auto& to) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
  };
  for (const Observations& part : parts) {
    const Eigen::Vector3f shift = ((part.reference - out.reference) / out.radius).cast<float>();
    for (int k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < part.size(); ++i)
        out.position[k][at + i] = part.position[k][i] + shift[k];
      put(part.normal[k], out.normal[k]);
      put(part.mirrored[k], out.mirrored[k]);
      if (k < out.channels) put(part.radiance[part.channels == 1 ? 0 : k], out.radiance[k]);
    }
    for (int k = 0; k < 6; ++k) {
      put(part.footprint[k], out.footprint[k]);
      put(part.step[k], out.step[k]);
    }
    put(part.pixel, out.pixel);
    if (out.caster != nullptr) {
      for (int k = 0; k < 3; ++k) put(part.face_normal[k], out.face_normal[k]);
      for (std::size_t i = 0; i < part.size(); ++i)
        out.keyframe[at + i] = part.keyframe[i] + first_keyframe;
      first_keyframe += static_cast<std::uint32_t>(part.X_TW.size());
    }
    std::copy(part.tile_footprint.begin(), part.tile_footprint.end(),
              out.tile_footprint.begin() + static_cast<std::ptrdiff_t>(at / kTile));
    at += part.size();
  }
  return out;
}

Observations Subsample(const Observations& all, std::size_t count, std::uint64_t seed) {
  const std::vector<float> gradient = RowGradient(all);
  double mean = 0.0;
  for (const float value : gradient) mean += value;
  mean = std::max(mean / static_cast<double>(std::max<std::size_t>(all.used, 1)), 1e-12);
  const auto weight = [&](std::size_t i) {
    return 0.5 + 0.5 * std::min(static_cast<double>(gradient[i]) / mean, 20.0);
  };
  double total = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) total += weight(i);
  const RandomStream random(seed, 0);
  std::vector<std::size_t> picked;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel &&
        random.Uniform(i) * total < weight(i) * static_cast<double>(count))
      picked.push_back(i);
  return Picked(all, picked);
}

Observations EvenSubsample(const Observations& all, std::size_t count, std::uint64_t seed,
                           const std::vector<std::uint8_t>* usable) {
  const auto used = [&](std::size_t i) {
    return all.pixel[i] != Observations::kNoPixel && (usable == nullptr || (*usable)[i] != 0);
  };
  std::size_t total = 0;
  for (std::size_t i = 0; i < all.size(); ++i) total += used(i) ? 1 : 0;
  const RandomStream random(seed, 0);
  std::vector<std::size_t> picked;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i) && random.Uniform(i) * static_cast<double>(total) < static_cast<double>(count))
      picked.push_back(i);
  return Picked(all, picked);
}

}  // namespace turnlight::estimator
