// Proves that a goal ends once, by its result or its deadline, and that ids which are late,
// duplicate or of no goal are dropped and counted. Does not prove that a server does its work.
#include "nodes/graph/action.h"

#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::ElementsAre;

struct Turn {
  using Goal = Number;
  using Feedback = Number;
  using Result = Word;
};

// Sends one goal after another and writes down what comes back.
class Asker : public Node {
 public:
  struct Script {
    std::vector<double> goals;
    double deadline_ms = 100;
    std::vector<std::string> seen;
  };
  explicit Asker(Script& script) : script_(script) {}
  Status Start() override { return Next(); }

 private:
  Status Next() {
    if (sent_ == script_.goals.size()) return {};
    const auto id =
        turn_.Send(Number{script_.goals[sent_++]}, Time(0), FromMs(script_.deadline_ms));
    if (!id) return Forward(id);
    const auto second = turn_.Send(Number{0}, Time(0), FromMs(1));
    if (second) return InputError("two goals at a time");
    if (script_.seen.empty()) script_.seen.push_back(second.error().text);
    return {};
  }
  Status OnFeedback(const Number& feedback) {
    script_.seen.push_back("at " + std::to_string(static_cast<int>(feedback.value)));
    return {};
  }
  Status OnEnd(const ActionOutcome<Turn>& outcome) {
    script_.seen.push_back(
        std::to_string(outcome.id) + " " +
        (outcome.deadline_passed() ? std::string("deadline") : outcome.result().text));
    return Next();
  }

  Script& script_;
  std::size_t sent_ = 0;
  ActionClient<Turn> turn_{this, "turn", &Asker::OnEnd, &Asker::OnFeedback};
};

// Takes the goal's value in milliseconds, with feedback half-way.
class Table : public Node {
 private:
  Status OnGoal(const Message<ActionGoal<Number>>& goal) {
    id_ = goal->id;
    half_ = FromMs(goal->goal.value / 2);
    half_way_ = false;
    timer_.After(half_);
    return {};
  }
  Status OnTimer(Time now) {
    if (!half_way_) {
      half_way_ = true;
      turn_.SendFeedback(Number{ToMs(half_)}, now);
      timer_.After(half_);
      return {};
    }
    turn_.Finish(id_, Word{"done"}, now);
    turn_.Finish(id_, Word{"done again"}, now);  // counted, not sent
    return {};
  }
  GoalId id_ = 0;
  Duration half_{};
  bool half_way_ = false;
  Timer timer_{this, "timer", &Table::OnTimer};
  ActionServer<Turn> turn_{this, "turn", &Table::OnGoal};
};

const std::string kGraph = R"(
  nodes:
    asker: {type: asker}
    table: {type: table}
  connections:
    - {from: asker.turn, to: table.turn}
)";

const ActionReport& ActionOf(const RunReport& report, const std::string& end) {
  for (const ActionReport& action : report.actions)
    if (action.end == end) return action;
  ADD_FAILURE() << end;
  static const ActionReport kNone;
  return kNone;
}

TEST(Action, GoalFeedbackResultInBothExecutors) {
  for (const std::string executor : {"virtual", "wall"}) {
    Asker::Script script{{10, 20}, 5000, {}};
    NodeRegistry registry;
    registry.Add("asker", [&script] { return std::make_unique<Asker>(script); });
    registry.Add<Table>("table");
    const RunReport report = RunGraph("graph:\n  executor: " + executor + kGraph, registry);
    EXPECT_THAT(script.seen,
                ElementsAre("action turn: goal 1 is outstanding, allowed is one at a time", "at 5",
                            "1 done", "at 10", "2 done"));
    EXPECT_EQ(report.cause, StopCause::kCompleted);
    EXPECT_EQ(ActionOf(report, "table.turn").late, 2u) << "second Finish of each goal";
    EXPECT_EQ(ActionOf(report, "asker.turn").late, 0u);
    EXPECT_EQ(ActionOf(report, "asker.turn").duplicate, 0u);
  }
}

TEST(Action, TheDeadlineEndsAGoalAndANewOneTakesTheServer) {
  Asker::Script script{{500, 10}, 100, {}};
  NodeRegistry registry;
  registry.Add("asker", [&script] { return std::make_unique<Asker>(script); });
  registry.Add<Table>("table");
  const RunReport report = RunGraph("graph:\n  executor: virtual" + kGraph, registry);
  script.seen.erase(script.seen.begin());
  EXPECT_THAT(script.seen, ElementsAre("1 deadline", "at 5", "2 done"));
  EXPECT_FALSE(report.failure);
}

// A server that breaks the rules: it speaks the three topics itself.
class RogueTable : public Node {
 public:
  RogueTable() {
    end_.name = "turn";
    end_.goal_in = &goal_.port();
    end_.feedback_out = &feedback_.port();
    end_.result_out = &result_.port();
    core().actions.push_back(&end_);
  }

 private:
  Status OnGoal(const Message<ActionGoal<Number>>& goal) {
    id_ = goal->id;
    if (id_ == 1) {  // answers twice, and once for a goal that never was
      result_.Publish(ActionResult<Word>{7, {"invented"}}, Time(0));
      result_.Publish(ActionResult<Word>{1, {"good"}}, Time(0));
      result_.Publish(ActionResult<Word>{1, {"duplicate"}}, Time(0));
    } else {
      timer_.After(FromMs(150));  // later than the deadline
    }
    return {};
  }
  Status OnTimer(Time) {
    feedback_.Publish(ActionFeedback<Number>{id_, {1}}, Time(0));
    result_.Publish(ActionResult<Word>{id_, {"late"}}, Time(0));
    return {};
  }
  GoalId id_ = 0;
  Timer timer_{this, "timer", &RogueTable::OnTimer};
  Input<ActionGoal<Number>> goal_{this, "turn.goal", &RogueTable::OnGoal};
  Output<ActionFeedback<Number>> feedback_{this, "turn.feedback"};
  Output<ActionResult<Word>> result_{this, "turn.result"};
  ActionEnd end_;
};

TEST(Action, LateAndDuplicateResultsAreDroppedAndCounted) {
  Asker::Script script{{1, 2}, 100, {}};
  NodeRegistry registry;
  registry.Add("asker", [&script] { return std::make_unique<Asker>(script); });
  registry.Add<RogueTable>("table");
  const RunReport report = RunGraph("graph:\n  executor: virtual" + kGraph, registry);
  script.seen.erase(script.seen.begin());
  EXPECT_THAT(script.seen, ElementsAre("1 good", "2 deadline"));
  EXPECT_EQ(ActionOf(report, "asker.turn").duplicate, 1u);
  EXPECT_EQ(ActionOf(report, "asker.turn").late, 3u) << "invented, late feedback, late result";
}

// A client that repeats its goals.
class RogueAsker : public Node {
 public:
  RogueAsker() {
    end_.name = "turn";
    end_.goal_out = &goal_.port();
    end_.feedback_in = &feedback_.port();
    end_.result_in = &result_.port();
    core().actions.push_back(&end_);
  }
  Status Start() override {
    for (const GoalId id : {2, 2, 1})
      goal_.Publish(ActionGoal<Number>{id, FromMs(1000), {10}}, Time(0));
    return {};
  }

 private:
  Status OnFeedback(const Message<ActionFeedback<Number>>&) { return {}; }
  Status OnResult(const Message<ActionResult<Word>>&) { return {}; }
  Output<ActionGoal<Number>> goal_{this, "turn.goal"};
  Input<ActionFeedback<Number>> feedback_{this, "turn.feedback", &RogueAsker::OnFeedback};
  Input<ActionResult<Word>> result_{this, "turn.result", &RogueAsker::OnResult};
  ActionEnd end_;
};

TEST(Action, AServerDropsGoalsThatItHasSeen) {
  NodeRegistry registry;
  registry.Add<RogueAsker>("asker");
  registry.Add<Table>("table");
  const RunReport report = RunGraph("graph:\n  executor: virtual" + kGraph, registry);
  EXPECT_EQ(ActionOf(report, "table.turn").duplicate, 2u);
}

TEST(Action, MessagesSurviveTheWire) {
  std::string bytes;
  WireWriter out(bytes);
  Wire<ActionGoal<Word>>::Encode({9, FromMs(2), {"go"}}, out);
  const auto goal = DecodeMessage(TypeOf<ActionGoal<Word>>(), bytes);
  ASSERT_TRUE(goal) << ErrorOf(goal);
  const auto& typed = *static_cast<const ActionGoal<Word>*>(goal->get());
  EXPECT_EQ(typed.id, 9u);
  EXPECT_EQ(typed.deadline, FromMs(2));
  EXPECT_EQ(typed.goal.text, "go");
  EXPECT_EQ(TypeOf<ActionGoal<Word>>().name, "Word.goal");
  EXPECT_EQ(TypeOf<ActionGoal<Word>>().version, 3u);
}

}  // namespace
}  // namespace turnlight::nodes::graph
