// The estimate of a session, from its folder to the folder of the result: what `estimate` does, and
// what ends `run`, `resume` and `replay`, so that all give the same bits.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"
#include "estimator/model/model_choice.h"
#include "rig/capture/closure_check.h"

namespace turnlight::app {

// d0 of the paper's method: the height of a ceiling.
inline constexpr double kCeilingDistanceM = 2.5;

struct SessionEstimateOptions {
  std::optional<int> views;                  // frames floor(i F / N)
  std::string initial;                       // a truth.json or result.json; empty: none
  std::string method = "lm";                 // or "paper"
  std::optional<double> ceiling_distance_m;  // of "paper" only; metres
  estimator::model::ModelChoice model;       // of "lm" only
  bool pictures = true;
};

struct SessionEstimate {
  std::string json;     // result.json, as written
  std::string summary;  // for a person, ended with what was written
  std::optional<rig::ClosureCheck> closure;
};

// Creates out. Says the verdict of the closure check before the long part. Fails with kNoEstimate
// if the session gives none, in words that say what to do.
Result<SessionEstimate> EstimateSession(const std::filesystem::path& session,
                                        const std::filesystem::path& out,
                                        const SessionEstimateOptions& options);

}  // namespace turnlight::app
