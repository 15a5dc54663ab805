// Pictures looked at once more as photographs of a real surface: whatever the model, some of it
// will not fit, by more than noise and smoothly. What then tells the lights are the highlights,
// clipped as they may be. Pixels weigh by what a model is expected to leave of them.
#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/observe/highlight_spots.h"
#include "estimator/observe/observations.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// The bit of Observations::at_white of pixels in and around a highlight.
inline constexpr std::uint8_t kInHighlight = 0x80;

struct Photograph {
  // Clipped pixels are in it, one-sided. A weighted residual of kWeighedSigma is one sigma.
  Observations pixels;
  std::vector<SpotCluster> spots;
};

inline constexpr double kWeighedSigma = 0.01;

// What a model is expected to leave of a value y: noise, 0.07 % of the brightest, 2 % of y, and
// what half a pixel's shift changes; of clipped pixels and beside them, as charge spills over, at
// least 15 % of y. Outside highlights all of it goes together over an area of `correlated` pixels.
struct PhotographOptions {
  double correlated = 33.0;  // pixels
  // Pixels that are taken, outside highlights and in them; of more, so many.
  std::size_t most_shaded = 3000, most_bright = 100000;
  const StopFlag* stop = nullptr;
};

// Fails as the source does, and with kInterrupted.
Result<Photograph> TakePhotograph(const model::KeyframeSource& keyframes,
                                  const target::Geometry& geometry, const calib::RayGrid& rays,
                                  const PhotographOptions& options = {});

}  // namespace turnlight::estimator::observe
