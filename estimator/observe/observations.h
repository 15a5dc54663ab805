// What the estimator fits: one entry per usable pixel of every keyframe, as a structure of arrays.
//
// Coordinates are the solver's: about a reference point in W, lengths divided by the target's
// radius R, axes those of W. In single precision: 76 bytes a pixel with colour, 68 without, and 16
// more where the target can shadow itself, and 8 where the sensor's noise is known.
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

struct Observations {
  int channels = 3;                                     // 1 grey, 3 colour
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  // in W: centroid of the observed surface
  double radius = 1.0;                                  // R, session's length unit

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
  double level = 1.0;                          // what the keyframes' radiances were multiplied by
  std::vector<std::uint32_t> pixel;            // row * width + column; kNoPixel for filling
  // Where the sensor's noise is known, else empty: of a pixel's radiances (the mean over the
  // channels), and what it weighs in residuals: the reference sigma over its own, so that weighted
  // residuals are in radiance still. The reference is the median pixel's.
  std::vector<float> variance, weight;
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

  static constexpr std::uint32_t kNoPixel = 0xFFFFFFFFu;
  // So many entries, all of them filling: its normal and view are unit, so that nothing it computes
  // before its weight of 0 is NaN. channels and caster must be set.
  void Resize(std::size_t size);
  double WeightOf(std::size_t i) const {
    return weight.empty() ? 1.0 : static_cast<double>(weight[i]);
  }
  std::size_t size() const { return pixel.size(); }
  std::size_t tiles() const { return pixel.size() / kTile; }
};

// Sets the weights from the variances, which must be known.
void SetWeights(Observations& observations);

// Builds the observations of keyframes, in parallel, deterministically. flags (optional) receives
// one picture of PixelFlag bits per keyframe. Colour pictures whose channels are the same
// everywhere are taken as grey. Weighted if all keyframes have variances.
Observations BuildObservations(const std::vector<model::Keyframe>& keyframes,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               std::vector<cv::Mat1b>* flags = nullptr);

// The observations of several keyframes, each built alone, as if built together: about the centroid
// of all. Parts must share geometry; none may be a subsample. Weighted if all parts are.
Observations Concatenate(const std::vector<Observations>& parts);

}  // namespace turnlight::estimator::observe
