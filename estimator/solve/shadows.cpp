#include "estimator/solve/shadows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "estimator/observe/observation_access.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kChunk = 4096;  // observations per unit of parallel work
constexpr double kEdgeMargin = 1.25;  // half footprints around an attached shadow's edge

struct LightMasks {
  PixelMask lit, blocked;
};

// A surface point that faces away from the light is neither lit nor blocked.
LightMasks Cast(const observe::Observations& all, const model::Light& light) {
  auto lit = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{0});
  auto blocked = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{0});
  ParallelFor((all.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(all.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel) continue;
      const Vector3d x = observe::At(all.position, i);
      const Vector3d to_light = light.Toward(x);
      if (!(observe::At(all.normal, i).dot(to_light) > 0.0)) continue;
      const double length = to_light.norm();
      const double distance = light.inverse_distance > 0.0
                                  ? length / light.inverse_distance * all.radius
                                  : std::numeric_limits<double>::infinity();
      const calib::Pose& X_TW = all.X_TW[all.keyframe[i]];
      const bool occluded = all.caster->Occluded(X_TW * (all.reference + all.radius * x),
                                                 X_TW.rotation * observe::At(all.face_normal, i),
                                                 X_TW.rotation * (to_light / length), distance);
      (occluded ? *blocked : *lit)[i] = 1;
    }
  });
  return {std::move(lit), std::move(blocked)};
}

bool Near(const model::Light& a, const model::Light& b, double tolerance) {
  return (a.direction - b.direction).norm() <= tolerance &&
         std::abs(a.inverse_distance - b.inverse_distance) <= tolerance;
}

// Marks every pixel through which the edge of an attached shadow runs: the mean of a clamped cosine
// is not the cosine clamped. With w = 2 (n.v) n - v the normal turns by at most |dw| / (2 n.v).
void MarkTerminators(const observe::Observations& all, const std::vector<model::Light>& lights,
                     double half_footprints, std::vector<std::uint8_t>& usable) {
  ParallelFor((all.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(all.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel) continue;
      const Vector3d x = observe::At(all.position, i), n = observe::At(all.normal, i);
      const double turn =
          (observe::At(all.footprint, 0, i).norm() + observe::At(all.footprint, 3, i).norm()) /
          (2.0 * std::max(n.dot(observe::At(all.mirrored, i)), 0.05));
      const double margin = 0.5 * half_footprints * turn;
      for (const model::Light& light : lights) {
        const Vector3d to_light = light.Toward(x);
        if (std::abs(n.dot(to_light)) < margin * to_light.norm()) usable[i] = 0;
      }
    }
  });
}

// Where the pixels of three rows of a keyframe are among the observations, as one goes down its
// picture.
class RowsAround {
 public:
  static constexpr std::uint32_t kNone = observe::Observations::kNoPixel;

  // Of the observations [begin, end), whose pixels rise.
  RowsAround(const observe::Observations& all, std::size_t begin, std::size_t end)
      : all_(all), next_(begin), end_(end), width_(static_cast<std::uint32_t>(all.width)) {
    index_.assign(std::size_t{3} * width_, kNone);
  }

  // On to a row, not above the one before.
  void GoTo(std::uint32_t row) {
    for (; next_ < end_; ++next_) {
      if (all_.pixel[next_] == kNone) continue;
      const std::uint32_t of = all_.pixel[next_] / width_;
      if (of > row + 1) return;
      if (held_[of % 3] != of) {
        std::fill_n(index_.begin() + static_cast<std::ptrdiff_t>(of % 3 * width_), width_, kNone);
        held_[of % 3] = of;
      }
      index_[of % 3 * width_ + all_.pixel[next_] % width_] = static_cast<std::uint32_t>(next_);
    }
  }
  // Of a pixel in the row or one beside it.
  std::uint32_t At(std::int64_t row, std::int64_t column) const {
    if (row < 0 || column < 0 || column >= width_) return kNone;
    const auto r = static_cast<std::uint32_t>(row);
    return held_[r % 3] == r ? index_[r % 3 * width_ + static_cast<std::uint32_t>(column)] : kNone;
  }

 private:
  const observe::Observations& all_;
  std::size_t next_, end_;
  std::uint32_t width_;
  std::vector<std::uint32_t> index_;
  std::array<std::uint32_t, 3> held_{kNone, kNone, kNone};
};

// Marks, within keyframe k, every pixel one of whose eight neighbours is lit while it is blocked,
// or the other way round; also those whose neighbours were given up with their block, for an edge
// could run between them.
void MarkCastEdges(const observe::Observations& all, std::size_t k, const Shadows& shadows,
                   std::vector<std::uint8_t>& usable) {
  const std::size_t begin = all.tile_begin[k] * observe::kTile,
                    end = all.tile_begin[k + 1] * observe::kTile;
  RowsAround around(all, begin, end);
  const auto differs = [&](std::size_t i, std::size_t j) {
    for (std::size_t l = 0; l < shadows.lit.size(); ++l)
      if (((*shadows.lit[l])[i] & (*shadows.blocked[l])[j]) != 0 ||
          ((*shadows.blocked[l])[i] & (*shadows.lit[l])[j]) != 0)
        return true;
    return false;
  };
  const auto given_up = [&](std::int64_t row, std::int64_t column) {
    return row >= 0 && column >= 0 && column < all.width &&
           !all.blocks.Keeps(static_cast<std::uint32_t>(k), static_cast<int>(column),
                             static_cast<int>(row));
  };
  for (std::size_t i = begin; i < end; ++i) {
    if (all.pixel[i] == RowsAround::kNone) continue;
    const auto width = static_cast<std::uint32_t>(all.width);
    const auto column = static_cast<std::int64_t>(all.pixel[i] % width);
    const auto row = static_cast<std::int64_t>(all.pixel[i] / width);
    around.GoTo(static_cast<std::uint32_t>(row));
    for (std::int64_t r = row - 1; r <= row + 1; ++r)
      for (std::int64_t c = column - 1; c <= column + 1; ++c) {
        const std::uint32_t at = around.At(r, c);
        if (at != RowsAround::kNone ? differs(i, at) : given_up(r, c)) usable[i] = 0;
      }
  }
}

}  // namespace

Shadows CastShadows(const observe::Observations& all, const model::Scene& scene,
                    const Shadows& previous, double tolerance) {
  Shadows out;
  out.lights = scene.lights;
  for (model::Light& light : out.lights) {
    const auto same =
        std::find_if(previous.lights.begin(), previous.lights.end(),
                     [&](const model::Light& p) { return Near(light, p, tolerance); });
    const auto at = static_cast<std::size_t>(same - previous.lights.begin());
    if (same != previous.lights.end()) light = *same;  // or it could drift away in small steps
    if (all.caster == nullptr) continue;
    if (same != previous.lights.end()) {
      out.lit.push_back(previous.lit[at]);
      out.blocked.push_back(previous.blocked[at]);
    } else {
      LightMasks masks = Cast(all, light);
      out.lit.push_back(std::move(masks.lit));
      out.blocked.push_back(std::move(masks.blocked));
    }
  }
  if (!all.subsampled) {
    auto usable = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{1});
    MarkTerminators(all, out.lights, kEdgeMargin, *usable);
    if (all.caster != nullptr)
      ParallelFor(all.tile_begin.size() - 1,
                  [&](std::size_t k) { MarkCastEdges(all, k, out, *usable); });
    out.left_out =
        static_cast<std::size_t>(std::count(usable->begin(), usable->end(), std::uint8_t{0}));
    out.usable = std::move(usable);
  }
  return out;
}

PixelMask AwayFromTerminators(const observe::Observations& all,
                              const std::vector<model::Light>& lights, double margin) {
  auto away = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{1});
  MarkTerminators(all, lights, margin, *away);
  return away;
}

bool SameShadows(const Shadows& a, const Shadows& b) {
  const auto same = [](const PixelMask& x, const PixelMask& y) {
    return x == y || (x && y && *x == *y);
  };
  return std::equal(a.lit.begin(), a.lit.end(), b.lit.begin(), b.lit.end(), same) &&
         same(a.usable, b.usable);
}

}  // namespace turnlight::estimator::solve
