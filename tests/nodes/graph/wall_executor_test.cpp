// Proves that the wall executor delivers the same content as the virtual one, loses nothing under
// block, stops in order and at once, tells which node overran its deadline, and survives a node
// that hangs; run under the thread sanitizer it proves the absence of the data races that these
// graphs could show. Does not prove latencies: bench/graph_bus_benchmark.cpp measures them.
#include <atomic>
#include <condition_variable>
#include <thread>

#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

class Gate {
 public:
  void Open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    opened_.notify_all();
  }
  void Wait() {
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [this] { return open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool open_ = false;
};

std::string Chain(const std::string& executor) {
  return "graph:\n  executor: " + executor + R"(
  nodes:
    count: {type: counter, params: {count: 2000}}
    twice: {type: doubler}
    more: {type: doubler}
    sink: {type: sink}
  connections:
    - {from: count.number, to: twice.in, policy: block, capacity: 2}
    - {from: twice.out, to: more.in, policy: block, capacity: 1}
    - {from: more.out, to: sink.in, policy: block, capacity: 3}
  record: [count.number, twice.out, more.out]
)";
}

TEST(WallExecutor, DeliversTheSameContentAsTheVirtualExecutor) {
  const TemporaryFolder folder;
  for (const std::string executor : {"virtual", "wall"}) {
    Seen seen;
    NodeRegistry registry = BasicNodes();
    AddSink(registry, seen);
    const RunReport report =
        RunGraph(Chain(executor), registry, {.log = folder / (executor + ".log")});
    EXPECT_EQ(report.cause, StopCause::kCompleted);
    EXPECT_EQ(report.handled, 6000u);
    ASSERT_EQ(seen.values.size(), 2000u);
    for (std::size_t i = 0; i < seen.values.size(); ++i) {
      EXPECT_EQ(seen.values[i], 4.0 * static_cast<double>(i + 1));
      EXPECT_EQ(seen.headers[i].sequence, i);
    }
  }
  EXPECT_EQ(Difference(folder / "virtual.log", folder / "wall.log", CompareMode::kContent), "");
}

TEST(WallExecutor, NodesRunAtTheSameTime) {
  // Each waits for the other: on one thread this would never end.
  Gate first, second;
  NodeRegistry registry;
  AddCustom(registry, "first", {.start = [&](Custom&) {
              first.Open();
              second.Wait();
              return Status();
            }});
  AddCustom(registry, "second", {.start = [&](Custom&) {
              second.Open();
              first.Wait();
              return Status();
            }});
  RunGraph("graph:\n  executor: wall\n  nodes:\n    a: {type: first}\n    b: {type: second}\n",
           registry);
}

TEST(WallExecutor, KeepLastDropsAndCountsWhileTheReceiverIsBusy) {
  Gate all_sent;
  std::vector<double> got;
  NodeRegistry registry = BasicNodes();
  AddCustom(registry, "flood", {.start = [&](Custom& node) {
              for (int i = 1; i <= 100; ++i) node.out.Publish(Number{double(i)}, Time(0));
              all_sent.Open();
              return Status();
            }});
  AddCustom(registry, "slow",
            {.start =
                 [&](Custom&) {
                   all_sent.Wait();
                   return Status();
                 },
             .input =
                 [&](Custom&, const Message<Number>& number) {
                   got.push_back(number->value);
                   return Status();
                 }});
  const RunReport report = RunGraph(R"(
graph:
  executor: wall
  nodes:
    flood: {type: flood}
    slow: {type: slow}
  connections:
    - {from: flood.out, to: slow.in, policy: {keep_last: 3}}
)",
                                    registry);
  EXPECT_THAT(got, ElementsAre(98, 99, 100));
  EXPECT_EQ(ConnectionTo(report, "slow.in").dropped, 97u);
  EXPECT_EQ(ConnectionTo(report, "slow.in").delivered, 100u);
}

TEST(WallExecutor, TimersFollowTheSteadyClock) {
  std::vector<Time> times;
  std::string label;
  NodeRegistry registry;
  AddSource(registry, "clock",
            {.start =
                 [&label](CustomSource& node) {
                   label = node.clock.UtcLabel();
                   node.timer.Every(2ms);
                   return Status();
                 },
             .timer =
                 [&times](CustomSource& node, Time now) {
                   times.push_back(now);
                   if (times.size() == 5) node.timer.Cancel();
                   return Status();
                 }});
  const RunReport report =
      RunGraph("graph:\n  executor: wall\n  nodes:\n    clock: {type: clock}\n", registry);
  EXPECT_EQ(report.cause, StopCause::kCompleted) << "no timer, no message: the end";
  ASSERT_EQ(times.size(), 5u);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_GE(times[i], Duration(2ms) * static_cast<int>(i + 1));
  EXPECT_THAT(label, testing::MatchesRegex("20..-..-..T..:..:..\\..*Z"));
}

TEST(WallExecutor, StopsInOrderWhenAskedFromAnotherThread) {
  Seen seen;
  StopList list;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  for (const std::string name : {"first", "second"}) list.AddTo(registry, name);
  auto graph = BuildFrom(R"(
graph:
  executor: wall
  nodes:
    first: {type: first}
    count: {type: counter, params: {count: 1000000, period_ms: 1}}
    sink: {type: sink}
    second: {type: second}
  connections:
    - {from: count.number, to: sink.in, policy: block, capacity: 1000}
)",
                         registry);
  ASSERT_TRUE(graph) << ErrorOf(graph);
  std::thread caller([&graph] {
    std::this_thread::sleep_for(20ms);
    graph->RequestStop(StopMode::kDrain);
  });
  const auto report = graph->Run();
  caller.join();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->cause, StopCause::kRequested);
  EXPECT_THAT(list.stops(), ElementsAre("first drained", "second drained"));
  EXPECT_EQ(seen.values.size(), ConnectionTo(*report, "sink.in").delivered) << "drained";
  EXPECT_EQ(ConnectionTo(*report, "sink.in").discarded, 0u);
}

// What the nodes of a graph that is stopped at once did.
struct StoppedAtOnce {
  Gate entered;
  std::atomic<int> stopped{0};
  std::atomic<bool> blocked_returned{false};
};

// A node that publishes more than a queue takes, and one that is slow to take it.
void AddPusherAndStuck(NodeRegistry& registry, StoppedAtOnce& seen) {
  const auto count_stop = [&seen](Custom&, StopMode mode) {
    if (mode == StopMode::kNow) ++seen.stopped;
    return Status();
  };
  AddCustom(registry, "pusher",
            {.start =
                 [&seen](Custom& node) {
                   for (int i = 0; i < 10; ++i) node.out.Publish(Number{1}, Time(0));
                   seen.blocked_returned = true;
                   return Status();
                 },
             .stop = count_stop});
  AddCustom(registry, "stuck",
            {.input =
                 [&seen](Custom&, const Message<Number>&) {
                   seen.entered.Open();
                   std::this_thread::sleep_for(30ms);
                   return Status();
                 },
             .stop = count_stop});
}

TEST(WallExecutor, StopNowFreesABlockedPublisherAndStopsEveryNode) {
  StoppedAtOnce seen;
  NodeRegistry registry;
  AddPusherAndStuck(registry, seen);
  auto graph = BuildFrom(R"(
graph:
  executor: wall
  nodes:
    pusher: {type: pusher}
    stuck: {type: stuck}
  connections:
    - {from: pusher.out, to: stuck.in, policy: block, capacity: 2}
)",
                         registry);
  ASSERT_TRUE(graph) << ErrorOf(graph);
  std::thread caller([&] {
    seen.entered.Wait();
    graph->RequestStop(StopMode::kDrain);
    graph->RequestStop(StopMode::kNow);
  });
  const auto report = graph->Run();
  caller.join();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->cause, StopCause::kImmediate);
  EXPECT_EQ(seen.stopped, 2);
  EXPECT_TRUE(seen.blocked_returned);
  EXPECT_GT(ConnectionTo(*report, "stuck.in").discarded, 0u);
  EXPECT_GT(ConnectionTo(*report, "stuck.in").blocked, 0u);
  EXPECT_TRUE(report->hung.empty());
}

TEST(WallExecutor, TheWatchdogNamesTheNodeThatOverruns) {
  std::vector<Fault> told;
  std::mutex mutex;
  NodeRegistry registry = BasicNodes();
  AddCustom(registry, "slow", {.input = [](Custom&, const Message<Number>&) {
              std::this_thread::sleep_for(60ms);
              return Status();
            }});
  Seen seen;
  AddSink(registry, seen);
  auto graph = BuildFrom(R"(
graph:
  executor: wall
  nodes:
    count: {type: counter, params: {count: 1}}
    slow: {type: slow, deadline_ms: 8}
    sink: {type: sink, deadline_ms: 5000}
  connections:
    - {from: count.number, to: slow.in, policy: block}
    - {from: count.number, to: sink.in, policy: block}
)",
                         registry);
  ASSERT_TRUE(graph) << ErrorOf(graph);
  std::vector<Fault> on_port;
  ASSERT_TRUE(graph->Tap<Fault>(
      "slow.fault", [&on_port](const Message<Fault>& fault) { on_port.push_back(*fault); }));
  const auto report = graph->Run({.on_fault = [&](const Fault& fault) {
    const std::lock_guard lock(mutex);
    told.push_back(fault);
  }});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->cause, StopCause::kCompleted);
  ASSERT_EQ(report->overruns.size(), 1u) << "once for each handler";
  EXPECT_EQ(report->overruns[0].node, "slow");
  EXPECT_GT(report->overruns[0].took, report->overruns[0].deadline);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].node, "slow");
  EXPECT_EQ(told[0].code, "deadline");
  EXPECT_TRUE(told[0].recoverable);
  EXPECT_THAT(told[0].text, testing::EndsWith("allowed are 8.000 ms"));
  EXPECT_THAT(on_port, ElementsAre(told[0]));
}

TEST(WallExecutor, ANodeThatHangsIsNamedAndLeftBehind) {
  const auto gate = std::make_shared<Gate>();
  const auto returned = std::make_shared<std::atomic<bool>>(false);
  NodeRegistry registry = BasicNodes();
  AddCustom(registry, "hanging",
            {.input =
                 [gate](Custom&, const Message<Number>&) {
                   gate->Wait();
                   return Status();
                 },
             .stop =
                 [returned](Custom&, StopMode) {
                   *returned = true;
                   return Status();
                 }});
  {
    auto graph = BuildFrom(R"(
graph:
  executor: wall
  nodes:
    count: {type: counter, params: {count: 1}}
    hanging: {type: hanging, deadline_ms: 5}
  connections:
    - {from: count.number, to: hanging.in, policy: block}
)",
                           registry);
    ASSERT_TRUE(graph) << ErrorOf(graph);
    // Long enough for the other node's thread to get its turn on a machine that is busy.
    const auto report = graph->Run({.on_fault =
                                        [&graph](const Fault& fault) {
                                          EXPECT_EQ(fault.node, "hanging");
                                          graph->RequestStop(StopMode::kNow);
                                        },
                                    .hang_grace = 500ms});
    ASSERT_TRUE(report);
    EXPECT_THAT(report->hung, ElementsAre("hanging"));
    EXPECT_EQ(report->cause, StopCause::kImmediate);
  }
  gate->Open();  // the thread still has all it needs
  while (!*returned) std::this_thread::sleep_for(1ms);
}

TEST(WallExecutor, AFaultHaltsItsNodeAndStopsTheRestInOrder) {
  Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  AddCustom(registry, "bad", {.input = [](Custom&, const Message<Number>& number) -> Status {
              if (number->value < 3) return {};
              throw std::runtime_error("bang");
            }});
  const RunReport report =
      RunGraph(BadBesideASink("wall", "count: 1000000, period_ms: 1", ""), registry);
  EXPECT_EQ(report.cause, StopCause::kFault);
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->text, "input in threw: bang");
  EXPECT_EQ(seen.values.size(), ConnectionTo(report, "sink.in").delivered);
}

TEST(WallExecutor, AHeldStopKeepsTimersRunning) {
  std::atomic<int> ticks{0};
  NodeRegistry registry;
  AddHolder(registry, "holder", 1.0, [&ticks](Time) { return ++ticks == 10; });
  const RunReport report =
      RunGraph("graph:\n  executor: wall\n  nodes:\n    h: {type: holder}\n", registry);
  EXPECT_GE(ticks, 10);
  EXPECT_EQ(report.cause, StopCause::kRequested);
}

// Two writers and a connection to itself, which sends back every other message.
class Ring : public Node {
  Status OnNumber(const Message<Number>& number) {
    if (number.header.sequence % 2 == 0) out_.Publish(number.value, number.header.valid_at);
    return {};
  }
  Input<Number> in_{this, "in", &Ring::OnNumber, Need::kRequired, Writers::kMany};
  Output<Number> out_{this, "out"};
};

constexpr char kFanOutAndRing[] = R"(
graph:
  executor: wall
  nodes:
    count: {type: counter, params: {count: 100000000}}
    a: {type: doubler}
    b: {type: doubler}
    c: {type: doubler, deadline_ms: 1000}
    ring: {type: ring}
    sink: {type: sink}
  connections:
    - {from: count.number, to: a.in, policy: block, capacity: 1}
    - {from: count.number, to: b.in, policy: block, capacity: 7}
    - {from: b.out, to: c.in, policy: block, capacity: 2}
    - {from: a.out, to: ring.in, policy: {keep_last: 2}}
    - {from: ring.out, to: ring.in, policy: {keep_last: 1}}
    - {from: c.out, to: sink.in, policy: block, capacity: 3}
)";

// Fan-out, a ring, full queues and a stop at any moment: no message is lost or left in an orderly
// stop, and neither kind of stop ever hangs.
TEST(WallExecutor, StopsAtAnyMomentWithoutLossOrDeadlock) {
  for (int round = 0; round < 40; ++round) {
    Seen seen;
    NodeRegistry registry = BasicNodes();
    AddSink(registry, seen);
    registry.Add<Ring>("ring");
    // A source that sends for ever in one handler can only be stopped now; one with a timer in
    // order.
    const bool now = round % 2 == 0;
    std::string text = kFanOutAndRing;
    if (!now) text.replace(text.find("count: 100000000"), 16, "count: 100000000, period_ms: 0.01");
    auto graph = BuildFrom(text, registry);
    ASSERT_TRUE(graph) << ErrorOf(graph);
    std::thread caller([&graph, round, now] {
      std::this_thread::sleep_for(std::chrono::microseconds(137 * round));
      graph->RequestStop(now ? StopMode::kNow : StopMode::kDrain);
    });
    const auto report = graph->Run();
    caller.join();
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->hung.empty());
    EXPECT_EQ(report->fault_count, 0u);
    if (now) continue;
    const std::uint64_t sent = ConnectionTo(*report, "b.in").delivered;
    EXPECT_EQ(ConnectionTo(*report, "sink.in").delivered, sent);
    EXPECT_EQ(seen.values.size(), sent);
    for (std::size_t i = 0; i < seen.values.size(); ++i)
      ASSERT_EQ(seen.values[i], 4.0 * static_cast<double>(i + 1));
  }
}

TEST(WallExecutor, ATapMayComeWhileTheGraphRuns) {
  NodeRegistry registry;
  std::atomic<int> got{0};
  Gate published;
  AddSource(registry, "source",
            {.start =
                 [&](CustomSource& node) {
                   node.out.Publish(Number{1}, Time(0));
                   node.timer.Every(1ms);
                   published.Open();
                   return Status();
                 },
             .timer =
                 [&](CustomSource& node, Time now) {
                   node.out.Publish(Number{2}, now);
                   if (got >= 3) node.RequestStop();
                   return Status();
                 }});
  auto graph =
      BuildFrom("graph:\n  executor: wall\n  nodes:\n    source: {type: source}\n", registry);
  ASSERT_TRUE(graph);
  std::thread viewer([&] {
    published.Wait();
    EXPECT_TRUE(graph->Tap<Number>("source.out", [&got](const Message<Number>&) { ++got; }));
    EXPECT_GE(got, 1) << "the last message of a latched topic, at once";
  });
  EXPECT_TRUE(graph->Run());
  viewer.join();
}

}  // namespace
}  // namespace turnlight::nodes::graph
