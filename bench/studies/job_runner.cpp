#include "bench/studies/job_runner.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <deque>
#include <utility>

#include "base/parallel.h"

namespace turnlight::studies {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSaveEverySeconds = 5.0;
constexpr int kPollMilliseconds = 100;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Child {
  const Job* job = nullptr;
  pid_t pid = -1;
  int pipe = -1;
  std::string output;
  Clock::time_point start;
  bool late = false;
};

// In the child: runs the job, sends its record through the pipe, and is gone.
[[noreturn]] void RunInChild(const Job& job, int pipe) {
  SetThreads(1);
  const std::string text = job.run().dump();
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = write(pipe, text.data() + sent, text.size() - sent);
    if (count <= 0) _exit(1);
    sent += static_cast<std::size_t>(count);
  }
  _exit(0);
}

Result<Child> Start(const Job& job) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return SystemError("no pipe for " + job.id);
  const pid_t pid = fork();
  if (pid < 0) return SystemError("no process for " + job.id);
  if (pid == 0) {
    close(ends[0]);
    RunInChild(job, ends[1]);
  }
  close(ends[1]);
  return Child{&job, pid, ends[0], {}, Clock::now(), false};
}

// Takes what the child has written; false at its end.
bool Drain(Child& child) {
  char buffer[65536];
  const ssize_t count = read(child.pipe, buffer, sizeof buffer);
  if (count > 0) child.output.append(buffer, static_cast<std::size_t>(count));
  return count > 0;
}

Json Collect(Child& child, double deadline_s) {
  int status = 0;
  struct rusage usage {};
  wait4(child.pid, &status, 0, &usage);
  close(child.pipe);
  Json record = Json::parse(child.output, nullptr, false);
  Json failed;
  if (child.late)
    failed = "not done after " + std::to_string(static_cast<int>(deadline_s)) + " s";
  else if (WIFSIGNALED(status))
    failed = "ended by signal " + std::to_string(WTERMSIG(status));
  else if (record.is_discarded() || WEXITSTATUS(status) != 0)
    failed = "ended with code " + std::to_string(WEXITSTATUS(status)) + " and no record";
  if (!failed.is_null()) record = Json{{"failed", failed}};
  Json whole{{"id", child.job->id}};
  whole.update(record);
  whole["job_s"] = Rounded(Since(child.start), 3);
  whole["peak_mb"] = Rounded(static_cast<double>(usage.ru_maxrss) / 1024.0, 3);
  return whole;
}

class Runner {
 public:
  Runner(StudyFile file, const RunOptions& options)
      : file_(std::move(file)),
        options_(options),
        commit_(TreeCommit()),
        build_(ProgramHash()),
        saved_(Clock::now()) {}

  Status Run(const std::vector<Job>& jobs) {
    for (const Job& job : jobs) {
      const auto found = file_.records.find(job.id);
      if (found == file_.records.end() || options_.fresh ||
          found->second.value("build", "") != build_)
        waiting_.push_back(&job);
    }
    total_ = waiting_.size();
    while (!waiting_.empty() || !running_.empty()) {
      while (!waiting_.empty() && running_.size() < static_cast<std::size_t>(options_.processes)) {
        auto child = Start(*waiting_.front());
        if (!child) return Forward(child);
        waiting_.pop_front();
        running_.push_back(std::move(*child));
      }
      Turn();
      if (Since(saved_) > kSaveEverySeconds)
        if (const Status status = Save(); !status) return status;
    }
    return Save();
  }

  StudyFile Take() { return std::move(file_); }

 private:
  void Turn() {
    std::vector<pollfd> polled;
    polled.reserve(running_.size());
    for (const Child& child : running_) polled.push_back({child.pipe, POLLIN, 0});
    poll(polled.data(), polled.size(), kPollMilliseconds);
    for (std::size_t i = polled.size(); i-- > 0;) {
      Child& child = running_[i];
      if (!child.late && Since(child.start) > options_.deadline_s) {
        child.late = true;
        kill(child.pid, SIGKILL);
      }
      if (polled[i].revents == 0 || Drain(child)) continue;
      Keep(Collect(child, options_.deadline_s));
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  void Keep(Json record) {
    record["commit"] = commit_;
    record["build"] = build_;
    const std::string id = record["id"];
    ++done_;
    const std::string said = record.contains("failed") ? record["failed"].get<std::string>()
                                                       : record.value("say", std::string());
    std::fprintf(stderr, "%zu/%zu  %s  %.1f s  %s\n", done_, total_, id.c_str(),
                 record.value("job_s", 0.0), said.c_str());
    file_.records[id] = std::move(record);
  }

  Status Save() {
    saved_ = Clock::now();
    return options_.out.empty() ? Status{} : WriteStudyFile(file_, options_.out);
  }

  StudyFile file_;
  const RunOptions& options_;
  std::string commit_, build_;
  std::deque<const Job*> waiting_;
  std::vector<Child> running_;
  Clock::time_point saved_;
  std::size_t total_ = 0, done_ = 0;
};

}  // namespace

Result<StudyFile> RunJobs(const std::string& study, const std::vector<Job>& jobs,
                          const RunOptions& options) {
  StudyFile file{study, {}};
  if (!options.out.empty() && std::filesystem::exists(options.out)) {
    auto before = ReadStudyFile(options.out);
    if (!before) return Forward(before);
    if (before->study != study)
      return InputError(options.out.string() + ": holds the study \"" + before->study +
                        "\", not \"" + study + "\"");
    file = std::move(*before);
  }
  Runner runner(std::move(file), options);
  if (const Status status = runner.Run(jobs); !status) return Forward(status);
  return runner.Take();
}

}  // namespace turnlight::studies
