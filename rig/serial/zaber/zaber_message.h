// The lines of Zaber's ASCII protocol (firmware 6 and 7) as values: what a device sends, parsed,
// what it is sent, put together, and its flags and rejections in words.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace turnlight::rig::serial::zaber {

enum class MessageKind { kReply, kAlert, kInfo };

struct Message {
  MessageKind kind = MessageKind::kReply;
  int device = 0, axis = 0;  // axis 0: the device as a whole
  std::optional<int> id;     // of the command that it answers
  bool rejected = false;     // replies only
  bool busy = false;         // replies and alerts
  std::string flag;          // two characters, "--" if nothing is to be said; replies and alerts
  std::string data;          // what is left; without the mark below
  bool continues = false;    // an info "cont" follows with the rest
};

// "@01 1 05 OK IDLE -- 1000:76", "!01 1 IDLE --", "#01 1 cont more". Any number of spaces, an
// optional id, an optional checksum of either case. Nothing if it is no such line or its checksum
// is wrong.
std::optional<Message> ParseMessage(std::string_view line);

// "/1 1 5 get pos:57\n"; the longest command of this driver stays far below a device's line of 80.
std::string FormatCommand(int device, int axis, int id, std::string_view command);

// The longitudinal redundancy check of what stands between a line's first character and its colon:
// added to the sum of these bytes it gives 0 modulo 256.
std::uint8_t Checksum(std::string_view content);

// What a flag means for a capture.
enum class FlagMeaning {
  kNone,       // "--"
  kNotice,     // said once, position and motion are sound
  kDisturbed,  // something else commanded or stopped the axis: what was under way is void
  kUnhomed,    // no reference, or not from homing since power-up
  kFault,      // a fault, a stall, a displacement: void, and to be homed again
};

FlagMeaning MeaningOf(std::string_view flag);
// "FS: stalled and stopped"; the flag alone if it is not in the manual.
std::string FlagInWords(std::string_view flag);
// "BADDATA: a value is missing or out of range".
std::string RejectionInWords(std::string_view reason);

}  // namespace turnlight::rig::serial::zaber
