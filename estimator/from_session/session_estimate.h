// From a session's folder to an estimate: what the command line, the end of a run and the studies
// call, so that all give the same bits. Writes nothing, prints nothing and takes no signals.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "estimator/estimate.h"
#include "estimator/model/initial_guess.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/model/model_choice.h"
#include "estimator/next_view.h"
#include "estimator/results/words.h"
#include "estimator/target/geometry.h"
#include "rig/capture/closure_check.h"
#include "rig/session/session.h"

namespace turnlight::estimator::from_session {

// d0 of the paper's method, in metres: the height of a ceiling.
inline constexpr double kCeilingDistanceM = 2.5;

// In their order.
enum class Stage {
  kReading,  // frames read and traced
  kStarting,
  kRefining,
  kBudget,   // only of a calibrated session
  kChecking  // of frames and poses, if they may not fit; then perhaps the others once more
};

// What most_pixels may be.
inline constexpr std::size_t kFewestPixels = 10'000, kMostPixelsAllowed = 1'000'000'000;

struct Options {
  results::Method method = results::Method::kLeastSquares;
  std::optional<int> views;                    // frames floor(i F / N), 1..F
  std::vector<std::size_t> frames;             // these, ascending; not beside views; empty: all
  std::optional<model::InitialGuess> initial;  // of kLeastSquares only
  model::ModelChoice model;                    // of kLeastSquares only; no lights beside initial
  std::optional<double> ceiling_distance_m;    // of kPaper only; metres

  std::size_t most_pixels = observe::kMostPixels;  // held at a time; kFewestPixels and more
  // Which view to take next: asked; and of how many the directions would be known to so many
  // radians.
  bool next_view = false;
  std::optional<double> wanted_direction_sigma;
  // Bytes: an estimate that would need more is refused before it begins. Changes no result.
  std::optional<double> max_memory;
  // Of how many keyframes whose residual maps are made; none: no maps.
  std::function<std::vector<std::size_t>(std::size_t keyframes)> residuals_of;

  // Told as a stage begins (done 0) and as its parts are done, up to total: the frames of kReading;
  // the others have one part, and are told of its end when the next begins or all is done. Never
  // from two threads at a time.
  std::function<void(Stage stage, std::size_t done, std::size_t total)> progress;
  // The verdict of the closure check, before the long part. Not called without a closure frame.
  std::function<void(const rig::ClosureCheck& closure)> on_closure;
  // Set: the call ends soon, with kInterrupted.
  const StopFlag* stop = nullptr;
};

struct SessionEstimate {
  rig::Session session;
  // The frames chosen, less those that were left out, in their order; read anew each time.
  model::KeyframeSource keyframes;
  target::Geometry geometry;
  EstimateOutput output;  // with a note if the capture did not close
  std::optional<rig::ClosureCheck> closure;
  std::optional<ViewAdvice> next_view;  // if it was asked for
  double load_s = 0.0;                  // seconds until the estimate began, for people
};

// Frames are read one after another, a few at a time. Fails with kInput (what ReadSession,
// ReadSessionCalibration, ReadTarget, ReadFrameImages and CheckClosure refuse; options that do not
// go together), with kNoEstimate if the session gives none, in words that say what to do, and with
// kInterrupted.
Result<SessionEstimate> EstimateSession(const std::filesystem::path& folder,
                                        const Options& options = {});

}  // namespace turnlight::estimator::from_session
