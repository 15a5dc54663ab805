// Newport's SMC100 and CONEX controllers as a pure machine.
//
// Replies carry neither number nor checksum, and what is set is not answered. So after everything
// that is set TE is asked, which says whether it was taken; and bad news, and the good news that
// the stage has arrived, count when two replies say the same: ready, then a position at the target,
// then ready again, all asked for after the move was taken.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "base/strict_object.h"
#include "rig/serial/line_protocol.h"
#include "rig/serial/smc100/smc100_message.h"

namespace turnlight::rig::serial::smc100 {

struct Smc100Options {
  int address = 1;  // of the controller, 1 to 31
};

// Reads the key `address`; refusals are the reader's.
Smc100Options ReadSmc100Options(StrictObject& keys);

class Smc100Protocol final : public LineProtocol {
 public:
  explicit Smc100Protocol(const Smc100Options& options);

  void Home() override;
  void MoveTo(double position_deg) override;
  void Halt() override;

 private:
  enum class Goal { kIdentify, kRest, kHome, kMove, kStop };
  // What has been set and waits for TE.
  enum class Act { kNone, kEnable, kSearch, kMove, kStop };
  struct Query {
    std::string command;  // "TS", "SL?", "TBG"
    int tries = 0;
    DeviceTime asked{};
  };

  void Begin() override;
  void HandleLine(const std::string& line) override;
  void HandleTime() override;

  // Queries.
  void Ask(const std::string& command);
  void Transmit();
  void HandleSilence();
  void PollLater(DeviceTime asked);

  // Identification.
  void HandleFact(const Reply& reply);
  void NextFact();
  void FinishIdentification();

  // Commands.
  void StartCommand(Goal goal);
  void Set(Act act, const std::string& command);
  void Advance(unsigned state);
  void AdvanceReady();
  void Reset();
  void HandleVerdict(const std::string& value);
  void HandleRefusal(const std::string& words);

  // States.
  void HandleState(const ControllerState& state, DeviceTime asked);
  void HandleGoing(DeviceTime asked);
  void HandleReady(DeviceTime asked);
  void HandleTrouble(unsigned state, DeviceTime asked);
  void HandlePosition(const std::string& value, DeviceTime asked);
  void Arrive();
  void SetFault(TableMotion motion, std::string text);
  void ReportFault(DeviceTime asked);

  const Smc100Options options_;

  Goal goal_ = Goal::kIdentify;
  std::size_t fact_ = 0;
  StageIdentified identified_;
  std::optional<Query> query_;
  std::optional<int> other_address_;  // that spoke on the chain

  unsigned state_ = 0;                        // the last one
  std::optional<unsigned> doubtful_;          // bad news that waits for its second reply
  bool ready_before_ = false;                 // TS said so last time
  std::optional<DeviceTime> position_asked_;  // of a position since then
  double position_deg_ = 0.0;
  bool referenced_ = false;
  bool in_doubt_ = false;  // the reference is to be searched again, whatever the state says
  TableMotion fault_motion_ = TableMotion::kIdle;
  std::string fault_;  // stays until the next command
  std::set<std::string> noted_;

  // The command under way.
  Act act_ = Act::kNone;
  std::string set_command_;  // last
  char refusal_ = '\0';      // whose words are asked for
  double target_deg_ = 0.0;
  bool taken_ = false, sent_again_ = false, was_going_ = false, to_zero_ = false;
  bool enabled_ = false, reset_ = false;
  DeviceTime taken_at_{}, stopped_at_{};
  std::optional<DeviceTime> astray_since_, resetting_since_;
};

}  // namespace turnlight::rig::serial::smc100
