// Small nodes and helpers that the tests of the graph share.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "nodes/graph/graph.h"
#include "nodes/graph/log.h"
#include "tests/temporary_folder.h"

namespace turnlight::nodes::graph {

struct Number {
  double value = 0.0;
};
template <>
struct Wire<Number> {
  static constexpr std::string_view kName = "Number";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Number& number, WireWriter& out) { out.F64(number.value); }
  static Number Decode(WireReader& in) { return {.value = in.F64()}; }
};

struct Word {
  std::string text;
};
template <>
struct Wire<Word> {
  static constexpr std::string_view kName = "Word";
  static constexpr std::uint32_t kVersion = 3;
  static void Encode(const Word& word, WireWriter& out) { out.Text(word.text); }
  static Word Decode(WireReader& in) { return {.text = in.Text()}; }
};

// A source: publishes 1, 2, ... count; with period_ms 0 all of them in Start.
class Counter : public Node {
 public:
  Status Configure(StrictObject& params) override {
    count_ = static_cast<int>(params.Integer("count", 0, 100'000'000));
    period_ms_ = params.OptionalNumber("period_ms", {.min = 0}).value_or(0);
    return {};
  }
  Status Start() override {
    if (period_ms_ > 0) {
      tick_.Every(FromMs(period_ms_));
    } else {
      while (sent_ < count_ && !stopping_now()) Send();
    }
    return {};
  }

 private:
  Status OnTick(Time) {
    Send();
    if (sent_ == count_) tick_.Cancel();
    return {};
  }
  void Send() { number_.Publish(Number{static_cast<double>(++sent_)}, clock_.Now()); }

  Clock clock_{this};
  Timer tick_{this, "tick", &Counter::OnTick};
  Output<Number> number_{this, "number"};
  double period_ms_ = 0;
  int count_ = 0;
  int sent_ = 0;
};

// Twice what comes in.
class Doubler : public Node {
 private:
  Status OnNumber(const Message<Number>& number) {
    out_.Publish(Number{2.0 * number->value}, number.header.valid_at);
    return {};
  }
  Input<Number> in_{this, "in", &Doubler::OnNumber};
  Output<Number> out_{this, "out"};
};

// What sinks saw; filled from their threads, read after the run.
struct Seen {
  std::vector<double> values;
  std::vector<Header> headers;
};

class Sink : public Node {
 public:
  explicit Sink(Seen& seen) : seen_(seen) {}

 private:
  Status OnNumber(const Message<Number>& number) {
    seen_.values.push_back(number->value);
    seen_.headers.push_back(number.header);
    return {};
  }
  Seen& seen_;
  Input<Number> in_{this, "in", &Sink::OnNumber};
};

// A node with one input and one output whose behaviour a test writes on the spot.
class Custom : public Node {
 public:
  struct Behaviour {
    std::function<Status(Custom&)> start = nullptr;
    std::function<Status(Custom&, const Message<Number>&)> input = nullptr;
    std::function<Status(Custom&)> wind_down = nullptr;
    std::function<Status(Custom&, StopMode)> stop = nullptr;
  };
  explicit Custom(Behaviour behaviour) : behaviour_(std::move(behaviour)) {}
  Status Start() override { return behaviour_.start ? behaviour_.start(*this) : Status(); }
  Status WindDown() override {
    return behaviour_.wind_down ? behaviour_.wind_down(*this) : Status();
  }
  Status Stop(StopMode mode) override {
    return behaviour_.stop ? behaviour_.stop(*this, mode) : Status();
  }
  using Node::HoldStop;
  using Node::ReleaseStop;
  using Node::ReportFault;
  using Node::RequestStop;

 private:
  Status OnNumber(const Message<Number>& number) {
    return behaviour_.input ? behaviour_.input(*this, number) : Status();
  }
  Behaviour behaviour_;
  Input<Number> in_{this, "in", &Custom::OnNumber, Need::kOptional};

 public:
  Output<Number> out{this, "out"};
};

// The same with a timer, and so a source.
class CustomSource : public Node {
 public:
  struct Behaviour {
    std::function<Status(CustomSource&)> start = nullptr;
    std::function<Status(CustomSource&, const Message<Number>&)> input = nullptr;
    std::function<Status(CustomSource&, Time)> timer = nullptr;
    std::function<Status(CustomSource&)> wind_down = nullptr;
  };
  explicit CustomSource(Behaviour behaviour) : behaviour_(std::move(behaviour)) {}
  Status Start() override { return behaviour_.start ? behaviour_.start(*this) : Status(); }
  Status WindDown() override {
    return behaviour_.wind_down ? behaviour_.wind_down(*this) : Status();
  }
  using Node::HoldStop;
  using Node::ReleaseStop;
  using Node::RequestStop;

 private:
  Status OnNumber(const Message<Number>& number) {
    return behaviour_.input ? behaviour_.input(*this, number) : Status();
  }
  Status OnTimer(Time now) { return behaviour_.timer ? behaviour_.timer(*this, now) : Status(); }
  Behaviour behaviour_;
  Input<Number> in_{this, "in", &CustomSource::OnNumber, Need::kOptional};

 public:
  Clock clock{this};
  Timer timer{this, "timer", &CustomSource::OnTimer};
  Output<Number> out{this, "out", Latch::kYes};
};

inline NodeRegistry BasicNodes() {
  NodeRegistry registry;
  registry.Add<Counter>("counter");
  registry.Add<Doubler>("doubler");
  return registry;
}
inline void AddSink(NodeRegistry& registry, Seen& seen, const std::string& type = "sink") {
  registry.Add(type, [&seen] { return std::make_unique<Sink>(seen); });
}
inline void AddCustom(NodeRegistry& registry, const std::string& type,
                      Custom::Behaviour behaviour) {
  registry.Add(type, [behaviour] { return std::make_unique<Custom>(behaviour); });
}
inline void AddSource(NodeRegistry& registry, const std::string& type,
                      CustomSource::Behaviour behaviour) {
  registry.Add(type, [behaviour] { return std::make_unique<CustomSource>(behaviour); });
}

inline Result<Graph> BuildFrom(const std::string& yaml, const NodeRegistry& registry) {
  auto config = ParseGraphConfig(yaml, "test.yaml");
  if (!config) return Forward(config);
  return Graph::Build(std::move(*config), registry);
}
// The error's text, or nothing.
template <typename T>
std::string ErrorOf(const Result<T>& result) {
  return result ? std::string() : result.error().text;
}

// Runs to the end; the test fails if the graph cannot be set up.
inline RunReport RunGraph(const std::string& yaml, const NodeRegistry& registry,
                          const RunOptions& options = {}) {
  auto graph = BuildFrom(yaml, registry);
  EXPECT_TRUE(graph) << ErrorOf(graph);
  if (!graph) return {};
  auto report = graph->Run(options);
  EXPECT_TRUE(report) << ErrorOf(report);
  return report ? *report : RunReport{};
}

inline const ConnectionReport& ConnectionTo(const RunReport& report, const std::string& to) {
  for (const ConnectionReport& connection : report.connections)
    if (connection.to == to) return connection;
  ADD_FAILURE() << "no connection to " << to;
  static const ConnectionReport kNone;
  return kNone;
}

}  // namespace turnlight::nodes::graph
