// What a scene leaves of each keyframe, robustly.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::consistency {

// How far a lamp may be off before its keyframe counts as unlike the others: what is left of a
// keyframe is taken after the best factor within this of 1.
inline constexpr double kLeastGain = 0.75, kMostGain = 1.0 / kLeastGain;

struct FrameResidual {
  std::size_t pixels = 0;
  double gain = 1.0;       // picture over model, least squares; 1 where the model is dark
  double left = 0.0;       // 80 % of the pixels are nearer to the model than this, in radiance
  double left_free = 0.0;  // the same after the best gain of all
  double level = 0.0;      // root mean square of the model
};

// Grey model radiances of every keyframe as a picture, in white; NaN where nothing is observed or a
// shadow's edge lies. size: of the pictures.
std::vector<cv::Mat1f> ModelPictures(const observe::Observations& all, const model::Scene& scene,
                                     cv::Size size);

// A picture (grey radiance) against a model picture.
FrameResidual Compare(const cv::Mat1f& picture, const cv::Mat1f& model);

// The observations of some keyframes only: the others' pixels are filling.
observe::Observations Only(const observe::Observations& all, const std::vector<bool>& frames);

// A scene that explains the observations, looked for without a hint; in their coordinates and
// radiance unit. With stop set of no use.
struct Fit {
  model::Scene scene;
  double rms = 0.0;  // of what is left, of white
};
Fit FitAnew(const observe::Observations& all, const model::ModelChoice& choice,
            const StopFlag* stop);
// The same on fewer pixels, with Lambert and Phong where nothing else is asked for: for poses that
// may be wrong, where the search for a better surface would try everything in vain.
Fit FitQuickly(const observe::Observations& all, model::ModelChoice choice, const StopFlag* stop);
// From where a scene stands, to its end.
Fit FitFrom(const observe::Observations& all, const model::Scene& from, const StopFlag* stop);
// From where a scene stands, on a sample, with little weight on what fits badly.
model::Scene FitRobustly(const observe::Observations& all, const model::Scene& from,
                         const StopFlag* stop);

}  // namespace turnlight::estimator::consistency
