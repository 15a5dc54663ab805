// An estimate beside the truth: which light is which, and every quantity with its error and its
// stated sigmas. Both are read as files have them (truth.json, result.json), so that a study
// measures what a user gets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/studies/study_file.h"
#include "estimator/model/scene.h"

namespace turnlight::studies {

// Beyond this a found light is taken for another one than the true one that is matched with it.
inline constexpr double kSameLightDeg = 10.0;

struct Match {
  std::size_t truth = 0, found = 0;
  double angle_deg = 0.0;  // between the directions from W's origin
};

// Pairs of true and found lights, nearest pairs first, each light in at most one.
std::vector<Match> MatchLights(const std::vector<Eigen::Vector3d>& truth,
                               const std::vector<Eigen::Vector3d>& found);

// One number of a result. A direction's value is its angle off the truth in degrees, whose truth
// is 0. In files: [name, light or -1, truth, value, sigma, statistical part or null].
struct Quantity {
  std::string name;
  int light = -1;  // number of the true light
  double truth = 0.0, value = 0.0;
  std::optional<double> sigma;  // sigma_total
  std::optional<double> sigma_stat;

  double Error() const { return value - truth; }
  std::optional<double> ErrorInSigmas() const;  // absolute
};
Json ToJson(const Quantity& quantity);
Quantity QuantityFromJson(const Json& json);

// The quantities of the lights that are matched within max_angle_deg, and of the reflectance. Only
// what is not null in the result is there.
std::vector<Quantity> CompareWithTruth(const estimator::model::Scene& truth, const Json& result,
                                       const std::vector<Match>& matches, double max_angle_deg);

// The first keys of a record, all that directions alone can tell: lights_true, lights_found, right
// (the count), angles_deg (of the true lights, null: not found).
Json ScoreDirections(const std::vector<Eigen::Vector3d>& truth,
                     const std::vector<Eigen::Vector3d>& found);

// The part of a record that every study of estimates shares: those, quantities, notes (codes), rms,
// pixels, time_s, iterations, say (one line for people). Where the count is wrong, lights further
// off than same_light_deg have no quantities.
Json Score(const estimator::model::Scene& truth, const Json& result,
           double same_light_deg = kSameLightDeg);

}  // namespace turnlight::studies
