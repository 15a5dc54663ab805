// The pictures that an estimate is judged by with the eye. Values in, values out: no files.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::pictures {

struct NamedPicture {
  std::string name;  // a file name, such as "comparison_000.png"
  cv::Mat3b image;   // R, G, B
};

// For at most six keyframes, number floor(i F / 6), NNN being the keyframe's number:
//   comparison_NNN.png  original | relit | virtual sphere of the estimated material in the scene
//   residual_NNN.png    observed minus model, grey
// for the first three frames that were left out, NNN being their number in the session:
//   residual_left_out_NNN.png
// and once:
//   intensity_map.png   intensity by reflected direction with the lights found
//   convergence.png     residual rms by iteration
//   correlation.png     how the errors of what was estimated go together
// A picture that has nothing to show (no keyframes, no history, an empty map, no two errors) is
// left out.
//
// Tone: linear radiance to sRGB, one exposure for all panels of all keyframes: the 99.5 percentile
// of the brightest channel on the target is shown at 0.9 of white.
// Size: pictures less than 480 pixels wide are enlarged by a whole factor, those of more than 960
// are reduced by one, originals and models alike.
//
// The keyframes' pictures have the camera's size; they are read one at a time. Residuals of other
// keyframes are drawn too if output has them. Fails as the source does. Deterministic for any
// number of threads.
Result<std::vector<NamedPicture>> MakePictures(const model::KeyframeSource& keyframes,
                                               const target::Geometry& geometry,
                                               const calib::CameraModel& camera,
                                               const EstimateOutput& output);

// The numbers of those keyframes, of so many.
std::vector<std::size_t> ShownKeyframes(std::size_t count);

}  // namespace turnlight::estimator::pictures
