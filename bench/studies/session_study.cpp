#include <algorithm>

#include "bench/studies/session_score.h"
#include "bench/studies/studies.h"

namespace turnlight::studies {

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
    jobs.push_back(
        {folder.filename().string(), [folder] { return EstimateAndScoreSession(folder); }});
  return jobs;
}

}  // namespace turnlight::studies
