// What the estimator fits: one entry per usable pixel of every keyframe, as a structure of arrays.
//
// Coordinates are the solver's: about a reference point in W, lengths divided by the target's
// radius R, axes those of W, radiances divided by a unit of their own. In single precision: 76
// bytes a pixel with colour, 68 without, and 16 more where the target can shadow itself, and 8
// where the sensor's noise is known.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/observe/bfloat16.h"
#include "estimator/observe/block_choice.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Pixels are stored in tiles of this many; a last tile of a keyframe is filled with weightless
// pixels.
inline constexpr std::size_t kTile = 256;

// Of Observations::at_white: the channels' bits; and that of a pixel beside one at white.
inline constexpr std::uint8_t kAtWhite = 7, kBesideWhite = 0x40;

struct HeldBack {
  std::size_t at = 0;  // its place in the planes
  std::uint32_t pixel = 0;
  std::uint8_t at_white = 0;  // what it has there when it is taken
};

struct Observations {
  int channels = 3;                                     // 1 grey, 3 colour
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  // in W: centroid of the observed surface
  double radius = 1.0;                                  // R, session's length unit
  double radiance_unit = 1.0;  // of white: what 1 in radiance is; see radiance_unit.h

  // Normal and mirrored direction are means over the pixel's footprint; so the normal is a little
  // shorter than 1 where the surface bends, and n.l is the mean of Lambert's term. The position is
  // the mean too, put back on the surface along the face's normal: where the surface bends the mean
  // lies below it.
  std::array<std::vector<float>, 3> position;  // x: (p_W - reference) / R
  std::array<std::vector<float>, 3> normal;    // W axes
  std::array<std::vector<float>, 3>
      mirrored;  // w: the view direction mirrored about the normal, unit
  std::array<std::vector<BFloat16>, 6>
      footprint;                               // dw/du (3), dw/dv (3): change of w across the pixel
  std::array<std::vector<BFloat16>, 6> step;   // dx/du, dx/dv: change of x across the pixel
  std::array<std::vector<float>, 3> radiance;  // linear; `channels` of them are filled
  std::vector<std::uint32_t> pixel;            // row * width + column; kNoPixel for filling
  // Where the sensor's noise is known, else empty: of a pixel's radiances (the mean over the
  // channels), and what it weighs in residuals: the reference sigma over its own, so that weighted
  // residuals are in radiance still. The reference is the median pixel's.
  bool weighted = false;
  std::vector<float> variance, weight;
  // Of weighted ones: the reference sigma's square, and what was added to every variance.
  double reference_variance = 0.0, floor_variance = 0.0;
  // Of each pixel, bit c: its radiance in channel c is at white, so that it was this or more; the
  // residual there is one-sided in the normal equations, where channels are together as soon as one
  // of them is. Bit 6: it is beside one at white. Bit 7: it is in a highlight (photograph.h).
  // Empty: no pixel has any.
  bool one_sided = false;
  std::vector<std::uint8_t> at_white;
  std::vector<float> tile_footprint;  // per tile: the largest change of w across a pixel, rad

  // Only where the target can shadow itself: what it takes to cast shadows on it.
  const target::Geometry* caster = nullptr;       // outlives the observations
  std::array<std::vector<float>, 3> face_normal;  // geometric normal, unit, W axes
  std::vector<std::uint32_t> keyframe;            // of each pixel
  std::vector<calib::Pose> X_TW;                  // per keyframe
  int width = 0;                                  // of the pictures
  bool subsampled = false;                        // pixels have lost their neighbours
  BlockChoice blocks;                             // of each keyframe's pixels; by default all

  // Keyframe k's tiles (before subsampling) are [tile_begin[k], tile_begin[k + 1]).
  std::vector<std::size_t> tile_begin{0};
  std::size_t used = 0;  // pixels that are not filling
  // Pixels at white and beside them, which are filling until a model is known that can tell what
  // they are worth (TakeHeldBack): at white it was this or more, and beside it charge may have
  // spilled over.
  std::vector<HeldBack> held_back;
  // How many independent pixels they are worth, where weights say that neighbours go together; 0:
  // as many as are used.
  double independent = 0.0;

  static constexpr std::uint32_t kNoPixel = 0xFFFFFFFFu;
  // So many entries, all of them filling. channels, caster, weighted and one_sided must be set.
  void Resize(std::size_t size);
  double WeightOf(std::size_t i) const {
    return weight.empty() ? 1.0 : static_cast<double>(weight[i]);
  }
  // Whether all that is known of a radiance of it is that it was this or more.
  bool IsAtWhite(std::size_t i) const { return !at_white.empty() && (at_white[i] & kAtWhite) != 0; }
  std::size_t size() const { return pixel.size(); }
  std::size_t tiles() const { return pixel.size() / kTile; }
};

// The planes: the arrays that hold something of every pixel. What handles them alike goes through
// these lists, so that a new plane is one line in one of them. `body` is called with what filling
// has in a plane and with that plane of each of the observations, for the planes that the first of
// them holds. Filling has a unit normal and view, so that nothing it computes before its weight of
// 0 is NaN.
//
// The planes that a pixel's own picture fills.
template <typename Body, typename First, typename... Rest>
void ForEachOwnPlane(const Body& body, First& first, Rest&... rest) {
  for (std::size_t k = 0; k < 3; ++k) {
    const float unit = k == 2 ? 1.0f : 0.0f;
    body(unit, first.normal[k], rest.normal[k]...);
    body(unit, first.mirrored[k], rest.mirrored[k]...);
    if (static_cast<int>(k) < first.channels) body(0.0f, first.radiance[k], rest.radiance[k]...);
    if (first.caster != nullptr) body(0.0f, first.face_normal[k], rest.face_normal[k]...);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    body(BFloat16{0}, first.footprint[k], rest.footprint[k]...);
    body(BFloat16{0}, first.step[k], rest.step[k]...);
  }
  body(Observations::kNoPixel, first.pixel, rest.pixel...);
  if (first.caster != nullptr) body(0u, first.keyframe, rest.keyframe...);
  if (first.weighted) body(0.0f, first.variance, rest.variance...);
  if (first.one_sided) body(std::uint8_t{0}, first.at_white, rest.at_white...);
}

// All planes: also those that depend on the other pixels, the position about the reference and the
// weight.
template <typename Body, typename First, typename... Rest>
void ForEachPlane(const Body& body, First& first, Rest&... rest) {
  for (std::size_t k = 0; k < 3; ++k) body(0.0f, first.position[k], rest.position[k]...);
  if (first.weighted) body(1.0f, first.weight, rest.weight...);
  ForEachOwnPlane(body, first, rest...);
}

// Observations whose pixels are all there, with their radiances in white, get their radiance unit
// and, if they have variances, their weights.
void Complete(Observations& observations);

// The frame of observations: what it takes to make others in the same coordinates and units.
struct ObservationFrame {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  double radius = 1.0, radiance_unit = 1.0;
  int channels = 3;
  bool weighted = false;
  double reference_variance = 0.0, floor_variance = 0.0;
};
ObservationFrame FrameOf(const Observations& observations);
// One keyframe's (BuildPart), with its variances in white if the frame has weights, into that
// frame.
void CompleteIn(const ObservationFrame& frame, Observations& part);

// Pixels that were held back are used as all others, at white one-sided; and back again.
void TakeHeldBack(Observations& observations);
void HoldBack(Observations& observations);

// All pixels weigh the same.
void DropWeights(Observations& observations);

// Builds the observations of keyframes, in parallel, deterministically. flags (optional) receives
// one picture of PixelFlag bits per keyframe. Colour pictures whose channels are the same
// everywhere are taken as grey. Weighted if all keyframes have variances. Complete.
Observations BuildObservations(const std::vector<model::Keyframe>& keyframes,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               std::vector<cv::Mat1b>* flags = nullptr);

// One keyframe's, to be concatenated with others': not complete, radiances are in white.
Observations BuildPart(const model::Keyframe& keyframe, const target::Geometry& geometry,
                       const calib::RayGrid& rays);

// The observations of several keyframes, of each its part, as if built together: about the centroid
// of all. Parts must share geometry. Weighted if all parts are. Complete.
Observations Concatenate(const std::vector<Observations>& parts);

}  // namespace turnlight::estimator::observe
