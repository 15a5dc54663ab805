// Proves the contract of record and replay: with the sources replaced by a log, every node that
// runs publishes the same bytes at the same instants again, and a log that cannot do that is
// refused. Does not prove it for nodes that look at anything but their inputs and params.
#include "base/file.h"
#include "nodes/graph/action.h"
#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::HasSubstr;

struct TurnForNumber {
  using Goal = Number;
  using Feedback = Number;
  using Result = Number;
};

// Not a source: asks the table for each number that comes, when it is free, and says what it got.
class TurnSender : public Node {
 public:
  Status WindDown() override {
    said_.Publish(Number{-1000.0 - answers_}, Time(0));
    return {};
  }

 private:
  Status OnNumber(const Message<Number>& number) {
    if (turn_.active()) return {};
    const auto id = turn_.Send(*number, number.header.valid_at, FromMs(40));
    return id ? Status() : Forward(id);
  }
  Status OnEnd(const ActionOutcome<TurnForNumber>& outcome) {
    ++answers_;
    said_.Publish(Number{outcome.deadline_passed() ? -1.0 : outcome.result().value},
                  outcome.header.valid_at);
    return {};
  }
  int answers_ = 0;
  Input<Number> in_{this, "in", &TurnSender::OnNumber};
  ActionClient<TurnForNumber> turn_{this, "turn", &TurnSender::OnEnd};
  Output<Number> said_{this, "said"};
};

// A source: takes as many milliseconds as the goal says, and does not answer every fifth goal at
// all.
class LazyTable : public Node {
 public:
  static inline int started = 0;
  Status Start() override {
    ++started;
    return {};
  }

 private:
  Status OnGoal(const Message<ActionGoal<Number>>& goal) {
    goal_ = *goal;
    timer_.After(FromMs(goal_.goal.value));
    return {};
  }
  Status OnTimer(Time now) {
    if (goal_.id % 5 != 0) turn_.Finish(goal_.id, Number{100 + goal_.goal.value}, now);
    return {};
  }
  ActionGoal<Number> goal_;
  Timer timer_{this, "timer", &LazyTable::OnTimer};
  ActionServer<TurnForNumber> turn_{this, "turn", &LazyTable::OnGoal};
};

NodeRegistry NodesToReplay() {
  static Seen seen;
  NodeRegistry registry = BasicNodes();
  AddSink(registry, seen);
  registry.Add<TurnSender>("asker");
  registry.Add<LazyTable>("table");
  return registry;
}

// A source that is faster than its block connection allows, a background node, an action between a
// running node and a source, fan-out, drops.
std::string RigLike(const std::string& record) {
  return R"(
graph:
  executor: virtual
  seed: 3
  nodes:
    count: {type: counter, params: {count: 300, period_ms: 1}}
    twice: {type: doubler, duration_ms: 0.4}
    background: {type: doubler, duration_ms: 7}
    blocked: {type: counter, params: {count: 40, period_ms: 2}}
    slow: {type: doubler, duration_ms: 11}
    asker: {type: asker, duration_ms: 0.1}
    table: {type: table}
    sink: {type: sink}
  connections:
    - {from: count.number, to: twice.in, policy: block}
    - {from: count.number, to: background.in, policy: {keep_last: 2}}
    - {from: count.number, to: asker.in, policy: {keep_last: 1}}
    - {from: blocked.number, to: slow.in, policy: block, capacity: 2}
    - {from: asker.turn, to: table.turn}
    - {from: twice.out, to: sink.in, policy: block}
  record: [)" +
         record + "]\n";
}
const std::string kAll =
    "count.number, blocked.number, table.turn.result, table.turn.feedback, twice.out, "
    "background.out, slow.out, asker.said, asker.turn.goal";

Result<RunReport> ReplayFrom(const std::string& yaml, const std::filesystem::path& log,
                             const RunOptions& options = {}) {
  auto graph = BuildFrom(yaml, NodesToReplay());
  if (!graph) return Forward(graph);
  return graph->Replay(log, options);
}

TEST(Replay, GivesTheSameLogByteForByteWithoutRunningTheSources) {
  const TemporaryFolder folder;
  const RunReport recorded = RunGraph(RigLike(kAll), NodesToReplay(), {.log = folder / "run"});
  EXPECT_GT(ConnectionTo(recorded, "slow.in").blocked, 0u);
  EXPECT_GT(ConnectionTo(recorded, "background.in").dropped, 0u);
  LazyTable::started = 0;
  const auto replayed = ReplayFrom(RigLike(kAll), folder / "run", {.log = folder / "replay"});
  ASSERT_TRUE(replayed) << ErrorOf(replayed);
  EXPECT_EQ(replayed->fault_count, 0u);
  EXPECT_EQ(LazyTable::started, 0);
  const auto difference = CompareLogs(folder / "run", folder / "replay", CompareMode::kExact);
  ASSERT_TRUE(difference) << ErrorOf(difference);
  EXPECT_FALSE(*difference) << (*difference)->text;
  const std::string bytes = ReadFile(folder / "run").value();
  EXPECT_GT(bytes.size(), 20000u);
  EXPECT_EQ(bytes, ReadFile(folder / "replay").value());
}

TEST(Replay, ARunStoppedInTheMiddleIsReplayedToTheSameEnd) {
  for (const StopMode mode : {StopMode::kDrain, StopMode::kNow}) {
    const TemporaryFolder folder;
    auto graph = BuildFrom(RigLike(kAll), NodesToReplay());
    ASSERT_TRUE(graph) << ErrorOf(graph);
    ASSERT_TRUE(graph->Tap<Number>("count.number", [&](const Message<Number>& number) {
      if (number->value == 57) graph->RequestStop(mode);
    }));
    ASSERT_TRUE(graph->Run({.log = folder / "run"}));
    const auto replayed = ReplayFrom(RigLike(kAll), folder / "run", {.log = folder / "replay"});
    ASSERT_TRUE(replayed) << ErrorOf(replayed);
    const auto difference = CompareLogs(folder / "run", folder / "replay", CompareMode::kExact);
    ASSERT_TRUE(difference) << ErrorOf(difference);
    EXPECT_FALSE(*difference) << (*difference)->text;
  }
}

// The test of the test: a node that does not compute the same is found and named.
TEST(Replay, ADifferentResultIsNamed) {
  const TemporaryFolder folder;
  RunGraph(RigLike(kAll), NodesToReplay(), {.log = folder / "run"});
  NodeRegistry other = NodesToReplay();
  AddCustom(other, "doubler", {.input = [](Custom& node, const Message<Number>& number) {
              node.out.Publish(Number{number->value == 31 ? 0 : 2 * number->value},
                               number.header.valid_at);
              return Status();
            }});
  auto graph = BuildFrom(RigLike(kAll), other);
  ASSERT_TRUE(graph) << ErrorOf(graph);
  ASSERT_TRUE(graph->Replay(folder / "run", {.log = folder / "replay"}));
  const auto difference = CompareLogs(folder / "run", folder / "replay", CompareMode::kExact);
  ASSERT_TRUE(difference && *difference);
  EXPECT_EQ((*difference)->topic, "twice.out");
  EXPECT_EQ((*difference)->sequence, 30u);
}

TEST(Replay, ALogThatWasCutOffIsReplayedUpToTheCut) {
  const TemporaryFolder folder;
  RunGraph(RigLike(kAll), NodesToReplay(), {.log = folder / "run"});
  std::filesystem::resize_file(folder / "run", std::filesystem::file_size(folder / "run") / 2);
  const auto replayed = ReplayFrom(RigLike(kAll), folder / "run", {.log = folder / "replay"});
  ASSERT_TRUE(replayed) << ErrorOf(replayed);
  EXPECT_EQ(replayed->cause, StopCause::kCompleted);
  EXPECT_GT(replayed->handled, 100u);
}

TEST(Replay, AWallLogIsReplayedInVirtualTime) {
  const TemporaryFolder folder;
  const std::string yaml = R"(
graph:
  executor: wall
  nodes:
    count: {type: counter, params: {count: 50, period_ms: 0.2}}
    twice: {type: doubler}
    sink: {type: sink}
  connections:
    - {from: count.number, to: twice.in, policy: block}
    - {from: twice.out, to: sink.in, policy: block}
  record: [count.number, twice.out]
)";
  RunGraph(yaml, NodesToReplay(), {.log = folder / "run"});
  const auto replayed = ReplayFrom(yaml, folder / "run", {.log = folder / "replay"});
  ASSERT_TRUE(replayed) << ErrorOf(replayed);
  const auto difference = CompareLogs(folder / "run", folder / "replay", CompareMode::kContent);
  ASSERT_TRUE(difference) << ErrorOf(difference);
  EXPECT_FALSE(*difference) << (*difference)->text;
}

TEST(Replay, RefusesALogThatDoesNotFit) {
  const TemporaryFolder folder;
  const std::string partly = "count.number, blocked.number, twice.out";
  RunGraph(RigLike(partly), NodesToReplay(), {.log = folder / "run"});
  EXPECT_THAT(ErrorOf(ReplayFrom(RigLike(partly), folder / "run")),
              HasSubstr("table.turn.feedback is not in the log; a run that is to be replayed must "
                        "have it under record"));
  EXPECT_THAT(ErrorOf(ReplayFrom(RigLike(kAll), folder / "run")),
              HasSubstr("recorded with the config of hash"));
  EXPECT_THAT(ErrorOf(ReplayFrom(RigLike(kAll), folder / "none")),
              HasSubstr("cannot open the log"));
}

TEST(Replay, RefusesMessagesOfAnotherVersion) {
  const TemporaryFolder folder;
  const std::string yaml = R"(
graph:
  executor: virtual
  nodes:
    count: {type: counter, params: {count: 3}}
    sink: {type: sink}
  connections:
    - {from: count.number, to: sink.in, policy: block}
  record: [count.number]
)";
  const auto config = ParseGraphConfig(yaml, "test.yaml");
  ASSERT_TRUE(config);
  auto log = LogWriter::Create(folder / "old",
                               {config->hash, config->seed, {{"count.number", "Number", 0}}});
  ASSERT_TRUE(log);
  ASSERT_TRUE((*log)->Close({}));
  EXPECT_THAT(ErrorOf(ReplayFrom(yaml, folder / "old")),
              HasSubstr("count.number was recorded as Number v0, allowed is Number v1"));
  log = LogWriter::Create(folder / "broken",
                          {config->hash, config->seed, {{"count.number", "Number", 1}}});
  ASSERT_TRUE(log);
  (*log)->Append(0, TypeOf<Word>(),
                 {{0, Time(0), Time(5)}, std::make_shared<const Word>(Word{"not a number"})});
  ASSERT_TRUE((*log)->Close({}));
  const auto report = ReplayFrom(yaml, folder / "broken");
  ASSERT_TRUE(report) << ErrorOf(report);
  ASSERT_TRUE(report->failure);
  EXPECT_THAT(report->failure->text, HasSubstr("count.number #0: not a Number v1"));
}

}  // namespace
}  // namespace turnlight::nodes::graph
