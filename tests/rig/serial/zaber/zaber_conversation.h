// What the transcripts of Zaber's protocol begin with: a stage of 384000 microsteps a turn that was
// identified. In a script '*' stands for the message id of the command that was sent last, and the
// checksum is left out of what is sent, having been verified.
#pragma once

#include <string>

#include "rig/serial/zaber/zaber_protocol.h"
#include "tests/rig/serial/transcript.h"

namespace turnlight::rig::serial::zaber {

inline Conversation BeginZaber(const ZaberOptions& options = {}) {
  Conversation conversation;
  conversation.protocol = std::make_unique<ZaberProtocol>(options);
  auto id = std::make_shared<std::string>("00");
  conversation.sent = [id](const std::string& line) -> std::string {
    const std::size_t colon = line.rfind(':');
    if (line.front() != '/' || colon == line.npos ||
        std::stoul(line.substr(colon + 1), nullptr, 16) != Checksum(line.substr(1, colon - 1)))
      return "wrong checksum: " + line;
    // "/1 1 5 get pos": device, axis, id.
    const std::size_t begin = line.find(' ', line.find(' ') + 1) + 1;
    const std::size_t end = line.find_first_of(" :", begin);
    *id = line.substr(begin, end - begin);
    if (id->size() == 1) *id = "0" + *id;
    return line.substr(0, begin) + "*" + line.substr(end, colon - end);
  };
  conversation.received = [id](std::string line) {
    const std::size_t sign = line.find('*');
    return sign == line.npos ? line : line.replace(sign, 1, *id);
  };
  return conversation;
}

// A device of firmware 7 that has been homed and stands at 0.
inline const std::string kZaberIdentified = R"(
  ! connect
  > /1 0 *
  < @01 0 * OK IDLE -- 0
  > /1 0 * get device.id
  < @01 0 * OK IDLE -- 50321
  > /1 0 * get system.serial
  < @01 0 * OK IDLE -- 71234
  > /1 0 * get version
  < @01 0 * OK IDLE -- 7.38
  > /1 1 * get limit.cycle.dist
  < @01 1 * OK IDLE -- 384000
  > /1 1 * get limit.min
  < @01 1 * OK IDLE -- -384000
  > /1 1 * get limit.max
  < @01 1 * OK IDLE -- 768000
  > /1 1 * get maxspeed
  < @01 1 * OK IDLE -- 52429
  > /1 1 * get accel
  < @01 1 * OK IDLE -- 17
  = identified 'Zaber, device 50321, firmware 7.38, 71234'
  > /1 1 * get pos
)";

inline const std::string kZaberReady = kZaberIdentified + R"(
  < @01 1 * OK IDLE -- 0
  = idle 0
  .
)";

inline std::string PlayZaber(const std::string& script, const ZaberOptions& options = {}) {
  return PlayTranscript([options] { return BeginZaber(options); }, script);
}

}  // namespace turnlight::rig::serial::zaber
