// Keyframes that do not belong to the others.
#pragma once

#include <string>
#include <vector>

#include "base/stop_flag.h"
#include "estimator/consistency/frame_residuals.h"
#include "estimator/consistency/small_views.h"
#include "estimator/model/model_choice.h"
#include "estimator/observe/observations.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::consistency {

struct FrameJudgement {
  FrameResidual residual;       // against the scene of the frames that are not odd
  double mask_on_target = 1.0;  // of what the target covers, inside the mask; 1 without a mask
  bool odd = false, odd_mask = false;  // odd_mask: by its mask
  std::string what;                    // of an odd one: what is odd about it, "is black"
};

struct FramesJudged {
  std::vector<FrameJudgement> frames;
  double usual = 0.0;        // what is left of a usual frame, radiance
  double level = 0.0;        // radiance of the model in a usual frame, rms
  model::Scene scene;        // of the frames that are not odd, in the observations' coordinates
  double rms_of_all = 0.0;   // what a fit of all frames leaves
  double rms_of_rest = 0.0;  // of those that are not odd; of all, if none is
  double noise = 0.0;        // sigma of a small pixel, radiance
  std::size_t odd = 0;
};

// The fewest frames of which one can be told from the others, the fewest pixels of them, and the
// largest share of odd ones.
inline constexpr std::size_t kFewestJudged = 5;
inline constexpr std::size_t kFewestPixels = 300;
inline constexpr double kMostOdd = 1.0 / 3.0;

// `all` are the observations of the views with their poses. A frame is odd if what is left of it is
// at least four times the usual, beyond the frames' scatter, 0.4 % of the level and noise; if it is
// brighter or dimmer than its neighbours by more than 3 % and six times the scatter of such
// differences; or if its mask lets through less of the target than the other masks do.
//
// The scene is found by concentration: fitted to all, then to the seven tenths that it leaves least
// of, until these are the same, and if much is left also from every third frame; then anew to all
// that are not odd by it (Rousseeuw and Van Driessen, "Computing LTS Regression for Large Data
// Sets", 2006). If more than kMostOdd are odd, none is. Of fewer
// than kFewestPixels nothing is said: no frames. Deterministic for any number of threads.
FramesJudged JudgeFrames(const SmallViews& views, const observe::Observations& all,
                         const target::Geometry& geometry, const calib::RayGrid& rays,
                         const model::ModelChoice& choice, const StopFlag* stop);

}  // namespace turnlight::estimator::consistency
