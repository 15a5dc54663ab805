// Runs the scenes of a study, each in a process of its own: a crash, a hang or a memory hog is a
// record that says so, and the others go on.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/studies/study_file.h"

namespace turnlight::studies {

struct Job {
  std::string id;             // unique, sorts in the order of the study
  std::function<Json()> run;  // called in the child, which has one thread
};

struct RunOptions {
  int processes = 1;
  double deadline_s = 600.0;  // of each job
  std::filesystem::path out;  // empty: nothing is written
  bool fresh = false;         // false: records of the same program stay as they are
};

// Goes on with the file at `out` if there is one, and saves every few seconds. Lines of progress go
// to standard error. The process must not have started threads.
Result<StudyFile> RunJobs(const std::string& study, const std::vector<Job>& jobs,
                          const RunOptions& options);

}  // namespace turnlight::studies
