// Ctrl-C. The first one lets the file that is being written be finished, then the program ends with
// exit code 130; where nothing is being written it ends at once, an estimate at its next iteration.
// The second one ends it at once.
#pragma once

#include "base/stop_flag.h"
#include "nodes/graph/graph.h"

namespace turnlight::app {

void InstallInterruptHandler();

// Whether Ctrl-C was pressed; commands look between two frames.
bool Interrupted();
// The same for calls that look themselves.
const StopFlag& InterruptFlag();

// While one lives, nothing is being written, and Ctrl-C ends the program at once; so does one that
// came before.
class InterruptAtOnce {
 public:
  InterruptAtOnce();
  ~InterruptAtOnce();
  InterruptAtOnce(const InterruptAtOnce&) = delete;
  InterruptAtOnce& operator=(const InterruptAtOnce&) = delete;
};

// While one lives, Ctrl-C stops the graph: the first as asked for, the second now; SIGTERM now. The
// third ends the program at once. One at a time; the graph must outlive it.
class InterruptStopsGraph {
 public:
  InterruptStopsGraph(nodes::graph::Graph& graph, nodes::graph::StopMode first);
  ~InterruptStopsGraph();
  InterruptStopsGraph(const InterruptStopsGraph&) = delete;
  InterruptStopsGraph& operator=(const InterruptStopsGraph&) = delete;
};

// While one lives, Ctrl-C and SIGTERM only raise the flag: whoever moves a motor looks at it, halts
// the motor and ends. The third ends the program at once.
class InterruptHaltsMotor {
 public:
  InterruptHaltsMotor();
  ~InterruptHaltsMotor();
  InterruptHaltsMotor(const InterruptHaltsMotor&) = delete;
  InterruptHaltsMotor& operator=(const InterruptHaltsMotor&) = delete;
};

}  // namespace turnlight::app
