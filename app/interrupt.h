// Ctrl-C. The first one lets the file that is being written be finished, then the program ends with
// exit code 130; where nothing is being written it ends at once. The second one ends it at once.
#pragma once

namespace turnlight::app {

void InstallInterruptHandler();

// Whether Ctrl-C was pressed; commands look between two frames.
bool Interrupted();

// While one lives, nothing is being written, and Ctrl-C ends the program at once.
class InterruptAtOnce {
 public:
  InterruptAtOnce();
  ~InterruptAtOnce();
  InterruptAtOnce(const InterruptAtOnce&) = delete;
  InterruptAtOnce& operator=(const InterruptAtOnce&) = delete;
};

}  // namespace turnlight::app
