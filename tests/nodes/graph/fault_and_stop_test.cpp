// Proves, in virtual time, how a graph ends: by a stop in order or at once, by a held stop, and by
// faults, which halt their node and reach the port "fault", the report and the caller. Does not
// prove the same with threads: wall_executor_test.cpp does.
#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::ElementsAre;

TEST(Stopping, ANodeThatRequestsAStopIsDrainedInOrder) {
  Seen seen;
  std::vector<std::string> stops;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  AddSource(registry, "boss",
            {.start =
                 [](CustomSource& node) {
                   node.timer.Every(FromMs(1));
                   return Status();
                 },
             .timer =
                 [](CustomSource& node, Time now) {
                   node.out.Publish(Number{ToMs(now)}, now);
                   if (now >= FromMs(10)) node.RequestStop();
                   return Status();
                 },
             .wind_down =
                 [](CustomSource& node) {
                   node.timer.Cancel();
                   node.out.Publish(Number{-1}, Time(0));
                   return Status();
                 }});
  for (const std::string name : {"first", "second"})
    AddCustom(registry, name, {.stop = [&stops, name](Custom&, StopMode mode) {
                stops.push_back(name + (mode == StopMode::kDrain ? " drained" : " now"));
                return Status();
              }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    first: {type: first}
    boss: {type: boss}
    second: {type: second}
    sink: {type: sink, duration_ms: 50}
  connections:
    - {from: boss.out, to: sink.in, policy: block, capacity: 100}
)",
                                    registry);
  EXPECT_EQ(report.cause, StopCause::kRequested);
  EXPECT_THAT(seen.values, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, -1));
  EXPECT_THAT(stops, ElementsAre("first drained", "second drained"));
}

TEST(Stopping, StopNowDiscardsWhatIsQueued) {
  std::vector<std::string> log;
  NodeRegistry registry = BasicNodes();
  std::optional<Graph> graph;
  AddCustom(registry, "custom",
            {.input =
                 [&](Custom&, const Message<Number>& number) {
                   log.push_back("message");
                   if (number->value == 3) graph->RequestStop(StopMode::kNow);
                   return Status();
                 },
             .wind_down =
                 [&](Custom&) {
                   log.push_back("wind down");
                   return Status();
                 },
             .stop =
                 [&](Custom&, StopMode mode) {
                   log.push_back(mode == StopMode::kNow ? "stop now" : "stop");
                   return Status();
                 }});
  auto built = BuildFrom(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 100}}
    custom: {type: custom, duration_ms: 1}
  connections:
    - {from: count.number, to: custom.in, policy: block}
)",
                         registry);
  ASSERT_TRUE(built) << ErrorOf(built);
  graph = std::move(*built);
  const auto report = graph->Run();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->cause, StopCause::kImmediate);
  EXPECT_THAT(log, ElementsAre("message", "message", "message", "stop now"));
}

TEST(Stopping, AHeldStopWaitsUntilItIsReleased) {
  std::vector<std::string> log;
  NodeRegistry registry;
  AddSource(registry, "holder",
            {.start =
                 [](CustomSource& node) {
                   node.HoldStop();
                   node.timer.Every(FromMs(10));
                   node.RequestStop();
                   return Status();
                 },
             .timer =
                 [&log](CustomSource& node, Time now) {
                   log.push_back(std::to_string(now / FromMs(1)));
                   if (log.size() == 4) node.ReleaseStop();
                   return Status();
                 },
             .wind_down =
                 [&log](CustomSource&) {
                   log.push_back("wind down");
                   return Status();
                 }});
  RunGraph("graph:\n  executor: virtual\n  nodes:\n    holder: {type: holder}\n", registry);
  EXPECT_THAT(log, ElementsAre("wind down", "10", "20", "30"));
}

TEST(Stopping, AStopThatNobodyCanReleaseEndsAllTheSame) {
  NodeRegistry registry;
  AddCustom(registry, "forgetful", {.start = [](Custom& node) {
              node.HoldStop();
              return Status();
            }});
  const RunReport report =
      RunGraph("graph:\n  executor: virtual\n  nodes:\n    f: {type: forgetful}\n", registry);
  EXPECT_EQ(report.cause, StopCause::kCompleted);
}

TEST(Faults, ErrorsAndExceptionsBecomeFaultsThatHaltTheNode) {
  for (const bool throws : {false, true}) {
    Seen seen;
    std::vector<Fault> told;
    std::vector<Fault> on_port;
    int inputs = 0;
    NodeRegistry registry = BasicNodes();
    AddSink(registry, seen);
    AddCustom(registry, "bad", {.input = [&](Custom&, const Message<Number>& number) -> Status {
                ++inputs;
                if (number->value < 3) return {};
                if (throws) throw std::runtime_error("out of paper");
                return tl::unexpected<Error>(Error{ErrorKind::kDevice, "out of paper"});
              }});
    auto graph = BuildFrom(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 50, period_ms: 1}}
    bad: {type: bad}
    sink: {type: sink}
  connections:
    - {from: count.number, to: bad.in, policy: block, capacity: 1}
    - {from: count.number, to: sink.in, policy: block}
)",
                           registry);
    ASSERT_TRUE(graph) << ErrorOf(graph);
    ASSERT_TRUE(graph->Tap<Fault>(
        "bad.fault", [&on_port](const Message<Fault>& fault) { on_port.push_back(*fault); }));
    const auto report =
        graph->Run({.on_fault = [&told](const Fault& fault) { told.push_back(fault); }});
    ASSERT_TRUE(report);
    const Fault expected{"bad", throws ? "exception" : "device",
                         throws ? "input in threw: out of paper" : "input in: out of paper", false};
    EXPECT_EQ(inputs, 3);
    EXPECT_EQ(report->cause, StopCause::kFault);
    EXPECT_EQ(report->failure, expected);
    EXPECT_THAT(report->faults, ElementsAre(expected));
    EXPECT_THAT(told, ElementsAre(expected));
    EXPECT_THAT(on_port, ElementsAre(expected));
    EXPECT_LT(seen.values.size(), 10u) << "the graph stops in order";
    EXPECT_GE(seen.values.size(), 3u);
  }
}

TEST(Faults, AFaultOfAHaltedNodeFreesItsBlockedWriter) {
  Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  AddCustom(registry, "bad",
            {.input = [](Custom&, const Message<Number>&) -> Status { return SystemError("no"); }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 20}}
    bad: {type: bad, duration_ms: 100}
    sink: {type: sink}
  connections:
    - {from: count.number, to: bad.in, policy: block, capacity: 1}
    - {from: count.number, to: sink.in, policy: block}
)",
                                    registry);
  EXPECT_EQ(seen.values.size(), 20u) << "what was published before the fault arrives";
  EXPECT_EQ(ConnectionTo(report, "bad.in").discarded, 19u);
}

TEST(Faults, RecoverableFaultsAreToldAndTheGraphGoesOn) {
  std::vector<std::string> got;
  class FaultReader : public Node {
   public:
    explicit FaultReader(std::vector<std::string>& got) : got_(got) {}

   private:
    Status OnFault(const Message<Fault>& fault) {
      got_.push_back(fault->node + " " + fault->code + " " + fault->text);
      return {};
    }
    std::vector<std::string>& got_;
    Input<Fault> faults_{this, "faults", &FaultReader::OnFault, Need::kRequired, Writers::kMany};
  };
  NodeRegistry registry = BasicNodes();
  registry.Add("reader", [&got] { return std::make_unique<FaultReader>(got); });
  AddCustom(registry, "grumbler", {.input = [](Custom& node, const Message<Number>& number) {
              if (number->value == 2) node.ReportFault("blurred", "frame 2");
              return Status();
            }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 5, period_ms: 1}}
    g1: {type: grumbler}
    g2: {type: grumbler}
    reader: {type: reader}
  connections:
    - {from: count.number, to: g1.in, policy: block}
    - {from: count.number, to: g2.in, policy: block}
    - {from: "*.fault", to: reader.faults, policy: {keep_last: 4}}
)",
                                    registry);
  EXPECT_EQ(report.cause, StopCause::kCompleted);
  EXPECT_EQ(report.fault_count, 2u);
  EXPECT_FALSE(report.failure);
  EXPECT_THAT(got, ElementsAre("g1 blurred frame 2", "g2 blurred frame 2"));
}

TEST(Faults, AFailingStartStopsTheGraph) {
  NodeRegistry registry = BasicNodes();
  AddCustom(registry, "broken",
            {.start = [](Custom&) -> Status { return SystemError("no port"); }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 1000000, period_ms: 1}}
    broken: {type: broken}
)",
                                    registry);
  EXPECT_EQ(report.cause, StopCause::kFault);
  EXPECT_EQ(report.failure->text, "start: no port");
}

TEST(Stopping, PublishingOutsideOfHandlersDoesNothing) {
  Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  AddCustom(registry, "late", {.stop = [](Custom& node, StopMode) {
              node.out.Publish(Number{1}, Time(0));
              return Status();
            }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    late: {type: late}
    sink: {type: sink}
  connections:
    - {from: late.out, to: sink.in, policy: block}
)",
                                    registry);
  EXPECT_TRUE(seen.values.empty());
  EXPECT_EQ(ConnectionTo(report, "sink.in").delivered, 0u);
}

}  // namespace
}  // namespace turnlight::nodes::graph
