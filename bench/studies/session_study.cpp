#include <algorithm>
#include <chrono>

#include "app/scene_input.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "estimator/from_session/session_estimate.h"
#include "estimator/results/result_json.h"

namespace turnlight::studies {
namespace {

// A photograph's truth may be directions alone; then nothing else is compared.
struct Truth {
  estimator::model::Scene scene;
  bool directions_only = false;
};

Result<Truth> ReadTruth(const std::filesystem::path& path) {
  const auto scene = app::ReadScene(path);
  if (scene) return Truth{*scene, false};
  const auto guess = app::ReadInitialGuess(path);
  if (!guess) return Forward(scene);
  return Truth{{guess->lights, {}}, true};
}

Json EstimateAndScore(const std::filesystem::path& folder) {
  const auto truth = ReadTruth(folder / "truth.json");
  if (!truth) return Json{{"failed", truth.error().text}};
  const auto start = std::chrono::steady_clock::now();
  const auto done = estimator::from_session::EstimateSession(folder);
  if (!done) return Json{{"failed", done.error().text}};
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - start;
  const std::string json = estimator::results::ResultToJson(
      done->output.estimate, done->session.name, estimator::results::Method::kLeastSquares,
      {done->load_s, total.count()});
  Json record = Score(truth->scene, Json::parse(json));
  if (!truth->directions_only) return record;
  Json directions = Json::array();
  for (const Json& quantity : record["quantities"])
    if (quantity[0] == "direction") directions.push_back(quantity);
  record["quantities"] = directions;
  return record;
}

}  // namespace

Result<std::vector<Job>> SessionJobs(const std::filesystem::path& data) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(data, error))
    if (std::filesystem::exists(entry.path() / "truth.json") &&
        std::filesystem::exists(entry.path() / "session.json"))
      folders.push_back(entry.path());
  if (folders.empty()) return InputError(data.string() + ": no session with a truth.json in it");
  std::sort(folders.begin(), folders.end());
  std::vector<Job> jobs;
  for (const auto& folder : folders)
    jobs.push_back({folder.filename().string(), [folder] { return EstimateAndScore(folder); }});
  return jobs;
}

}  // namespace turnlight::studies
