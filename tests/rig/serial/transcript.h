// A conversation with a stage's controller written down as text, and played to a protocol with
// every way of splitting what is received. A script is a list of lines, without regard to spaces
// before them:
//
//   > text          the protocol has sent this line next
//   < text          this line arrives, with CR LF at its end; several in a row may come in one read
//   + 20            so many milliseconds pass
//   ! connect       a call: connect, home, move DEGREES, halt
//   = idle 10       an event: idle, moving, unhomed, fault with a position or without;
//   = fault 'FS'    ... in quotes: what its text holds; failed, for-good, note, identified likewise
//   .               nothing was sent that was not written down, and nothing happened
//   # text          a remark
//
// A moving report needs no line. The end of a script is a full stop.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "rig/serial/stage_protocol.h"

namespace turnlight::rig::serial {

struct Conversation {
  std::unique_ptr<StageProtocol> protocol;
  // What is sent, without its end, as the script writes it: a number that counts up may become a
  // sign.
  std::function<std::string(const std::string&)> sent = [](const std::string& line) {
    return line;
  };
  // What the script says arrives, as it really does.
  std::function<std::string(const std::string&)> received = [](const std::string& line) {
    return line;
  };
};

// Empty if the protocol keeps to the script however its replies are split; else where it does not.
std::string PlayTranscript(const std::function<Conversation()>& begin, std::string_view script);

// A report in words, "idle 10.000", and another event likewise, "note 'text'".
std::string EventInWords(const StageEvent& event);

}  // namespace turnlight::rig::serial
