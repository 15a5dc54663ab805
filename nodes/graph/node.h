// All that a node needs: derive from Node, declare ports as members, write one function per input.
//
//   class Threshold : public graph::Node {
//    public:
//     Status Configure(StrictObject& params) override { limit_ = params.Number("limit"); return {};
//     }
//
//    private:
//     Status OnNumber(const graph::Message<Number>& number) {
//       if (number->value > limit_) above_.Publish(number.value, number.header.valid_at);
//       return {};
//     }
//     graph::Input<Number> in_{this, "in", &Threshold::OnNumber};
//     graph::Output<Number> above_{this, "above"};
//     double limit_ = 0.0;
//   };
//
// Handlers of one node never run at the same time: a node needs no locks. What a handler returns as
// an error, or throws, becomes a Fault on the node's port "fault", halts the node and stops the
// graph in order; what can go on is told with ReportFault. docs/nodes.md has a whole example.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "base/result.h"
#include "base/strict_object.h"
#include "nodes/graph/core.h"

namespace turnlight::nodes::graph {

enum class Latch { kNo, kYes };  // kYes: who comes late gets the last message
enum class Need { kRequired, kOptional };
enum class Writers { kOne, kMany };

template <typename T>
class Output {
 public:
  Output(Node* node, std::string name, Latch latch = Latch::kNo);

  // valid_at is the instant that the value describes: a source takes it from its clock, other nodes
  // pass on what came in. Only from this node's own handlers; elsewhere (Configure, Stop, another
  // thread) nothing is published.
  void Publish(T value, Time valid_at) {
    Publish(std::make_shared<const T>(std::move(value)), valid_at);
  }
  // Without a copy or an allocation, for a value that already is shared.
  void Publish(std::shared_ptr<const T> value, Time valid_at) {
    if (Runtime* runtime = port_.node.runtime) runtime->Publish(port_, std::move(value), valid_at);
  }
  OutputPort& port() { return port_; }

 private:
  OutputPort port_;
};

template <typename T>
class Input {
 public:
  template <typename N>
  Input(N* node, std::string name, Status (N::*handler)(const Message<T>&),
        Need need = Need::kRequired, Writers writers = Writers::kOne)
      : Input(
            static_cast<Node*>(node), std::move(name),
            [node, handler](const Message<T>& message) { return (node->*handler)(message); }, need,
            writers) {}
  Input(Node* node, std::string name, std::function<Status(const Message<T>&)> handler,
        Need need = Need::kRequired, Writers writers = Writers::kOne);
  InputPort& port() { return port_; }

 private:
  InputPort port_;
};

// Makes its node a source: one that sees time. In a replay sources do not run; what they published
// is read from the log.
class Clock {
 public:
  explicit Clock(Node* node);
  // When the running handler was called (virtual), or the steady clock (wall).
  Time Now() const;
  // ISO 8601 for people and provenance, never for logic. In virtual time "virtual+12.345678901s".
  std::string UtcLabel() const;

 private:
  NodeCore& node_;
};

// Makes its node a source. One alarm at a time; setting it anew replaces it.
class Timer {
 public:
  template <typename N>
  Timer(N* node, std::string name, Status (N::*handler)(Time now))
      : Timer(static_cast<Node*>(node), std::move(name),
              [node, handler](Time now) { return (node->*handler)(now); }) {}
  Timer(Node* node, std::string name, std::function<Status(Time)> handler);

  void After(Duration delay);   // once; delays below 0 count as 0
  void Every(Duration period);  // first after one period; above 0. Periods missed are skipped
  void Cancel() { port_.due = kNever; }

 private:
  TimerPort port_;
};

class Node {
 public:
  Node() : fault_(this, "fault") {}
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  // Reads the node's params; keys that it does not ask for are refused by the graph. Opens nothing.
  virtual Status Configure(StrictObject& params) {
    (void)params;
    return {};
  }
  // The first handler to run: open devices, set timers, publish.
  virtual Status Start() { return {}; }
  // A stop was asked for, or there is nothing left to do: begin nothing new, publish last words.
  virtual Status WindDown() { return {}; }
  // The last call; no message goes out any more. Releases what Start opened, stops what moves.
  virtual Status Stop(StopMode mode) {
    (void)mode;
    return {};
  }

  NodeCore& core() { return core_; }

 protected:
  const std::string& name() const { return core_.name; }
  // The graph's seed.
  std::uint64_t seed() const { return core_.seed; }
  // A fault after which this node can go on.
  void ReportFault(std::string code, std::string text) {
    if (core_.runtime)
      core_.runtime->Report(core_, {core_.name, std::move(code), std::move(text), true});
  }
  // The work of the whole graph is done, or cannot go on: stop it in order.
  void RequestStop() {
    if (core_.runtime) core_.runtime->RequestStop(StopMode::kDrain);
  }
  // True once a stop now was asked for: a handler that takes long looks at it and returns early.
  // What it publishes then is discarded, so the answer cannot reach any other node.
  bool stopping_now() const { return core_.runtime && core_.runtime->StoppingNow(); }
  // Between these two a stop in order waits, and timers still run: for work of several handlers
  // that must not be cut in half, such as one keyframe. Not to be begun after WindDown.
  void HoldStop() {
    if (core_.runtime) core_.runtime->HoldStop(core_, 1);
  }
  void ReleaseStop() {
    if (core_.runtime) core_.runtime->HoldStop(core_, -1);
  }

 private:
  NodeCore core_;
  Output<Fault> fault_;
};

template <typename T>
Output<T>::Output(Node* node, std::string name, Latch latch)
    : port_(node->core(), std::move(name), TypeOf<T>(), latch == Latch::kYes) {}

template <typename T>
Input<T>::Input(Node* node, std::string name, std::function<Status(const Message<T>&)> handler,
                Need need, Writers writers)
    : port_(node->core(), std::move(name), TypeOf<T>(), need == Need::kRequired,
            writers == Writers::kMany, [handler = std::move(handler)](AnyMessage&& message) {
              return handler(Typed<T>(std::move(message)));
            }) {}

inline Clock::Clock(Node* node) : node_(node->core()) { node_.is_source = true; }
inline Time Clock::Now() const { return node_.runtime ? node_.runtime->Now() : Time(0); }
inline std::string Clock::UtcLabel() const {
  return node_.runtime ? node_.runtime->UtcLabel() : std::string();
}

inline Timer::Timer(Node* node, std::string name, std::function<Status(Time)> handler)
    : port_(node->core(), std::move(name), false, std::move(handler)) {}
inline void Timer::After(Duration delay) {
  if (!port_.node.runtime) return;
  port_.due = port_.node.runtime->Now() + std::max(delay, Duration(0));
  port_.period = Duration(0);
}
inline void Timer::Every(Duration period) {
  if (!port_.node.runtime) return;
  port_.period = std::max(period, Duration(1));
  port_.due = port_.node.runtime->Now() + port_.period;
}

}  // namespace turnlight::nodes::graph
