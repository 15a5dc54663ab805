// A Zaber stage that answers as it should, with other flags, not at all, or with the input's bytes.
#include <algorithm>
#include <array>
#include <cstdio>

#include "rig/serial/zaber/zaber_protocol.h"
#include "tests/fuzz/stage_fuzz.h"

namespace {

constexpr std::array<const char*, 8> kFlags = {"--", "--", "WR", "NI", "FS", "WT", "WH", "ND"};

std::string ValueOf(const std::string& command, double target_deg, std::uint8_t choice) {
  if (command.find("dist") != command.npos) return "384000";
  if (command.find("limit.min") != command.npos) return "-384000";
  if (command.find("limit.max") != command.npos) return "384000";
  if (command.find("get pos") != command.npos && choice % 4 != 3)
    return std::to_string(std::llround(target_deg * 384000.0 / 360.0));
  if (command.find("warnings") != command.npos) return choice % 2 == 0 ? "00" : "02 WT WR";
  return std::to_string(choice);
}

std::string Answer(const std::string& sent, double target_deg, std::uint8_t choice) {
  int device = 1, axis = 1, id = 0;
  if (std::sscanf(sent.c_str(), "/%d %d %d", &device, &axis, &id) != 3) return "";
  char head[64];
  std::snprintf(head, sizeof head, "@%02d %d %02d %s %s %s ", device, axis,
                choice == 200 ? (id + 99) % 100 : id, choice >= 240 ? "RJ" : "OK",
                choice % 16 == 5 ? "BUSY" : "IDLE", choice < 128 ? kFlags[choice / 16] : "--");
  return head + (choice >= 240 ? "BADDATA" : ValueOf(sent, target_deg, choice));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  turnlight::rig::serial::zaber::ZaberProtocol protocol({});
  turnlight::StageFuzzer(protocol, Answer).Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
