// What the graph and its executors see of a node. Whoever writes a node needs node.h only.
#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "nodes/graph/fault.h"
#include "nodes/graph/message.h"
#include "nodes/graph/queue.h"
#include "nodes/graph/time.h"

namespace turnlight::nodes::graph {

class Node;
struct Connection;
struct NodeCore;

enum class StopMode {
  kDrain,  // finish what was begun, handle every queued message, then stop in order of declaration
  kNow,    // start no further handler; queued messages are discarded
};

// What ports ask of the executor. Called on the thread of the node's handler.
class Runtime {
 public:
  virtual ~Runtime() = default;
  virtual void Publish(struct OutputPort& port, std::shared_ptr<const void> value,
                       Time valid_at) = 0;
  virtual void Report(NodeCore& node, Fault fault) = 0;
  virtual Time Now() const = 0;
  virtual std::string UtcLabel() const = 0;
  virtual void HoldStop(NodeCore& node, int change) = 0;
  virtual void RequestStop(StopMode mode) = 0;
  virtual bool StoppingNow() const = 0;
};

using TapFunction = std::function<void(const AnyMessage&)>;

// Ports are members of their node and register with it when it is constructed; the order of their
// declaration is part of the delivery order. They never move.
struct OutputPort {
  OutputPort(NodeCore& node, std::string name, const MessageType& type, bool latched);
  OutputPort(const OutputPort&) = delete;
  OutputPort& operator=(const OutputPort&) = delete;
  std::string Topic() const;

  NodeCore& node;
  const std::string name;
  const MessageType& type;
  const bool latched;  // a tap that comes late gets the last message at once
  std::uint64_t next_sequence = 0;
  std::vector<Connection*> connections;

  std::mutex mutex;  // guards what is below, which other threads may add to while the graph runs
  std::atomic<bool> tapped{false};
  std::deque<TapFunction> taps;
  std::optional<AnyMessage> last;  // of a latched port
};

struct InputPort {
  using Handler = std::function<Status(AnyMessage&&)>;
  InputPort(NodeCore& node, std::string name, const MessageType& type, bool required, bool many,
            Handler handler);
  InputPort(const InputPort&) = delete;
  InputPort& operator=(const InputPort&) = delete;
  std::string Topic() const;

  NodeCore& node;
  const std::string name;
  const MessageType& type;
  const bool required;
  const bool many;  // more than one writer is allowed
  const Handler handler;
  std::vector<Connection*> connections;
};

struct TimerPort {
  // A deadline belongs to an action: it does not make its node a source and survives a drain.
  TimerPort(NodeCore& node, std::string name, bool deadline, std::function<Status(Time)> handler);
  TimerPort(const TimerPort&) = delete;
  TimerPort& operator=(const TimerPort&) = delete;
  bool armed() const { return due != kNever; }

  NodeCore& node;
  const std::string name;
  const bool deadline;
  const std::function<Status(Time)> handler;
  Time due = kNever;
  Duration period{0};  // 0: once
};

// One end of an action: three ports, connected and checked together.
struct ActionEnd {
  std::string name;
  OutputPort* goal_out = nullptr;  // client
  InputPort* goal_in = nullptr;    // server
  OutputPort* feedback_out = nullptr;
  InputPort* feedback_in = nullptr;
  OutputPort* result_out = nullptr;
  InputPort* result_in = nullptr;
  // Ids that were not the outstanding one. Written by the node's own thread.
  std::atomic<std::uint64_t> late{0};       // of an earlier goal that had ended without a reply
  std::atomic<std::uint64_t> duplicate{0};  // of a goal that was answered, or seen, before

  bool is_client() const { return goal_out != nullptr; }
};

struct Connection {
  Connection(OutputPort& from_port, InputPort& to_port, Policy policy, std::string where_text)
      : from(from_port), to(to_port), where(std::move(where_text)), queue(policy) {}

  OutputPort& from;
  InputPort& to;
  const std::string where;  // "FILE:LINE: KEY"
  MessageQueue queue;
  // Counted by whoever delivers, under the same lock as the queue.
  std::uint64_t delivered = 0;
  std::uint64_t dropped = 0;    // by keep_last
  std::uint64_t blocked = 0;    // how often the publisher had to wait
  std::uint64_t discarded = 0;  // arrived after the receiver had stopped, or thrown away by it
};

struct NodeCore {
  Node* node = nullptr;
  std::string name;
  std::string type;
  std::size_t index = 0;  // order of declaration in the config
  std::uint64_t seed = 0;
  Duration duration{1};              // of one handler in virtual time, at least 1 ns
  std::optional<Duration> deadline;  // of one handler in real time
  bool is_source = false;            // has a clock or a timer
  Runtime* runtime = nullptr;        // only while the graph runs
  std::vector<OutputPort*> outputs;
  std::vector<InputPort*> inputs;
  std::vector<TimerPort*> timers;
  std::vector<ActionEnd*> actions;
  std::vector<Connection*> incoming;
};

// What a node does next: of its due timers and waiting messages the one that came first. A timer
// wins a tie, the earlier declared timer wins over the later.
struct NextWork {
  TimerPort* timer = nullptr;
  Connection* connection = nullptr;
};
NextWork ChooseWork(const NodeCore& node, Time now);
// The earliest due time of the node's timers, or kNever.
Time NextDue(const NodeCore& node);
// Disarms all, or all but the deadlines of actions.
void CancelTimers(NodeCore& node, bool deadlines_too);
// Arms the next period, skipping periods that have passed altogether, and calls the handler.
Status FireTimer(TimerPort& timer, Time now);

// Keeps a latched message and calls the taps.
void Observe(OutputPort& port, const AnyMessage& message);
void AddTap(OutputPort& port, TapFunction tap);

Fault FaultOfError(const NodeCore& node, std::string_view what, std::string_view port,
                   const Error& error);
Fault FaultOfException(const NodeCore& node, std::string_view what, std::string_view port,
                       const char* text);

// Calls a node's code; what it returns or throws becomes a Fault. what and port name the call in
// it.
template <typename Call>
std::optional<Fault> Guarded(const NodeCore& node, std::string_view what, std::string_view port,
                             Call&& call) {
  try {
    const Status status = call();
    if (status) return std::nullopt;
    return FaultOfError(node, what, port, status.error());
  } catch (const std::exception& exception) {
    return FaultOfException(node, what, port, exception.what());
  } catch (...) {
    return FaultOfException(node, what, port, "not a std::exception");
  }
}

}  // namespace turnlight::nodes::graph
