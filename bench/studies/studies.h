// The studies: what each one's scenes are, as jobs.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "bench/studies/job_runner.h"

namespace turnlight::studies {

// Scenes [begin, end) of a study.
struct Range {
  int begin = 0;
  int end = 0;
};

// Random scenes that an estimate without a hint must get right (random_scene.h).
std::vector<Job> RandomJobs(Range scenes);

// The sessions of a folder of data that were made or photographed elsewhere: all that have a
// truth.json. Each is estimated without a hint by the program's own function.
Result<std::vector<Job>> SessionJobs(const std::filesystem::path& data);

}  // namespace turnlight::studies
