// Whether keyframes, their poses and a model belong together: which frames do not, and which change
// of all poses would explain the pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/stop_flag.h"
#include "estimator/consistency/odd_frames.h"
#include "estimator/consistency/small_views.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/scene.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::consistency {

// A change of all poses, or of the pictures' order, that was tried.
struct TriedChange {
  std::string code, words, question;
  double factor = 1.0;        // of angle-factor
  double left = 0.0;          // rms that some lights leave (Explainer), radiance
  std::optional<double> rms;  // that a fit leaves; only of the most promising
};

struct Consistency {
  bool comparable = false;  // two views or more that are not all black; else all below is empty
  bool seen = false;        // enough pixels see the target with the poses as they are
  bool fits = false;  // a fit leaves noise, or 1 % of the level, of the frames that are not odd
  FramesJudged frames;
  double rms = 0.0;  // what a fit with the poses as they are leaves of those frames
  std::optional<model::Scene> scene;  // that fit's, in W; what the frames are judged against
  double left = 0.0;                  // and some lights (Explainer)
  std::vector<TriedChange> tried;     // best first; empty if the frames alone explain what is wrong
  // What explains the pictures: at most half of the residual is left, of what is seen not less, or
  // the outlines fit. Where the poses as they are see nothing: the outlines fit, those of the
  // masks if there are any.
  std::optional<TriedChange> change;
  // Other changes that the pictures cannot tell from it, as words.
  std::vector<std::string> alike;
};

// angles_deg: of each view, or empty. all_changes: changes of poses are tried also where nothing is
// left for them to explain. With stop set it returns soon, with what it had found by then.
Consistency CheckConsistency(const SmallViews& views, const std::vector<double>& angles_deg,
                             const target::Geometry& geometry, const model::ModelChoice& choice,
                             bool all_changes, const StopFlag* stop);

}  // namespace turnlight::estimator::consistency
