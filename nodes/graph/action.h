// Actions: what takes time and can fail, such as a move. A client sends a goal, the server answers
// with feedback while it works and with one result. An action type groups the three messages:
//   struct Move { using Goal = MoveGoal; using Feedback = TableState; using Result = MoveResult; };
//
// Underneath are three topics (NAME.goal, NAME.feedback, NAME.result) that can be recorded and
// drawn like any other; they never block.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "nodes/graph/node.h"

namespace turnlight::nodes::graph {

using GoalId = std::uint64_t;  // 1, 2, 3, ... for each client

template <typename T>
struct ActionGoal {
  GoalId id = 0;
  Duration deadline{};  // from valid_at on; the client gives up then
  T goal;
};
template <typename T>
struct ActionFeedback {
  GoalId id = 0;
  T feedback;
};
template <typename T>
struct ActionResult {
  GoalId id = 0;
  T result;
};

// How a goal ended, for the client.
template <typename Action>
struct ActionOutcome {
  GoalId id = 0;
  // Null if the deadline passed first; a result that still comes is dropped and counted.
  std::shared_ptr<const ActionResult<typename Action::Result>> reply;
  Header header;  // of the reply

  bool deadline_passed() const { return reply == nullptr; }
  const typename Action::Result& result() const { return reply->result; }
};

template <typename Action>
class ActionClient {
 public:
  using Goal = typename Action::Goal;
  using Feedback = typename Action::Feedback;
  using Outcome = ActionOutcome<Action>;

  template <typename N>
  ActionClient(N* node, const std::string& name, Status (N::*on_outcome)(const Outcome&))
      : ActionClient(node, name, on_outcome, [](const Feedback&) { return Status(); }) {}
  template <typename N>
  ActionClient(N* node, const std::string& name, Status (N::*on_outcome)(const Outcome&),
               Status (N::*on_feedback)(const Feedback&))
      : ActionClient(node, name, on_outcome, [node, on_feedback](const Feedback& feedback) {
          return (node->*on_feedback)(feedback);
        }) {}

  // Fails if a goal is outstanding. The outcome comes within the deadline (above 0), in any case.
  Result<GoalId> Send(Goal goal, Time valid_at, Duration deadline) {
    if (outstanding_ != 0)
      return InputError("action " + end_.name + ": goal " + std::to_string(outstanding_) +
                        " is outstanding, allowed is one at a time");
    Runtime* runtime = goal_.port().node.runtime;
    if (!runtime) return InputError("action " + end_.name + ": the graph does not run");
    outstanding_ = ++last_;
    goal_.Publish(ActionGoal<Goal>{outstanding_, deadline, std::move(goal)}, valid_at);
    deadline_.due = runtime->Now() + std::max(deadline, Duration(1));
    return outstanding_;
  }
  bool active() const { return outstanding_ != 0; }

 private:
  using FeedbackMessage = ActionFeedback<Feedback>;
  using ResultMessage = ActionResult<typename Action::Result>;

  template <typename N>
  ActionClient(N* node, const std::string& name, Status (N::*on_outcome)(const Outcome&),
               std::function<Status(const Feedback&)> on_feedback)
      : on_outcome_(
            [node, on_outcome](const Outcome& outcome) { return (node->*on_outcome)(outcome); }),
        on_feedback_(std::move(on_feedback)),
        goal_(node, name + ".goal"),
        feedback_(
            node, name + ".feedback",
            [this](const Message<FeedbackMessage>& m) { return OnFeedback(m); }, Need::kOptional),
        result_(
            node, name + ".result", [this](const Message<ResultMessage>& m) { return OnResult(m); },
            Need::kOptional),
        deadline_(node->core(), name + ".deadline", true, [this](Time) { return OnDeadline(); }) {
    end_.name = name;
    end_.goal_out = &goal_.port();
    end_.feedback_in = &feedback_.port();
    end_.result_in = &result_.port();
    node->core().actions.push_back(&end_);
  }

  // True if the id is the outstanding one; else counts it.
  bool IsOutstanding(GoalId id) {
    if (id == outstanding_ && id != 0) return true;
    (id == answered_ ? end_.duplicate : end_.late).fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  Status OnFeedback(const Message<FeedbackMessage>& message) {
    return IsOutstanding(message->id) ? on_feedback_(message->feedback) : Status();
  }
  Status OnResult(const Message<ResultMessage>& message) {
    if (!IsOutstanding(message->id)) return {};
    deadline_.due = kNever;
    answered_ = std::exchange(outstanding_, 0);
    return on_outcome_({message->id, message.value, message.header});
  }
  Status OnDeadline() { return on_outcome_({std::exchange(outstanding_, 0), nullptr, {}}); }

  std::function<Status(const Outcome&)> on_outcome_;
  std::function<Status(const Feedback&)> on_feedback_;
  Output<ActionGoal<Goal>> goal_;
  Input<FeedbackMessage> feedback_;
  Input<ResultMessage> result_;
  TimerPort deadline_;
  ActionEnd end_;
  GoalId last_ = 0;
  GoalId outstanding_ = 0;  // 0: none
  GoalId answered_ = 0;
};

// A new goal takes the place of an active one (its client has given that up). Goals seen before are
// dropped and counted.
template <typename Action>
class ActionServer {
 public:
  using Goal = ActionGoal<typename Action::Goal>;

  template <typename N>
  ActionServer(N* node, const std::string& name, Status (N::*on_goal)(const Message<Goal>&))
      : on_goal_([node, on_goal](const Message<Goal>& goal) { return (node->*on_goal)(goal); }),
        goal_(
            node, name + ".goal", [this](const Message<Goal>& m) { return OnGoal(m); },
            Need::kOptional),
        feedback_(node, name + ".feedback"),
        result_(node, name + ".result") {
    end_.name = name;
    end_.goal_in = &goal_.port();
    end_.feedback_out = &feedback_.port();
    end_.result_out = &result_.port();
    node->core().actions.push_back(&end_);
  }

  // The goal being worked on; 0 if none.
  GoalId active() const { return active_; }
  // About the active goal; without one nothing is sent.
  void SendFeedback(typename Action::Feedback feedback, Time valid_at) {
    if (active_ != 0) feedback_.Publish(FeedbackMessage{active_, std::move(feedback)}, valid_at);
  }
  // Ends a goal. If id is not the active one, nothing is sent and it is counted.
  void Finish(GoalId id, typename Action::Result result, Time valid_at) {
    if (id == 0 || id != active_) {
      end_.late.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    active_ = 0;
    result_.Publish(ResultMessage{id, std::move(result)}, valid_at);
  }

 private:
  using FeedbackMessage = ActionFeedback<typename Action::Feedback>;
  using ResultMessage = ActionResult<typename Action::Result>;

  Status OnGoal(const Message<Goal>& message) {
    if (message->id <= seen_) {
      end_.duplicate.fetch_add(1, std::memory_order_relaxed);
      return {};
    }
    active_ = seen_ = message->id;
    return on_goal_(message);
  }

  std::function<Status(const Message<Goal>&)> on_goal_;
  Input<Goal> goal_;
  Output<FeedbackMessage> feedback_;
  Output<ResultMessage> result_;
  ActionEnd end_;
  GoalId seen_ = 0;
  GoalId active_ = 0;
};

template <typename T>
struct Wire<ActionGoal<T>> {
  static std::string Name() { return TypeName<T>() + ".goal"; }
  static constexpr std::uint32_t kVersion = Wire<T>::kVersion;
  static void Encode(const ActionGoal<T>& message, WireWriter& out) {
    out.U64(message.id);
    out.I64(message.deadline.count());
    Wire<T>::Encode(message.goal, out);
  }
  static ActionGoal<T> Decode(WireReader& in) {
    const GoalId id = in.U64();
    const Duration deadline(in.I64());
    return {id, deadline, Wire<T>::Decode(in)};
  }
};
template <typename T>
struct Wire<ActionFeedback<T>> {
  static std::string Name() { return TypeName<T>() + ".feedback"; }
  static constexpr std::uint32_t kVersion = Wire<T>::kVersion;
  static void Encode(const ActionFeedback<T>& message, WireWriter& out) {
    out.U64(message.id);
    Wire<T>::Encode(message.feedback, out);
  }
  static ActionFeedback<T> Decode(WireReader& in) {
    const GoalId id = in.U64();
    return {id, Wire<T>::Decode(in)};
  }
};
template <typename T>
struct Wire<ActionResult<T>> {
  static std::string Name() { return TypeName<T>() + ".result"; }
  static constexpr std::uint32_t kVersion = Wire<T>::kVersion;
  static void Encode(const ActionResult<T>& message, WireWriter& out) {
    out.U64(message.id);
    Wire<T>::Encode(message.result, out);
  }
  static ActionResult<T> Decode(WireReader& in) {
    const GoalId id = in.U64();
    return {id, Wire<T>::Decode(in)};
  }
};

}  // namespace turnlight::nodes::graph
