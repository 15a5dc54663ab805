// Proves that a config that cannot work is refused when the graph is built, with the file, the line
// and what is allowed; and how a good one is drawn. Does not prove that nodes check their own
// params well.
#include "nodes/graph/connect.h"

#include "nodes/graph/action.h"
#include "nodes/graph/draw.h"
#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::HasSubstr;

struct NumberAction {
  using Goal = Number;
  using Feedback = Number;
  using Result = Number;
};
struct WordAction {
  using Goal = Word;
  using Feedback = Number;
  using Result = Number;
};

template <typename Action>
class AnyAsker : public Node {
  Status OnEnd(const ActionOutcome<Action>&) { return {}; }
  ActionClient<Action> turn_{this, "turn", &AnyAsker::OnEnd};
};
class Server : public Node {
  Status OnGoal(const Message<ActionGoal<Number>>&) { return {}; }
  ActionServer<NumberAction> turn_{this, "turn", &Server::OnGoal};
};
class Talker : public Node {
  Output<Word> word_{this, "word", Latch::kYes};
};
class FaultReader : public Node {
  Status OnFault(const Message<Fault>&) { return {}; }
  Input<Fault> faults_{this, "faults", &FaultReader::OnFault, Need::kOptional, Writers::kMany};
};
class TwinPorts : public Node {
  Output<Number> a_{this, "out"};
  Output<Number> b_{this, "out"};
};
struct FalseNumber {};
}  // namespace

template <>
struct Wire<FalseNumber> {
  static constexpr std::string_view kName = "Number";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const FalseNumber&, WireWriter&) {}
  static FalseNumber Decode(WireReader&) { return {}; }
};

namespace {
class Impostor : public Node {
  Output<FalseNumber> out_{this, "out"};
};
class Throwing : public Node {
 public:
  Throwing() { throw std::runtime_error("no such device"); }
};

NodeRegistry NodesToConnect() {
  NodeRegistry registry = BasicNodes();
  static Seen seen;
  AddSink(registry, seen);
  registry.Add<AnyAsker<NumberAction>>("asker");
  registry.Add<AnyAsker<WordAction>>("word-asker");
  registry.Add<Server>("server");
  registry.Add<Talker>("talker");
  registry.Add<FaultReader>("fault-reader");
  registry.Add<TwinPorts>("twin-ports");
  registry.Add<Impostor>("impostor");
  registry.Add<Throwing>("throwing");
  registry.Add("nothing", [] { return std::unique_ptr<Node>(); });
  return registry;
}

// Lines: 1 graph, 2 executor, 3 nodes, then one per node, connections, one per connection.
std::string Config(const std::vector<std::string>& nodes,
                   const std::vector<std::string>& connections, const std::string& rest = "") {
  std::string yaml = "graph:\n  executor: virtual\n  nodes:\n";
  for (const std::string& node : nodes) yaml += "    " + node + "\n";
  yaml += connections.empty() ? "  connections: []\n" : "  connections:\n";
  for (const std::string& connection : connections) yaml += "    - {" + connection + "}\n";
  return yaml + rest;
}
std::string Refusal(const std::vector<std::string>& nodes,
                    const std::vector<std::string>& connections, const std::string& rest = "") {
  return ErrorOf(BuildFrom(Config(nodes, connections, rest), NodesToConnect()));
}
const std::string kCounter = "count: {type: counter, params: {count: 1}}";
const std::string kDoubler = "twice: {type: doubler}";

TEST(Connect, RefusesAnUnknownNodeType) {
  EXPECT_EQ(Refusal({"count: {type: conter}"}, {}),
            "test.yaml:4: graph/nodes/count: there is no node type \"conter\", allowed are asker, "
            "counter, doubler, fault-reader, impostor, nothing, server, sink, talker, throwing, "
            "twin-ports, word-asker (did you mean \"counter\"?)");
}

TEST(Connect, RefusesUnknownEnds) {
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: cuont.number, to: twice.in, policy: block"}),
            "test.yaml:7: graph/connections/0/from: \"cuont.number\": there is no node \"cuont\", "
            "allowed are count, twice (did you mean \"count\"?)");
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: count.numbr, to: twice.in, policy: block"}),
            "test.yaml:7: graph/connections/0/from: \"count.numbr\": count (counter) has no output "
            "\"numbr\", allowed are fault, number (did you mean \"number\"?)");
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: count.number, to: twice.input, policy: block"}),
            "test.yaml:7: graph/connections/0/to: \"twice.input\": twice (doubler) has no input "
            "\"input\", allowed are in");
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: twice.in, to: count.number, policy: block"}),
            "test.yaml:7: graph/connections/0/from: \"twice.in\": twice (doubler) has no output "
            "\"in\", allowed are fault, out");
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: count, to: twice.in, policy: block"}),
            "test.yaml:7: graph/connections/0/from: \"count\", allowed is NODE.PORT");
  EXPECT_THAT(Refusal({kCounter, "r: {type: fault-reader}"},
                      {"from: \"*.falt\", to: r.faults, policy: {keep_last: 1}"}),
              HasSubstr("test.yaml:7: graph/connections/0/from: \"*.falt\": no other node has"));
}

TEST(Connect, RefusesAWrongTypeAndNamesBoth) {
  EXPECT_EQ(
      Refusal({"talk: {type: talker}", kDoubler}, {"from: talk.word, to: twice.in, policy: block"}),
      "test.yaml:7: graph/connections/0/to: talk.word carries Word v3, allowed at twice.in is "
      "Number v1");
}

TEST(Connect, RefusesASecondWriterAndNamesTheFirst) {
  EXPECT_EQ(Refusal({kCounter, "more: {type: counter, params: {count: 1}}", kDoubler},
                    {"from: count.number, to: twice.in, policy: block",
                     "from: more.number, to: twice.in, policy: block"}),
            "test.yaml:9: graph/connections/1/to: twice.in has a second writer, allowed is one; "
            "the first "
            "is count.number at test.yaml:8: graph/connections/0/from");
}

TEST(Connect, RefusesARequiredInputWithoutConnection) {
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {}),
            "test.yaml:5: graph/nodes/twice: the input twice.in (Number v1) has no connection, "
            "allowed is one; outputs of that type: count.number, twice.out");
}

TEST(Connect, RefusesAMissingPolicyAndABlockingFault) {
  EXPECT_EQ(Refusal({kCounter, kDoubler}, {"from: count.number, to: twice.in"}),
            "test.yaml:7: graph/connections/0/policy: missing, allowed is block or {keep_last: N} "
            "with N from 1 to 65536");
  EXPECT_THAT(Refusal({kCounter, "r: {type: fault-reader}"},
                      {"from: count.fault, to: r.faults, policy: block"}),
              HasSubstr("test.yaml:7: graph/connections/0/policy: block, allowed from a port "
                        "\"fault\" is {keep_last: N}"));
}

TEST(Connect, RefusesTheSameConnectionTwice) {
  EXPECT_EQ(
      Refusal({kCounter, "r: {type: fault-reader}"},
              {"from: count.fault, to: r.faults, policy: {keep_last: 1}",
               "from: \"*.fault\", to: r.faults, policy: {keep_last: 1}"}),
      "test.yaml:8: graph/connections/1/to: count.fault to r.faults is connected twice, first "
      "at test.yaml:7: graph/connections/0/from");
}

TEST(Connect, RefusesACycleOfBlockOnlyAndDrawsIt) {
  const std::vector<std::string> nodes = {"a: {type: doubler}", "b: {type: doubler}",
                                          "c: {type: doubler}"};
  const std::string ring = Refusal(
      nodes, {"from: a.out, to: b.in, policy: block", "from: b.out, to: c.in, policy: block",
              "from: c.out, to: a.in, policy: block"});
  EXPECT_EQ(
      ring,
      "test.yaml:8: graph/connections/0/from: the cycle a -> b -> c -> a has the policy block "
      "on every connection and can stand still for ever, allowed is a cycle with {keep_last: "
      "N} on at least one");
  EXPECT_EQ(Refusal(nodes, {"from: a.out, to: b.in, policy: block",
                            "from: b.out, to: c.in, policy: {keep_last: 1}",
                            "from: c.out, to: a.in, policy: block"}),
            "");
  EXPECT_THAT(Refusal({"a: {type: doubler}"}, {"from: a.out, to: a.in, policy: block"}),
              HasSubstr("the cycle a -> a has"));
}

TEST(Connect, ActionsGoFromClientToServerOnceWithoutAPolicy) {
  const std::vector<std::string> nodes = {"ask: {type: asker}", "serve: {type: server}"};
  EXPECT_EQ(Refusal(nodes, {"from: ask.turn, to: serve.turn"}), "");
  EXPECT_EQ(Refusal(nodes, {}),
            "test.yaml:4: graph/nodes/ask: the action ask.turn has no server, allowed is one");
  EXPECT_EQ(
      Refusal(nodes, {"from: ask.turn, to: serve.turn, policy: block"}),
      "test.yaml:7: graph/connections/0/policy: an action has no policy, allowed is none: its "
      "queues never block");
  EXPECT_THAT(Refusal(nodes, {"from: serve.turn, to: ask.turn"}),
              HasSubstr("\"serve.turn\": serve (server) has no output \"turn\""));
  EXPECT_THAT(Refusal({"ask: {type: asker}", "serve: {type: server}", "more: {type: asker}"},
                      {"from: ask.turn, to: serve.turn", "from: more.turn, to: serve.turn"}),
              HasSubstr("test.yaml:9: graph/connections/1/to: serve.turn has a second client, "
                        "allowed is one; the first is ask at test.yaml:8"));
  EXPECT_THAT(Refusal({"ask: {type: asker}", "serve: {type: server}", "more: {type: server}"},
                      {"from: ask.turn, to: serve.turn", "from: ask.turn, to: more.turn"}),
              HasSubstr("test.yaml:9: graph/connections/1/from: ask.turn has a second server"));
  EXPECT_EQ(
      Refusal({"ask: {type: word-asker}", "serve: {type: server}"},
              {"from: ask.turn, to: serve.turn"}),
      "test.yaml:7: graph/connections/0/to: ask.turn asks with Word.goal v3 for Number.result "
      "v1, allowed at serve.turn is Number.goal v1 for Number.result v1");
  EXPECT_THAT(
      Refusal({kCounter, "serve: {type: server}"},
              {"from: count.number, to: serve.turn, policy: block"}),
      HasSubstr("count.number is a topic and serve.turn is an action, allowed is a topic to "
                "a topic or an action's client to its server"));
}

TEST(Connect, RefusesUnknownAndRepeatedRecords) {
  EXPECT_EQ(Refusal({kCounter}, {}, "  record: [count.nummer]\n"),
            "test.yaml:6: graph/record/0: \"count.nummer\": count (counter) has no output "
            "\"nummer\", allowed are fault, number (did you mean \"number\"?)");
  EXPECT_EQ(Refusal({kCounter}, {}, "  record:\n  - count.number\n  - count.number\n"),
            "test.yaml:8: graph/record/1: \"count.number\" stands here twice, allowed is once");
}

TEST(Connect, NamesMistakesOfANodesAuthor) {
  EXPECT_EQ(Refusal({"twin: {type: twin-ports}"}, {}),
            "test.yaml:4: graph/nodes/twin: the node type \"twin-ports\" declares the port \"out\" "
            "twice");
  EXPECT_EQ(Refusal({kCounter, "false: {type: impostor}"}, {}),
            "test.yaml:5: graph/nodes/false: the node type \"impostor\" uses a second message type "
            "named \"Number\"");
  EXPECT_EQ(Refusal({"t: {type: throwing}"}, {}),
            "test.yaml:4: graph/nodes/t: a throwing cannot be made: no such device");
  EXPECT_EQ(Refusal({"t: {type: nothing}"}, {}),
            "test.yaml:4: graph/nodes/t: a nothing cannot be made: its factory returned nothing");
}

TEST(Connect, ParamsThatANodeDoesNotAskForAreRefused) {
  auto graph = BuildFrom(Config({"count: {type: counter, params: {count: 1, perod_ms: 2}}"}, {}),
                         NodesToConnect());
  ASSERT_TRUE(graph) << ErrorOf(graph);
  EXPECT_EQ(ErrorOf(graph->Configure()),
            "test.yaml:4: graph/nodes/count/params/perod_ms: unknown key, allowed are count, "
            "period_ms (did you mean \"period_ms\"?)");
}

TEST(Connect, TapsNeedTheTopicAndItsType) {
  auto graph = BuildFrom(Config({kCounter}, {}), NodesToConnect());
  ASSERT_TRUE(graph);
  EXPECT_EQ(ErrorOf(graph->Tap<Number>("count.numbers", [](const Message<Number>&) {})),
            "there is no topic \"count.numbers\", allowed are count.fault, count.number (did you "
            "mean \"count.number\"?)");
  EXPECT_EQ(ErrorOf(graph->Tap<Word>("count.number", [](const Message<Word>&) {})),
            "count.number: carries Number v1, the tap takes Word v3");
}

TEST(Draw, ShowsPortsTypesPoliciesAndActions) {
  const std::string yaml = Config(
      {kCounter, "twice: {type: doubler, duration_ms: 2, deadline_ms: 30}", "ask: {type: asker}",
       "serve: {type: server}", "r: {type: fault-reader}"},
      {"from: count.number, to: twice.in, policy: {keep_last: 3}", "from: ask.turn, to: serve.turn",
       "from: twice.fault, to: r.faults, policy: {keep_last: 1}"},
      "  record: [twice.out]\n");
  const auto graph = BuildFrom(yaml, NodesToConnect());
  ASSERT_TRUE(graph) << ErrorOf(graph);
  const std::string text = DrawText(graph->parts());
  EXPECT_THAT(text, HasSubstr("virtual executor, seed 0"));
  EXPECT_THAT(text, HasSubstr("\ncount  (counter)  source\n  -> number    Number v1\n"));
  EXPECT_THAT(text, HasSubstr("\ntwice  (doubler)  takes 2 ms  deadline 30 ms\n"
                              "  <- in        Number v1  from count.number, keep_last 3\n"
                              "  -> fault     Fault v1\n"
                              "  -> out       Number v1  recorded\n"));
  EXPECT_THAT(text, HasSubstr("ask  (asker)\n  => turn      asks serve with Number.goal v1\n"));
  EXPECT_THAT(text, HasSubstr("serve  (server)\n  => turn      serves Number.goal v1\n"));
  const std::string dot = DrawDot(graph->parts());
  EXPECT_THAT(dot, HasSubstr("\"count\" [label=\"count\\ncounter\", shape=box];"));
  EXPECT_THAT(dot, HasSubstr("\"count\" -> \"twice\" [label=\"number\\nkeep_last 3\"];"));
  EXPECT_THAT(dot, HasSubstr("\"ask\" -> \"serve\" [label=\"turn\", style=dashed"));
  EXPECT_THAT(dot, testing::Not(HasSubstr("\"serve\" -> \"ask\"")));
}

}  // namespace
}  // namespace turnlight::nodes::graph
