// Proves that the virtual executor delivers in one order that depends on the config alone, that
// declared durations, policies and timers do what the headers say, and that a run of 10^6 messages
// stays fast. Does not prove how a run ends (fault_and_stop_test.cpp), nor anything about threads.
#include "base/file.h"
#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<double> Ms(const std::vector<Header>& headers) {
  std::vector<double> times;
  for (const Header& header : headers) times.push_back(ToMs(header.processed_at));
  return times;
}

TEST(VirtualExecutor, MessagesCarrySequenceValidityAndProcessingTime) {
  Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 3, period_ms: 100}, duration_ms: 2}
    twice: {type: doubler, duration_ms: 5}
    sink: {type: sink}
  connections:
    - {from: count.number, to: twice.in, policy: block}
    - {from: twice.out, to: sink.in, policy: block}
)",
                                    registry);
  EXPECT_THAT(seen.values, ElementsAre(2, 4, 6));
  EXPECT_THAT(Ms(seen.headers), ElementsAre(107, 207, 307));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(seen.headers[i].sequence, i);
    EXPECT_EQ(seen.headers[i].valid_at, FromMs(100.0 * static_cast<double>(i + 1)));
  }
  EXPECT_EQ(report.cause, StopCause::kCompleted);
  EXPECT_EQ(report.handled, 9u);
  EXPECT_EQ(report.fault_count, 0u);
}

// The background estimator: busy for 2 s while its inputs queue by policy and the others go on.
TEST(VirtualExecutor, ABusyNodesInputQueuesByItsPolicy) {
  const auto run = [](const std::string& policy, Seen& slow, Seen& fast) {
    NodeRegistry registry = BasicNodes();
    AddSink(registry, slow, "slow");
    AddSink(registry, fast, "fast");
    return RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 100, period_ms: 100}}
    slow: {type: slow, duration_ms: 2000}
    fast: {type: fast}
  connections:
    - {from: count.number, to: fast.in, policy: block, capacity: 1}
    - {from: count.number, to: slow.in, policy: )" +
                        policy + "}\n",
                    registry);
  };
  Seen slow, fast;
  RunReport report = run("{keep_last: 1}", slow, fast);
  EXPECT_THAT(slow.values, ElementsAre(1, 21, 41, 61, 81, 100));
  EXPECT_EQ(ConnectionTo(report, "slow.in").dropped, 94u);
  EXPECT_EQ(ConnectionTo(report, "slow.in").delivered, 100u);
  EXPECT_EQ(fast.values.size(), 100u);
  EXPECT_EQ(fast.headers.back().processed_at, FromMs(10000) + Duration(1));

  Seen all_slow, all_fast;
  report = run("block, capacity: 4", all_slow, all_fast);
  EXPECT_EQ(all_slow.values.size(), 100u) << "block loses nothing";
  EXPECT_EQ(ConnectionTo(report, "slow.in").dropped, 0u);
  EXPECT_GT(ConnectionTo(report, "slow.in").blocked, 0u);
  EXPECT_EQ(all_fast.values.size(), 100u);
  EXPECT_GE(report.ended_at, FromMs(200'000)) << "the source had to wait";
}

// What the log of a run with fan-out, a slow node, drops and a blocked source says, as bytes.
std::string LogOfBusyGraph(const std::filesystem::path& path) {
  static Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  RunGraph(R"(
graph:
  executor: virtual
  seed: 11
  nodes:
    a: {type: counter, params: {count: 200, period_ms: 1}}
    b: {type: counter, params: {count: 200, period_ms: 1}}
    p: {type: doubler, duration_ms: 3}
    q: {type: doubler, duration_ms: 1.7}
    sink: {type: sink}
  connections:
    - {from: a.number, to: p.in, policy: {keep_last: 2}}
    - {from: b.number, to: q.in, policy: block, capacity: 3}
    - {from: q.out, to: sink.in, policy: block}
  record: [a.number, b.number, p.out, q.out]
)",
           registry, {.log = path});
  return ReadFile(path).value();
}

TEST(VirtualExecutor, TheSameConfigGivesTheSameLogByteForByte) {
  const TemporaryFolder folder;
  const std::string first = LogOfBusyGraph(folder / "1.log");
  EXPECT_GT(first.size(), 10000u);
  EXPECT_EQ(first, LogOfBusyGraph(folder / "2.log"));
  const auto difference = CompareLogs(folder / "1.log", folder / "2.log", CompareMode::kExact);
  ASSERT_TRUE(difference) << ErrorOf(difference);
  EXPECT_FALSE(*difference) << (*difference)->text;
}

TEST(VirtualExecutor, AtEqualTimesNodesGoInOrderOfDeclaration) {
  const auto order = [](const std::string& first, const std::string& second) {
    std::vector<std::string> names;
    NodeRegistry registry;
    for (const std::string name : {"x", "y"})
      AddSource(registry, name,
                {.start =
                     [](CustomSource& node) {
                       node.timer.After(FromMs(1));
                       return Status();
                     },
                 .timer =
                     [&names, name](CustomSource&, Time) {
                       names.push_back(name);
                       return Status();
                     }});
    RunGraph("graph:\n  executor: virtual\n  nodes:\n    " + first + "1: {type: " + first +
                 "}\n    " + second + "2: {type: " + second + "}\n",
             registry);
    return names;
  };
  EXPECT_THAT(order("x", "y"), ElementsAre("x", "y"));
  EXPECT_THAT(order("y", "x"), ElementsAre("y", "x"));
}

TEST(VirtualExecutor, TimersFireOnceOrPeriodicallyAndSkipMissedPeriods) {
  std::vector<double> once, often;
  NodeRegistry registry;
  AddSource(registry, "once",
            {.start =
                 [](CustomSource& node) {
                   node.timer.After(FromMs(30));
                   node.timer.After(FromMs(20));
                   return Status();
                 },
             .timer =
                 [&once](CustomSource&, Time now) {
                   once.push_back(ToMs(now));
                   return Status();
                 }});
  AddSource(registry, "often",
            {.start =
                 [](CustomSource& node) {
                   node.timer.Every(FromMs(10));
                   return Status();
                 },
             .timer =
                 [&often](CustomSource& node, Time now) {
                   often.push_back(ToMs(now));
                   if (often.size() == 4) node.timer.Cancel();
                   return Status();
                 }});
  RunGraph(R"(
graph:
  executor: virtual
  nodes:
    once: {type: once}
    often: {type: often, duration_ms: 25}
)",
           registry);
  EXPECT_THAT(once, ElementsAre(20));
  // Due at 10; busy to 35: due at 20 is late, 30 skipped; busy to 60, due at 40, and so on.
  EXPECT_THAT(often, ElementsAre(10, 35, 60, 85));
}

TEST(VirtualExecutor, ATimerThatIsDueOftenDoesNotStarveMessages) {
  Seen unused;
  std::vector<std::string> calls;
  NodeRegistry registry = BasicNodes();
  AddSource(registry, "both",
            {.start =
                 [](CustomSource& node) {
                   node.timer.Every(FromMs(1));
                   return Status();
                 },
             .input =
                 [&calls](CustomSource&, const Message<Number>&) {
                   calls.push_back("message");
                   return Status();
                 },
             .timer =
                 [&calls](CustomSource& node, Time) {
                   calls.push_back("timer");
                   if (calls.size() > 20) node.timer.Cancel();
                   return Status();
                 }});
  RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 5, period_ms: 1}}
    both: {type: both, duration_ms: 10}
  connections:
    - {from: count.number, to: both.in, policy: block}
)",
           registry);
  EXPECT_EQ(std::count(calls.begin(), calls.begin() + 15, "message"), 5);
}

TEST(VirtualExecutor, ALatchedTopicGivesALateTapTheLastMessage) {
  NodeRegistry registry;
  std::optional<Graph> graph;
  std::vector<double> late;
  AddSource(registry, "source",
            {.start =
                 [](CustomSource& node) {
                   node.out.Publish(Number{41}, Time(0));
                   node.out.Publish(Number{42}, Time(0));
                   node.timer.After(FromMs(5));
                   return Status();
                 },
             .timer =
                 [&](CustomSource& node, Time now) {
                   EXPECT_TRUE(graph->Tap<Number>(
                       "source.out",
                       [&late](const Message<Number>& number) { late.push_back(number->value); }));
                   node.out.Publish(Number{43}, now);
                   return Status();
                 }});
  auto built =
      BuildFrom("graph:\n  executor: virtual\n  nodes:\n    source: {type: source}\n", registry);
  ASSERT_TRUE(built) << ErrorOf(built);
  graph = std::move(*built);
  ASSERT_TRUE(graph->Run());
  EXPECT_THAT(late, ElementsAre(42, 43));
}

TEST(VirtualExecutor, AnOverrunIsReportedByNameAndChangesNothing) {
  NodeRegistry registry = BasicNodes();
  AddCustom(registry, "slow", {.input = [](Custom&, const Message<Number>&) {
              const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
              while (std::chrono::steady_clock::now() < until) {
              }
              return Status();
            }});
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 1}}
    slow: {type: slow, deadline_ms: 5}
  connections:
    - {from: count.number, to: slow.in, policy: block}
)",
                                    registry);
  ASSERT_EQ(report.overruns.size(), 1u);
  EXPECT_EQ(report.overruns[0].node, "slow");
  EXPECT_GE(report.overruns[0].took, FromMs(20));
  EXPECT_EQ(report.fault_count, 0u);
}

TEST(VirtualExecutor, AGraphRunsOnce) {
  auto graph = BuildFrom(
      "graph:\n  executor: virtual\n  nodes:\n    c: {type: counter, params: {count: 1}}\n",
      BasicNodes());
  ASSERT_TRUE(graph);
  EXPECT_TRUE(graph->Run());
  EXPECT_THAT(ErrorOf(graph->Run()), HasSubstr("a graph runs once"));
}

TEST(VirtualExecutor, PingPongOfAMillionMessages) {
  constexpr double kCount = 1e6;
  NodeRegistry registry;
  double last = 0;
  AddCustom(registry, "ping",
            {.start =
                 [](Custom& node) {
                   node.out.Publish(Number{1}, Time(0));
                   return Status();
                 },
             .input =
                 [&last](Custom& node, const Message<Number>& number) {
                   last = number->value;
                   if (last < kCount) node.out.Publish(Number{last + 1}, number.header.valid_at);
                   return Status();
                 }});
  const auto began = std::chrono::steady_clock::now();
  const RunReport report = RunGraph(R"(
graph:
  executor: virtual
  nodes:
    ping: {type: ping}
    pong: {type: ping}
  connections:
    - {from: ping.out, to: pong.in, policy: {keep_last: 1}}
    - {from: pong.out, to: ping.in, policy: {keep_last: 1}}
)",
                                    registry);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  EXPECT_EQ(last, kCount);
  // Both nodes open with a 1: two messages are under way at a time.
  EXPECT_EQ(report.handled, 2u * static_cast<std::uint64_t>(kCount));
  EXPECT_EQ(ConnectionTo(report, "pong.in").dropped, 0u);
  RecordProperty("messages_per_second", static_cast<int>(2 * kCount / seconds));
  EXPECT_LT(seconds, 60.0);
}

}  // namespace
}  // namespace turnlight::nodes::graph
