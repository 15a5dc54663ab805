// What went wrong in a node, as a value on its port "fault".
#pragma once

#include <string>

#include "nodes/graph/wire.h"

namespace turnlight::nodes::graph {

struct Fault {
  std::string node;
  // A word for programs: "input", "incomplete", "device", "no-estimate", "system" (the kind of an
  // Error that a handler returned), "exception", "deadline" (from the watchdog), "log", or a node's
  // own.
  std::string code;
  std::string text;          // for a person
  bool recoverable = false;  // false: the node is halted and the graph stops in order

  bool operator==(const Fault&) const = default;
};

template <>
struct Wire<Fault> {
  static constexpr std::string_view kName = "Fault";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Fault& fault, WireWriter& out) {
    out.Text(fault.node);
    out.Text(fault.code);
    out.Text(fault.text);
    out.Bool(fault.recoverable);
  }
  static Fault Decode(WireReader& in) {
    Fault fault;
    fault.node = in.Text();
    fault.code = in.Text();
    fault.text = in.Text();
    fault.recoverable = in.Bool();
    return fault;
  }
};

}  // namespace turnlight::nodes::graph
