// Zaber's ASCII protocol (firmware 6 and 7) as a pure machine.
//
// One command is outstanding at a time; each carries a message id and a checksum, and only a reply
// with its id answers it. A device that sends no ids at all is accepted: then a command waits for
// the answer that is still due. Arrival is IDLE, no flag against it, and a position at the target,
// all asked for after the device has taken the move.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rig/serial/line_protocol.h"
#include "rig/serial/zaber/zaber_message.h"
#include "rig/serial/zaber/zaber_stage.h"

namespace turnlight::rig::serial::zaber {

class ZaberProtocol final : public LineProtocol {
 public:
  explicit ZaberProtocol(const ZaberOptions& options);

  void Home() override;
  void MoveTo(double position_deg) override;
  void Halt() override;

 private:
  enum class Ask { kHello, kSetting, kStatus, kPosition, kWarnings, kClear, kHome, kMove, kStop };
  enum class Goal { kIdentify, kRest, kHome, kMove, kStop };
  struct Request {
    Ask ask = Ask::kHello;
    int axis = 0;
    std::string text;
    std::vector<int> ids;  // of each time that it was sent
    DeviceTime asked{};    // when it was sent first
  };

  void Begin() override;
  void HandleLine(const std::string& line) override;
  void HandleTime() override;

  // Commands.
  void StartCommand(Goal goal, bool clear);
  void SendCommand();
  void SendCommandAgain();

  // Requests.
  void Send(Ask ask, int axis, std::string text);
  void Transmit();
  void Poll();
  void PollLater(DeviceTime asked);
  void HandleSilence();
  bool Answers(const Message& message) const;

  // Answers.
  void HandleInfo(const Message& info);
  void HandleReply(const Message& reply);
  void HandleAnswer(const Request& request, const Message& reply);
  void HandleSetting(const Message& reply);
  void NextSetting();
  void HandleTaken(const Request& request, const Message& reply);
  void HandleStatus(const Request& request, const Message& reply);
  void HandlePosition(const Request& request, const Message& reply);
  void HandleWarnings(const Message& reply);
  void HandleCleared();
  void Stands();

  // False if the flag is a fault; it is set then.
  bool Judge(std::string_view flag, bool busy);
  void SetFault(TableMotion motion, std::string text, bool busy);
  void ReportFault(DeviceTime asked);

  const ZaberOptions options_;

  Goal goal_ = Goal::kIdentify;
  std::size_t setting_ = 0;
  bool other_name_ = false;
  SettingValues values_;
  double microsteps_per_deg_ = 1.0;

  std::optional<Request> request_;
  int next_id_ = 0;
  bool ids_seen_ = false;
  std::optional<int> other_device_;  // that spoke on the chain
  std::optional<Message> partial_;   // a reply whose rest is to follow

  double position_deg_ = 0.0;
  DeviceTime position_asked_{};
  bool busy_ = false;
  bool reference_missing_ = false;  // in the last proof
  bool referenced_ = false;         // the device has had a reference since the link was opened
  bool must_home_ = false;
  TableMotion fault_motion_ = TableMotion::kIdle;
  std::string fault_;            // stays until the next command
  std::set<std::string> noted_;  // flags that were told

  // The command under way.
  long long target_ = 0;  // microsteps
  std::vector<int> command_ids_;
  bool sent_ = false, deferred_ = false, clear_first_ = false, taken_ = false, sent_again_ = false;
  bool was_busy_ = false;
  bool own_interrupt_ = false;  // this driver broke off a move: the flag NI says no more than that
  std::optional<DeviceTime> astray_since_;
};

}  // namespace turnlight::rig::serial::zaber
