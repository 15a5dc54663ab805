// The program with somebody at the other end of its outputs, who may leave.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace turnlight::app {

enum class Line {
  kTerminal,         // the terminal that controls it: it gets SIGHUP when that is closed
  kForeignTerminal,  // no signal, only writes that fail
  kPipe,             // both outputs
  kPipeOfOutput,     // standard output alone; standard error goes to /dev/null
  kPipeOfErrors      // standard error alone
};
enum class Hangup { kDefault, kIgnored };  // SIGHUP when the program begins; nohup has it ignored

class Listener {
 public:
  Listener(Line line, const std::vector<std::string>& arguments, Hangup hangup = Hangup::kDefault);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // Whether the text is said within 30 seconds.
  bool Hears(const std::string& text);
  // Closes this end.
  void Leave();
  // The exit code, as app::Finish; within 30 seconds, or the program is killed.
  int Finish();

 private:
  int end_ = -1;
  pid_t process_ = -1;
  std::string heard_;
};

}  // namespace turnlight::app
