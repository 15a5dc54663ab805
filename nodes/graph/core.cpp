#include "nodes/graph/core.h"

#include <algorithm>
#include <utility>

namespace turnlight::nodes::graph {
namespace {

const char* CodeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInput:
      return "input";
    case ErrorKind::kIncomplete:
      return "incomplete";
    case ErrorKind::kDevice:
      return "device";
    case ErrorKind::kNoEstimate:
      return "no-estimate";
    case ErrorKind::kInterrupted:
      return "interrupted";
    case ErrorKind::kSystem:
      return "system";
  }
  return "unknown";
}

std::string CallName(std::string_view what, std::string_view port) {
  return port.empty() ? std::string(what) : std::string(what) + " " + std::string(port);
}

}  // namespace

OutputPort::OutputPort(NodeCore& owner, std::string port_name, const MessageType& message_type,
                       bool keeps_last)
    : node(owner), name(std::move(port_name)), type(message_type), latched(keeps_last) {
  owner.outputs.push_back(this);
}

std::string OutputPort::Topic() const { return node.name + "." + name; }

InputPort::InputPort(NodeCore& owner, std::string port_name, const MessageType& message_type,
                     bool is_required, bool many_writers, Handler on_message)
    : node(owner),
      name(std::move(port_name)),
      type(message_type),
      required(is_required),
      many(many_writers),
      handler(std::move(on_message)) {
  owner.inputs.push_back(this);
}

std::string InputPort::Topic() const { return node.name + "." + name; }

TimerPort::TimerPort(NodeCore& owner, std::string timer_name, bool is_deadline,
                     std::function<Status(Time)> on_time)
    : node(owner), name(std::move(timer_name)), deadline(is_deadline), handler(std::move(on_time)) {
  owner.timers.push_back(this);
  if (!is_deadline) owner.is_source = true;
}

NextWork ChooseWork(const NodeCore& node, Time now) {
  NextWork next;
  for (TimerPort* timer : node.timers)
    if (timer->due <= now && (!next.timer || timer->due < next.timer->due)) next.timer = timer;
  for (Connection* connection : node.incoming)
    if (!connection->queue.empty() &&
        (!next.connection ||
         connection->queue.front_arrival() < next.connection->queue.front_arrival()))
      next.connection = connection;
  if (next.timer && next.connection) {
    if (next.timer->due <= next.connection->queue.front_arrived_at())
      next.connection = nullptr;
    else
      next.timer = nullptr;
  }
  return next;
}

Time NextDue(const NodeCore& node) {
  Time due = kNever;
  for (const TimerPort* timer : node.timers) due = std::min(due, timer->due);
  return due;
}

void CancelTimers(NodeCore& node, bool deadlines_too) {
  for (TimerPort* timer : node.timers)
    if (deadlines_too || !timer->deadline) timer->due = kNever;
}

Status FireTimer(TimerPort& timer, Time now) {
  if (timer.period > Duration(0)) {
    const auto passed = (now - timer.due) / timer.period;
    timer.due += (passed + 1) * timer.period;
  } else {
    timer.due = kNever;
  }
  return timer.handler(now);
}

void Observe(OutputPort& port, const AnyMessage& message) {
  if (!port.latched && !port.tapped.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(port.mutex);
  if (port.latched) port.last = message;
  for (const TapFunction& tap : port.taps) tap(message);
}

void AddTap(OutputPort& port, TapFunction tap) {
  const std::lock_guard lock(port.mutex);
  if (port.last) tap(*port.last);
  port.taps.push_back(std::move(tap));
  port.tapped.store(true, std::memory_order_release);
}

Fault FaultOfError(const NodeCore& node, std::string_view what, std::string_view port,
                   const Error& error) {
  return {node.name, CodeOf(error.kind), CallName(what, port) + ": " + error.text, false};
}

Fault FaultOfException(const NodeCore& node, std::string_view what, std::string_view port,
                       const char* text) {
  return {node.name, "exception", CallName(what, port) + " threw: " + text, false};
}

}  // namespace turnlight::nodes::graph
