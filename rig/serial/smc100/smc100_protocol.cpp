// Identification, queries and commands. What the states lead to is in smc100_states.cpp.
#include "rig/serial/smc100/smc100_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial::smc100 {
namespace {

constexpr std::size_t kLongestReply = 256;
// A query takes about 10 ms; a hub, a chain and a busy machine add to it.
constexpr DeviceTime kReplyWait = std::chrono::milliseconds(500);
constexpr int kTries = 4;
// What not every controller has.
constexpr int kTriesOfFact = 2;
// Two queries at 57600 baud and 10 ms each.
constexpr DeviceTime kPollPeriod = std::chrono::milliseconds(25);
constexpr DeviceTime kPollGap = std::chrono::milliseconds(2);
constexpr DeviceTime kResetWait = std::chrono::seconds(10);
// From the enabling of the motor to a state that shows it.
constexpr DeviceTime kEnableWait = std::chrono::seconds(2);
// Of the digits that PA is given.
constexpr double kFinestDeg = 1e-5;
constexpr double kFarthestDeg = 1e9;
// READY T of CONEX-CC (tracking is on), READY from STEPPING of CONEX-AGP.
constexpr unsigned kFirstOtherReady = 0x36, kLastOtherReady = 0x38;

// Asked in this order; TE last, to forget what these may have been refused with.
constexpr std::array<std::string_view, 9> kFacts = {"VE",  "TS",  "ID?", "SL?", "SR?",
                                                    "VA?", "AC?", "SU?", "TE"};

std::string UpperText(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char byte) {
    return byte >= 'a' && byte <= 'z' ? static_cast<char>(byte - 'a' + 'A') : byte;
  });
  return text;
}

}  // namespace

Smc100Options ReadSmc100Options(StrictObject& keys) {
  Smc100Options options;
  if (const auto address = keys.OptionalInteger("address", 1, 31))
    options.address = static_cast<int>(*address);
  return options;
}

Smc100Protocol::Smc100Protocol(const Smc100Options& options)
    : LineProtocol(kLongestReply), options_(options) {}

void Smc100Protocol::Begin() {
  goal_ = Goal::kIdentify;
  fact_ = 0;
  identified_ = {};
  identified_.identity.vendor = "Newport";
  identified_.traits.resolution_deg = kFinestDeg;
  other_address_.reset();
  doubtful_.reset();
  ready_before_ = referenced_ = in_doubt_ = false;
  fault_.clear();
  noted_.clear();
  StartCommand(Goal::kIdentify);
  Ask(std::string(kFacts[fact_]));
}

void Smc100Protocol::Ask(const std::string& command) {
  query_ = Query{command, 0, now()};
  Transmit();
}

void Smc100Protocol::Transmit() {
  ++query_->tries;
  Write(Format("%d%s\r\n", options_.address, query_->command.c_str()));
  WakeIn(kReplyWait);
}

void Smc100Protocol::PollLater(DeviceTime asked) {
  if (!query_) WakeIn(std::max(kPollPeriod - (now() - asked), kPollGap));
}

void Smc100Protocol::HandleTime() {
  if (query_) return HandleSilence();
  // At rest the position is read between two states; on the way the state is enough.
  if (goal_ != Goal::kIdentify) Ask(ready_before_ ? "TP" : "TS");
}

void Smc100Protocol::HandleSilence() {
  const bool first = goal_ == Goal::kIdentify && fact_ == 0;
  if (first && query_->tries > 1 && !last_bad_line().empty())
    return Fail("what answers is no SMC100 or CONEX: " + last_bad_line(), true);
  if (goal_ == Goal::kIdentify && query_->command.ends_with('?')) {
    if (query_->tries < kTriesOfFact) return Transmit();
    Note("the controller does not answer to " + query_->command);
    return NextFact();
  }
  if (refusal_ != '\0' && query_->tries >= kTriesOfFact)
    return HandleRefusal(CommandErrorInWords(refusal_));
  if (resetting_since_ && now() - *resetting_since_ < kResetWait) return Transmit();
  if (query_->tries < kTries) return Transmit();
  const std::string who = Format("the controller at address %d", options_.address);
  if (first && other_address_)
    return Fail(Format("%s does not answer, one at %d does: see the key address", who.c_str(),
                       *other_address_),
                true);
  const double silence_s = std::chrono::duration<double>(now() - query_->asked).count();
  Fail(Format("%s does not answer to %s for %.1f s", who.c_str(), query_->command.c_str(),
              silence_s),
       false);
}

void Smc100Protocol::HandleLine(const std::string& line) {
  const auto reply = ParseReply(line);
  if (!reply) return BadLine(line);
  if (reply->address != options_.address) {
    other_address_ = reply->address;
    return;
  }
  // A late one, or an echo of what was sent.
  if (!query_ || query_->command.substr(0, 2) != reply->command) return;
  if (reply->value.empty() || reply->value == "?") return;
  const DeviceTime asked = query_->asked;
  if (goal_ == Goal::kIdentify) return HandleFact(*reply);
  if (reply->command == "TB") {
    // "G Displacement out of limits."
    query_.reset();
    return HandleRefusal(reply->value);
  }
  if (reply->command == "TE") return HandleVerdict(reply->value);
  if (reply->command == "TP") return HandlePosition(reply->value, asked);
  const auto state = ParseState(reply->value);
  if (!state) return BadLine(line);
  query_.reset();
  HandleState(*state, asked);
  if (!over()) PollLater(asked);
}

void Smc100Protocol::HandleFact(const Reply& reply) {
  StageTraits& traits = identified_.traits;
  const std::string_view fact = kFacts[fact_];
  const auto number = ParseValue(reply.value);
  if (fact == "VE") {
    const std::string upper = UpperText(reply.value);
    if (upper.find("SMC") == upper.npos && upper.find("CONEX") == upper.npos)
      return Fail("this is no SMC100 or CONEX, but '" + reply.value + "'", true);
    identified_.identity.model = reply.value;
  } else if (fact == "TS") {
    const auto state = ParseState(reply.value);
    if (!state) return BadLine(reply.value);
    if (KindOf(state->state) == StateKind::kConfiguration)
      return Fail(
          "the controller is in state CONFIGURATION, where it does not move: leave it "
          "with PW0",
          true);
    state_ = state->state;
  } else if (fact == "ID?") {
    if (IsLinearStage(reply.value))
      return Fail("'" + reply.value + "' is a linear stage, not one that turns", true);
    identified_.identity.model += ", stage " + reply.value;
  } else if (fact != "TE" && !number) {
    return BadLine(reply.value);
  }
  if (fact == "SL?") traits.min_deg = number;
  if (fact == "SR?") traits.max_deg = number;
  if (fact == "VA?" && *number > 0.0) traits.max_speed_deg_s = number;
  if (fact == "AC?" && *number > 0.0) traits.acceleration_deg_s2 = number;
  if (fact == "SU?") traits.resolution_deg = std::max(*number, kFinestDeg);
  NextFact();
}

void Smc100Protocol::NextFact() {
  if (++fact_ < kFacts.size()) return Ask(std::string(kFacts[fact_]));
  query_.reset();
  FinishIdentification();
}

void Smc100Protocol::FinishIdentification() {
  const StageTraits& traits = identified_.traits;
  if (traits.min_deg && traits.max_deg && !(*traits.min_deg < *traits.max_deg))
    return Fail("the controller's limits make no sense: SL " + NumberText(*traits.min_deg) +
                    ", SR " + NumberText(*traits.max_deg),
                true);
  goal_ = Goal::kRest;
  Tell(identified_);
  Ask("TS");
}

void Smc100Protocol::Home() {
  if (over() || goal_ == Goal::kIdentify) return;
  StartCommand(Goal::kHome);
  Advance(state_);
}

void Smc100Protocol::MoveTo(double position_deg) {
  if (over() || goal_ == Goal::kIdentify) return;
  StartCommand(Goal::kMove);
  if (!(std::abs(position_deg) <= kFarthestDeg))
    return SetFault(TableMotion::kFault, NumberText(position_deg) + " degrees are no position");
  target_deg_ = position_deg;
  Advance(state_);
}

void Smc100Protocol::Halt() {
  if (over() || goal_ == Goal::kIdentify) return;
  const std::string fault = std::move(fault_);
  StartCommand(Goal::kStop);
  fault_ = fault;
  stopped_at_ = now();
  Set(Act::kStop, "ST");
}

void Smc100Protocol::StartCommand(Goal goal) {
  goal_ = goal;
  fault_.clear();
  act_ = Act::kNone;
  refusal_ = '\0';
  taken_ = sent_again_ = was_going_ = to_zero_ = enabled_ = reset_ = false;
  ready_before_ = false;
  position_asked_.reset();
  astray_since_.reset();
  resetting_since_.reset();
}

void Smc100Protocol::Set(Act act, const std::string& command) {
  act_ = act;
  set_command_ = command;
  Write(Format("%d%s\r\n", options_.address, command.c_str()));
  Ask("TE");
}

// The next step towards a goal that has not been taken yet, from this state.
void Smc100Protocol::Advance(unsigned state) {
  switch (KindOf(state)) {
    case StateKind::kReady:
      return AdvanceReady();
    case StateKind::kMoving:
    case StateKind::kHoming:
      if (goal_ == Goal::kHome && KindOf(state) == StateKind::kHoming) {
        taken_ = was_going_ = true;
        taken_at_ = now();
        return Ask("TS");
      }
      stopped_at_ = now();
      return Set(Act::kStop, "ST");
    case StateKind::kDisabled:
      if (!std::exchange(enabled_, true)) return Set(Act::kEnable, "MM1");
      if (now() - taken_at_ < kEnableWait) return;
      break;
    case StateKind::kUnreferenced:
      if (goal_ == Goal::kHome) return Set(Act::kSearch, "OR");
      SetFault(TableMotion::kUnhomed, StateInWords(state) + ": home it first");
      return Ask("TS");
    case StateKind::kOther:
      // Ready in its own way: whether it moves from there TE will say.
      if (state >= kFirstOtherReady && state <= kLastOtherReady) return AdvanceReady();
      break;
    case StateKind::kConfiguration:
      break;
  }
  SetFault(TableMotion::kFault, "it cannot move in state " + StateInWords(state));
  Ask("TS");
}

void Smc100Protocol::AdvanceReady() {
  if (goal_ == Goal::kHome) {
    // OR is not allowed here: a reference that is good is gone to, another one is lost first.
    if (in_doubt_ && !reset_) return Reset();
    to_zero_ = true;
    target_deg_ = 0.0;
  }
  Set(Act::kMove, "PA" + FormatAngle(target_deg_));
}

void Smc100Protocol::Reset() {
  Note("the position is in doubt: the controller is reset to search its reference again");
  reset_ = true;
  resetting_since_ = now();
  Write(Format("%dRS\r\n", options_.address));
  query_.reset();
  WakeIn(kReplyWait);
}

void Smc100Protocol::HandleVerdict(const std::string& value) {
  const Act act = std::exchange(act_, Act::kNone);
  const char code = value.front();
  query_.reset();
  if (act == Act::kStop || code == '@' || code == '0' || (act == Act::kSearch && code == 'E')) {
    taken_ = taken_ || act == Act::kSearch || act == Act::kMove;
    taken_at_ = now();
    return Ask("TS");
  }
  // No controller of this kind refuses PA, OR or MM1 so: what came was garbled.
  const bool garbled = code == 'A' || code == 'B' || code == 'C';
  if (garbled && !std::exchange(sent_again_, true)) {
    Note("a command came garbled (TE: " + CommandErrorInWords(code) + "): sent again");
    enabled_ = false;
    return Ask("TS");
  }
  refusal_ = code;
  Ask("TB" + std::string(1, code));
}

void Smc100Protocol::HandleRefusal(const std::string& words) {
  refusal_ = '\0';
  SetFault(TableMotion::kFault, set_command_ + " is refused: " + words);
  Ask("TS");
}

}  // namespace turnlight::rig::serial::smc100
