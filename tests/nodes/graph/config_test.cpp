// Proves that the key "graph" is read strictly: every refusal names the file, the line, the key,
// the value and what is allowed. Does not prove what the graph does with it.
#include "nodes/graph/config.h"

#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string Refusal(const std::string& yaml) { return ErrorOf(ParseGraphConfig(yaml, "rig.yaml")); }

const std::string kGood = R"(# a comment
graph:
  executor: wall
  seed: 7
  nodes:
    zebra: {type: counter, params: {count: 3}}
    ant: {type: doubler, duration_ms: 1.5, deadline_ms: 20}
  connections:
    - {from: zebra.number, to: ant.in, policy: block, capacity: 4}
    - {from: ant.out, to: zebra.x, policy: {keep_last: 2}}
    - {from: ant.act, to: zebra.act}
    - {from: ant.b, to: zebra.b, policy: block}
  record: [zebra.number, ant.out]
)";

std::string Replaced(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(GraphConfig, ReadsAllThereIs) {
  const auto config = ParseGraphConfig(kGood, "rig.yaml");
  ASSERT_TRUE(config) << ErrorOf(config);
  EXPECT_EQ(config->executor, ExecutorKind::kWall);
  EXPECT_EQ(config->seed, 7u);
  ASSERT_EQ(config->nodes.size(), 2u);
  EXPECT_EQ(config->nodes[0].name, "zebra") << "the order of the file, not of the alphabet";
  EXPECT_EQ(config->nodes[0].duration, Duration(1));
  EXPECT_EQ(config->nodes[1].duration, FromMs(1.5));
  EXPECT_EQ(config->nodes[1].deadline, FromMs(20));
  ASSERT_EQ(config->connections.size(), 4u);
  EXPECT_TRUE(config->connections[0].policy->block());
  EXPECT_EQ(config->connections[0].policy->capacity, 4u);
  EXPECT_FALSE(config->connections[1].policy->block());
  EXPECT_EQ(config->connections[1].policy->capacity, 2u);
  EXPECT_FALSE(config->connections[2].policy);
  EXPECT_EQ(config->connections[3].policy->capacity, 8u);
  ASSERT_EQ(config->record.size(), 2u);
  EXPECT_EQ(config->record[1].topic, "ant.out");
}

TEST(GraphConfig, HashIgnoresCommentsAndLayoutButNotMeaningOrOrder) {
  const auto hash = [](const std::string& yaml) { return ParseGraphConfig(yaml, "a")->hash; };
  EXPECT_EQ(hash(kGood), hash(Replaced("# a comment", "# another\n\n")));
  EXPECT_NE(hash(kGood), hash(Replaced("count: 3", "count: 4")));
  EXPECT_NE(hash(kGood),
            hash(Replaced("    zebra: {type: counter, params: {count: 3}}\n"
                          "    ant: {type: doubler, duration_ms: 1.5, deadline_ms: 20}\n",
                          "    ant: {type: doubler, duration_ms: 1.5, deadline_ms: 20}\n"
                          "    zebra: {type: counter, params: {count: 3}}\n")));
}

TEST(GraphConfig, RefusesWithPlaceValueAndAllowed) {
  EXPECT_THAT(Refusal("a: 1\n"), StartsWith("rig.yaml:1: graph: this key is missing"));
  EXPECT_EQ(Refusal(kGood + "grap: 1\n"),
            "rig.yaml:14: grap: unknown key, allowed are graph (did you mean \"graph\"?)");
  EXPECT_EQ(Refusal(Replaced("executor: wall", "executor: warp")),
            "rig.yaml:3: graph/executor: \"warp\", allowed is one of virtual, wall");
  EXPECT_EQ(Refusal(Replaced("seed: 7", "seed: -1")),
            "rig.yaml:4: graph/seed: -1, allowed is a whole number from 0 to 9223372036854775807");
  EXPECT_EQ(
      Refusal(Replaced("seed: 7", "sead: 7")),
      "rig.yaml:4: graph/sead: unknown key, allowed are connections, executor, nodes, record, "
      "seed (did you mean \"seed\"?)");
  EXPECT_THAT(Refusal("graph: {executor: wall}\n"),
              StartsWith("rig.yaml:1: graph/nodes: this key is missing"));
  EXPECT_EQ(Refusal("graph:\n  executor: wall\n  nodes: {}\n"),
            "rig.yaml:3: graph/nodes: no node, allowed is at least one");
  EXPECT_EQ(Refusal("graph:\n  executor: wall\n  nodes: [1]\n"),
            "rig.yaml:3: graph/nodes: [1], allowed is an object of keys and values");
}

TEST(GraphConfig, RefusesWrongNodes) {
  EXPECT_EQ(Refusal(Replaced("zebra: {", "ze.bra: {")),
            "rig.yaml:6: graph/nodes/ze.bra: \"ze.bra\", allowed in a node's name are letters, "
            "digits, _ and -");
  EXPECT_EQ(Refusal(Replaced("type: counter, ", "")),
            "rig.yaml:6: graph/nodes/zebra/type: this key is missing, allowed is a text");
  EXPECT_THAT(Refusal(Replaced("duration_ms: 1.5", "duraton_ms: 1.5")),
              HasSubstr("rig.yaml:7: graph/nodes/ant/duraton_ms: unknown key, allowed are "
                        "deadline_ms, duration_ms, params, type (did you mean \"duration_ms\"?)"));
  EXPECT_THAT(Refusal(Replaced("duration_ms: 1.5", "duration_ms: -1")),
              StartsWith("rig.yaml:7: graph/nodes/ant/duration_ms: -1, allowed is a finite number "
                         "of at least 0"));
  EXPECT_THAT(Refusal(Replaced("deadline_ms: 20", "deadline_ms: 0")),
              StartsWith("rig.yaml:7: graph/nodes/ant/deadline_ms: 0, allowed is a finite number "
                         "above 0"));
  EXPECT_EQ(Refusal(Replaced("params: {count: 3}", "params: 3")),
            "rig.yaml:6: graph/nodes/zebra/params: 3, allowed is an object of keys and values");
}

TEST(GraphConfig, RefusesWrongConnections) {
  const std::string allowed = ", allowed is block or {keep_last: N} with N from 1 to 65536";
  EXPECT_EQ(Refusal(Replaced("policy: block, capacity: 4", "policy: drop")),
            "rig.yaml:9: graph/connections/0/policy: \"drop\"" + allowed);
  EXPECT_EQ(Refusal(Replaced("{keep_last: 2}", "{keep_last: 0}")),
            "rig.yaml:10: graph/connections/1/policy: {\"keep_last\":0}" + allowed);
  EXPECT_EQ(Refusal(Replaced("{keep_last: 2}", "{keep_first: 2}")),
            "rig.yaml:10: graph/connections/1/policy: {\"keep_first\":2}" + allowed);
  EXPECT_EQ(Refusal(Replaced("{keep_last: 2}", "{keep_last: 2}, capacity: 2")),
            "rig.yaml:10: graph/connections/1/capacity: the capacity of keep_last is its number");
  EXPECT_EQ(Refusal(Replaced("ant.act, to: zebra.act", "ant.act, to: zebra.act, capacity: 1")),
            "rig.yaml:11: graph/connections/2/capacity: a capacity goes with policy: block");
  EXPECT_THAT(Refusal(Replaced("policy: block, capacity: 4", "polcy: block, capacity: 4")),
              AllOf(StartsWith("rig.yaml:9: graph/connections/0/polcy: unknown key"),
                    HasSubstr("did you mean \"policy\"?")));
  EXPECT_EQ(Refusal(Replaced("capacity: 4", "capacity: 0")),
            "rig.yaml:9: graph/connections/0/capacity: 0, allowed is a whole number from 1 to "
            "65536");
  EXPECT_EQ(Refusal(Replaced("from: zebra.number, ", "")),
            "rig.yaml:9: graph/connections/0/from: this key is missing, allowed is a text");
  EXPECT_THAT(Refusal(Replaced("to: ant.in", "two: ant.in, to: ant.in")),
              StartsWith("rig.yaml:9: graph/connections/0/two: unknown key, allowed are"));
  EXPECT_THAT(Refusal(Replaced("record: [zebra.number, ant.out]", "record: ant.out")),
              StartsWith("rig.yaml:13: graph/record: \"ant.out\", allowed is a list of topics"));
  EXPECT_THAT(Refusal(Replaced("record: [zebra.number, ant.out]", "record: [3]")),
              StartsWith("rig.yaml:13: graph/record: [3], allowed is a list of topics"));
}

TEST(GraphConfig, LoadsFromAFileAndNamesAMissingOne) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(LoadGraphConfig(folder / "none.yaml")), HasSubstr("none.yaml"));
}

}  // namespace
}  // namespace turnlight::nodes::graph
