// Standard output and standard error when nobody is there any more: a pipe whose reader has ended,
// a terminal that was closed, a disk that is full, a descriptor that was closed from the start.
#pragma once

#include <memory>
#include <thread>
#include <vector>

namespace turnlight::app {

// From its construction to its end std::cout writes through it and a write that fails is known.
// SIGPIPE is ignored: it would end the program in the middle of a motion. The three standard
// descriptors are open afterwards, so that no file of ours becomes one of them; one that was closed
// takes no writes. One at a time, before any other thread.
class StandardOutput {
 public:
  StandardOutput();
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  // Writes what is left. Gives the exit code: the one given, or instead of kDone what a failed
  // write makes of it: kReaderGone without a word of a pipe whose reader has ended, as other
  // programs end then; kRefused with one of everything else.
  int End(int exit_code);

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
  std::streambuf* before_;
};

// Whether SIGHUP is ignored, as nohup does.
bool HangupIsIgnored();

// While one lives, `lost` is called, from a thread of its own and once, as soon as one of the
// descriptors has nobody at its other end: a pipe without a reader, a terminal that is gone. Of
// files and of descriptors that were closed from the start nothing is called; of a terminal not if
// SIGHUP is ignored: the program is meant to outlive it.
class OutputWatch {
 public:
  OutputWatch(const std::vector<int>& descriptors, void (*lost)());
  ~OutputWatch();
  OutputWatch(const OutputWatch&) = delete;
  OutputWatch& operator=(const OutputWatch&) = delete;

 private:
  int wake_ = -1;
  std::thread thread_;
};

}  // namespace turnlight::app
