#include <algorithm>

#include "app/session_estimate.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "rig/sim/scene_file.h"

namespace turnlight::studies {
namespace {

// A photograph's truth may be directions alone; then nothing else is compared.
struct Truth {
  estimator::model::Scene scene;
  bool directions_only = false;
};

Result<Truth> ReadTruth(const std::filesystem::path& path) {
  const auto scene = rig::sim::ReadScene(path);
  if (scene) return Truth{*scene, false};
  const auto guess = rig::sim::ReadInitialGuess(path);
  if (!guess) return Forward(scene);
  return Truth{{guess->lights, {}}, true};
}

Json EstimateAndScore(const std::filesystem::path& folder) {
  const auto truth = ReadTruth(folder / "truth.json");
  if (!truth) return Json{{"failed", truth.error().text}};
  std::string out = (std::filesystem::temp_directory_path() / "turnlight-study-XXXXXX").string();
  if (!mkdtemp(out.data())) return Json{{"failed", "no temporary folder"}};
  app::SessionEstimateOptions options;
  options.pictures = false;
  const auto done = app::EstimateSession(folder, out, options);
  std::error_code ignored;
  std::filesystem::remove_all(out, ignored);
  if (!done) return Json{{"failed", done.error().text}};
  Json record = Score(truth->scene, Json::parse(done->json));
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
