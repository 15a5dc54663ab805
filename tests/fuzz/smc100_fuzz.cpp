// A Newport controller that answers as it should, in other states, not at all, or with the input's
// bytes.
#include <array>

#include "rig/serial/smc100/smc100_protocol.h"
#include "tests/fuzz/stage_fuzz.h"

namespace {

constexpr std::array<const char*, 16> kStates = {
    "000033", "000033", "000033", "000028", "000028", "000032", "00000A", "00000A",
    "00001E", "00003C", "000034", "002033", "00200F", "000036", "000046", "0000zz"};
constexpr std::array<const char*, 8> kVerdicts = {"@", "@", "@", "@", "A", "G", "E", "K"};

std::string Answer(const std::string& sent, double target_deg, std::uint8_t choice) {
  const std::string command = sent.substr(0, 3);
  if (command == "1VE") return "1VE SMC100CC";
  if (command == "1TS") return "1TS" + std::string(kStates[choice % kStates.size()]);
  if (command == "1TP") return "1TP" + std::to_string(choice % 4 == 3 ? choice : target_deg);
  if (command == "1TE") return "1TE" + std::string(kVerdicts[choice % kVerdicts.size()]);
  if (command == "1SL") return "1SL-180";
  if (command == "1SR") return "1SR180";
  if (command == "1ID") return "1IDURS100";
  return command + std::to_string(choice);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  turnlight::rig::serial::smc100::Smc100Protocol protocol({});
  turnlight::StageFuzzer(protocol, Answer).Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
