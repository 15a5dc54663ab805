// The example of docs/nodes.md, compiled and run. Proves that what the guide shows works as it
// stands and that the guide quotes this file. Does not test the graph itself: its own tests do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/file.h"
#include "nodes/graph/graph.h"

using turnlight::Status;
using turnlight::StrictObject;
namespace graph = turnlight::nodes::graph;

// [message]
// The temperature of the table's motor, in degrees Celsius.
struct Temperature {
  double celsius = 0.0;
};

template <>
struct turnlight::nodes::graph::Wire<Temperature> {
  static constexpr std::string_view kName = "Temperature";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Temperature& temperature, WireWriter& out) {
    out.F64(temperature.celsius);
  }
  static Temperature Decode(WireReader& in) { return {.celsius = in.F64()}; }
};
// [message]

// [node]
// Tells when the motor is too hot. The warning ends only when it has cooled down by a margin.
//   in       temperature  Temperature
//   out      alarm        Temperature, of the message that raised it
//   params   limit_celsius above absolute zero; margin_celsius at least 0, default 2
class Overheating : public graph::Node {
 public:
  Status Configure(StrictObject& params) override {
    limit_ = params.Number("limit_celsius", {.above = -273.15});
    margin_ = params.OptionalNumber("margin_celsius", {.min = 0.0}).value_or(2.0);
    return {};
  }

 private:
  Status OnTemperature(const graph::Message<Temperature>& temperature) {
    const double celsius = temperature->celsius;
    if (!std::isfinite(celsius)) {
      ReportFault("no-reading", "the sensor gave no number");
      return {};
    }
    if (!hot_ && celsius > limit_) alarm_.Publish(temperature.value, temperature.header.valid_at);
    hot_ = celsius > (hot_ ? limit_ - margin_ : limit_);
    return {};
  }

  graph::Input<Temperature> temperature_{this, "temperature", &Overheating::OnTemperature};
  graph::Output<Temperature> alarm_{this, "alarm"};
  double limit_ = 0.0;
  double margin_ = 0.0;
  bool hot_ = false;
};
// [node]

// [source]
// Reads the sensor at a fixed rate. A Clock or a Timer makes it a source: a replay does not run it.
//   out      temperature  Temperature, valid at the reading
//   params   period_ms above 0; readings: here, instead of a sensor, the values it gives
class Thermometer : public graph::Node {
 public:
  Status Configure(StrictObject& params) override {
    period_ = graph::FromMs(params.Number("period_ms", {.above = 0.0}));
    readings_ = params.Numbers("readings", 4);
    return {};
  }
  Status Start() override {
    tick_.Every(period_);
    return {};
  }

 private:
  Status OnTick(graph::Time now) {
    temperature_.Publish(Temperature{readings_[next_++]}, now);
    if (next_ == readings_.size()) tick_.Cancel();
    return {};
  }

  graph::Timer tick_{this, "tick", &Thermometer::OnTick};
  graph::Output<Temperature> temperature_{this, "temperature"};
  graph::Duration period_{};
  std::vector<double> readings_;
  std::size_t next_ = 0;
};
// [source]

namespace {

// [config]
const char* const kConfig = R"(
graph:
  executor: virtual
  nodes:
    thermometer: {type: thermometer, params: {period_ms: 500, readings: [60, 71, 69.5, 72]}}
    overheating: {type: overheating, params: {limit_celsius: 70}, duration_ms: 1}
  connections:
    - {from: thermometer.temperature, to: overheating.temperature, policy: block}
  record: [thermometer.temperature, overheating.alarm]
)";
// [config]

TEST(ExampleNode, RunsAsTheGuideShows) {
  // [run]
  graph::NodeRegistry registry;
  registry.Add<Overheating>("overheating");
  registry.Add<Thermometer>("thermometer");
  auto config = graph::ParseGraphConfig(kConfig, "example.yaml");
  ASSERT_TRUE(config) << config.error().text;
  auto built = graph::Graph::Build(std::move(*config), registry);
  ASSERT_TRUE(built) << built.error().text;
  std::vector<double> alarms;
  ASSERT_TRUE(built->Tap<Temperature>(
      "overheating.alarm",
      [&](const graph::Message<Temperature>& alarm) { alarms.push_back(alarm->celsius); }));
  const auto report = built->Run();
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_EQ(report->cause, graph::StopCause::kCompleted);
  EXPECT_THAT(alarms, testing::ElementsAre(71));  // 69.5 is within the margin: still the same alarm
  // [run]
}

// Every block between two equal marks in this file stands word for word in the guide.
TEST(ExampleNode, TheGuideQuotesThisFile) {
  const std::string root = TURNLIGHT_SOURCE_DIR;
  const auto source = turnlight::ReadFile(root + "/tests/nodes/graph/example_node_test.cpp");
  const auto guide = turnlight::ReadFile(root + "/docs/nodes.md");
  ASSERT_TRUE(source && guide);
  for (const std::string name : {"message", "node", "source", "config", "run"}) {
    const std::string mark = "// [" + name + "]\n";
    std::size_t begin = source->find(mark);
    ASSERT_NE(begin, std::string::npos) << name;
    begin += mark.size();
    std::size_t end = source->find(mark, begin);
    ASSERT_NE(end, std::string::npos) << name;
    end = source->rfind('\n', end);
    std::string block = source->substr(begin, end - begin);
    if (name == "config") {  // without the lines that make it a C++ text
      block = block.substr(block.find('\n') + 1);
      block = block.substr(0, block.rfind('\n') + 1);
    }
    EXPECT_NE(guide->find(block), std::string::npos)
        << "docs/nodes.md does not quote the block [" << name << "]:\n"
        << block;
  }
}

}  // namespace
