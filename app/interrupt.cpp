#include "app/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <vector>

#include "app/exit_code.h"

namespace turnlight::app {
namespace {

constexpr char kText[] = "\nturnlight: interrupted\n";

StopFlag interrupted{false};
std::atomic<int> at_once{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

const std::vector<int> kStandardOutputs{STDOUT_FILENO, STDERR_FILENO};

std::atomic<nodes::graph::Graph*> stopped_graph{nullptr};
std::atomic<int> presses{0};        // since a graph or a motor that can be stopped began
std::atomic<bool> stop_now{false};  // by SIGTERM, or nobody is there any more
std::atomic<bool> first_stops_now{false};
std::atomic<bool> halts_motor{false};
static_assert(std::atomic<nodes::graph::Graph*>::is_always_lock_free,
              "a signal handler may touch it");

[[noreturn]] void EndNow() {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText, sizeof kText - 1);
  ::_exit(kInterrupted);
}

void HandleInterrupt(int signal) {
  const bool hangup = signal == SIGHUP;
  if (signal != SIGINT) stop_now = true;
  const bool second = interrupted.exchange(true) && !hangup;
  const int press = hangup ? presses.load() : presses.fetch_add(1) + 1;
  if (nodes::graph::Graph* graph = stopped_graph.load()) {
    const bool now = press > 1 || stop_now.load() || first_stops_now.load();
    graph->RequestStop(now ? nodes::graph::StopMode::kNow : nodes::graph::StopMode::kDrain);
    if (press < 3) return;
  }
  if (halts_motor.load() && press < 3) return;
  if (second || at_once.load() > 0) EndNow();
}

void Catch(int signal) {
  struct sigaction action {};
  action.sa_handler = HandleInterrupt;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

}  // namespace

void InstallInterruptHandler() {
  Catch(SIGINT);
  Catch(SIGTERM);
  if (!HangupIsIgnored()) Catch(SIGHUP);
}

void LoseOutput() { HandleInterrupt(SIGHUP); }

bool Interrupted() { return interrupted.load(); }
const StopFlag& InterruptFlag() { return interrupted; }

InterruptAtOnce::InterruptAtOnce() {
  ++at_once;
  if (interrupted) EndNow();  // it came before, while something was being written
}
InterruptAtOnce::~InterruptAtOnce() { --at_once; }

InterruptStopsGraph::InterruptStopsGraph(nodes::graph::Graph& graph, nodes::graph::StopMode first) {
  presses = 0;
  first_stops_now = first == nodes::graph::StopMode::kNow;
  stopped_graph = &graph;
  if (interrupted)  // it came before there was a graph
    graph.RequestStop(stop_now ? nodes::graph::StopMode::kNow : first);
  watch_.emplace(kStandardOutputs, LoseOutput);
}
InterruptStopsGraph::~InterruptStopsGraph() { stopped_graph = nullptr; }

InterruptHaltsMotor::InterruptHaltsMotor() {
  presses = 0;
  halts_motor = true;
  watch_.emplace(kStandardOutputs, LoseOutput);
}
InterruptHaltsMotor::~InterruptHaltsMotor() { halts_motor = false; }

}  // namespace turnlight::app
