// The firmware of a stage's controller as a pure machine: bytes and the time in, messages out. It
// knows no port and no thread. The motor is the mock turntable's (rig/sim/mock_turntable.h): the
// firmware drives it and reports what it counts, which is not the truth.
//
// Times never go back. Pass is called often (every millisecond or two): what is due is done then.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rig/device.h"

namespace turnlight::rig::sim::stage {

// What a message is to the one who waits for it; the faults of the line choose by it.
enum class MessageKind {
  kReply,   // the answer to a command: `ok`, `error:5`, @01 1 OK ...
  kStatus,  // the answer to a question for state or position
  kPush,    // said without being asked: a banner, an alarm, an alert; more lines before an `ok`
};

struct FirmwareMessage {
  MessageKind kind = MessageKind::kPush;
  std::string bytes;  // with their ends of line
};

class StageFirmware {
 public:
  virtual ~StageFirmware() = default;
  // The supply comes on, or the board is reset by its port: everything volatile is forgotten.
  virtual void PowerOn(DeviceTime now) = 0;
  virtual void Receive(std::string_view bytes, DeviceTime now) = 0;
  virtual void Pass(DeviceTime now) = 0;

  std::vector<FirmwareMessage> TakeMessages() { return std::exchange(messages_, {}); }

 protected:
  void Say(MessageKind kind, std::string bytes) { messages_.push_back({kind, std::move(bytes)}); }

 private:
  std::vector<FirmwareMessage> messages_;
};

}  // namespace turnlight::rig::sim::stage
