#include <sys/resource.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <utility>

#include "base/format.h"
#include "bench/studies/photograph_summary.h"
#include "bench/studies/photographs.h"
#include "bench/studies/score.h"
#include "bench/studies/session_score.h"
#include "bench/studies/studies.h"

namespace turnlight::studies {
namespace {

namespace fs = std::filesystem;

constexpr char kScript[] = TURNLIGHT_SOURCE_DIR "/bench/peers/highlight_centroids.py";

// For the shell.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}
// Processor time of this process, or of those that it has waited for.
double ProcessorTime(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
}

Json ScoreScript(const fs::path& folder) {
  const auto truth = ReadSessionTruth(folder);
  if (!truth) return Json{{"failed", truth.error().text}};
  FILE* pipe = popen((Quoted(kScript) + " " + Quoted(folder.string())).c_str(), "r");
  if (!pipe) return Json{{"failed", "no process for the script"}};
  std::string text;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), count);
  const int status = pclose(pipe);
  const Json json = Json::parse(text, nullptr, false);
  if (status != 0 || json.is_discarded())
    return Json{{"failed", Format("%s: ended with status %d, python3-opencv and python3-numpy are "
                                  "needed",
                                  kScript, status)}};
  std::vector<Eigen::Vector3d> directions, found;
  for (const estimator::model::Light& light : truth->scene.lights)
    directions.push_back(light.direction);
  for (const Json& light : json["lights"]) {
    const auto direction = light["direction"].get<std::array<double, 3>>();
    found.emplace_back(direction[0], direction[1], direction[2]);
  }
  Json record = ScoreDirections(directions, found);
  record["quantities"] = Json::array();
  record["notes"] = Json::array();
  return record;
}

Json ScoreBy(const std::string& method, const fs::path& folder) {
  if (method == "script") return ScoreScript(folder);
  estimator::from_session::Options options;
  if (method == "paper") options.method = estimator::results::Method::kPaper;
  return EstimateAndScoreSession(folder, options);
}

Json Measure(const PhotographScene& scene, const std::string& method, const fs::path& scratch) {
  fs::path folder = scene.sessions.front();
  if (scene.sessions.size() > 1) {
    // A name of its own: scenes are measured side by side.
    std::string name = scene.id + "_" + method;
    std::replace(name.begin(), name.end(), '/', '_');
    folder = scratch / name;
    if (const Status status = WriteSum(scene.sessions, folder); !status)
      return Json{{"failed", status.error().text}};
  }
  const int who = method == "script" ? RUSAGE_CHILDREN : RUSAGE_SELF;
  const double before = ProcessorTime(who);
  Json record = ScoreBy(method, folder);
  record["cpu_s"] = Rounded(ProcessorTime(who) - before, 3);
  if (scene.sessions.size() > 1) fs::remove_all(folder);
  return record;
}

}  // namespace

Result<std::vector<Job>> PhotographJobs(const fs::path& data, Range range,
                                        const fs::path& scratch) {
  const auto scenes = PhotographScenes(data);
  if (!scenes) return Forward(scenes);
  std::vector<Job> jobs;
  for (int i = range.begin; i < range.end && i < static_cast<int>(scenes->size()); ++i) {
    const PhotographScene& scene = (*scenes)[static_cast<std::size_t>(i)];
    for (const std::string method : kPhotographMethods)
      jobs.push_back({scene.id + "/" + method,
                      [scene, method, scratch] { return Measure(scene, method, scratch); }});
  }
  if (jobs.empty())
    return InputError(
        Format("--scenes: %d:%d, there are %zu", range.begin, range.end, scenes->size()));
  return jobs;
}

}  // namespace turnlight::studies
