#include "bench/studies/session_score.h"

#include <chrono>
#include <string>

#include "app/scene_input.h"
#include "bench/studies/score.h"
#include "estimator/results/result_json.h"

namespace turnlight::studies {

Result<SessionTruth> ReadSessionTruth(const std::filesystem::path& folder) {
  const auto scene = app::ReadScene(folder / "truth.json");
  if (scene) return SessionTruth{*scene, false};
  const auto guess = app::ReadInitialGuess(folder / "truth.json");
  if (!guess) return Forward(scene);
  return SessionTruth{{guess->lights, {}}, true};
}

Json EstimateAndScoreSession(const std::filesystem::path& folder,
                             const estimator::from_session::Options& options) {
  const auto truth = ReadSessionTruth(folder);
  if (!truth) return Json{{"failed", truth.error().text}};
  const auto start = std::chrono::steady_clock::now();
  const auto done = estimator::from_session::EstimateSession(folder, options);
  if (!done) return Json{{"failed", done.error().text}};
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - start;
  const std::string json = estimator::results::ResultToJson(
      done->output.estimate, done->session.name, options.method, {done->load_s, total.count()});
  // A direction is judged by its sigma however far off it is.
  constexpr double kAll = 180.0;
  Json record =
      Score(truth->scene, Json::parse(json), truth->directions_only ? kAll : kSameLightDeg);
  if (!truth->directions_only) return record;
  Json directions = Json::array();
  for (const Json& quantity : record["quantities"])
    if (quantity[0] == "direction") directions.push_back(quantity);
  record["quantities"] = directions;
  return record;
}

}  // namespace turnlight::studies
