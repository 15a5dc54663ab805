// Ctrl-C, SIGTERM, and a terminal that is closed (SIGHUP). The first one lets the file that is
// being written be finished, then the program ends with exit code 130; where nothing is being
// written it ends at once, an estimate at its next iteration. A second Ctrl-C or SIGTERM ends it at
// once; a closed terminal says so more than once, and that counts as one. A SIGHUP that is ignored
// when the program begins, as by nohup, stays ignored.
#pragma once

#include <optional>

#include "app/outputs.h"
#include "base/stop_flag.h"
#include "nodes/graph/graph.h"

namespace turnlight::app {

void InstallInterruptHandler();
// Nobody is left to read an output: as SIGHUP. For an OutputWatch.
void LoseOutput();

// Whether it was asked to end; commands look between two frames.
bool Interrupted();
// The same for calls that look themselves.
const StopFlag& InterruptFlag();

// While one lives, nothing is being written, and each of them ends the program at once; so does one
// that came before.
class InterruptAtOnce {
 public:
  InterruptAtOnce();
  ~InterruptAtOnce();
  InterruptAtOnce(const InterruptAtOnce&) = delete;
  InterruptAtOnce& operator=(const InterruptAtOnce&) = delete;
};

// While one lives, Ctrl-C stops the graph: the first as asked for, the second now; SIGTERM, SIGHUP
// and a lost output now. A third Ctrl-C or SIGTERM ends the program at once. One at a time; the
// graph must outlive it.
class InterruptStopsGraph {
 public:
  InterruptStopsGraph(nodes::graph::Graph& graph, nodes::graph::StopMode first);
  ~InterruptStopsGraph();
  InterruptStopsGraph(const InterruptStopsGraph&) = delete;
  InterruptStopsGraph& operator=(const InterruptStopsGraph&) = delete;

 private:
  std::optional<OutputWatch> watch_;
};

// While one lives, they and a lost output only raise the flag: whoever moves a motor looks at it,
// halts the motor and ends. A third Ctrl-C or SIGTERM ends the program at once.
class InterruptHaltsMotor {
 public:
  InterruptHaltsMotor();
  ~InterruptHaltsMotor();
  InterruptHaltsMotor(const InterruptHaltsMotor&) = delete;
  InterruptHaltsMotor& operator=(const InterruptHaltsMotor&) = delete;

 private:
  std::optional<OutputWatch> watch_;
};

}  // namespace turnlight::app
