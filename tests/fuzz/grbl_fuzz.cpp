// The first byte chooses the options; the rest is a GRBL's words, commands and time (stage_fuzz.h).
#include <cstddef>

#include "rig/serial/grbl/grbl_protocol.h"
#include "tests/fuzz/stage_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace serial = turnlight::rig::serial;
  if (size == 0) return 0;
  serial::grbl::GrblOptions options;
  if (data[0] & 1) options.home = serial::grbl::Homing::kHere;
  if (data[0] & 2) options.lamp_power = 1.0;
  if (data[0] & 4) options.axis = 'A';
  serial::grbl::GrblProtocol protocol(options);
  serial::StageFuzz(protocol).Run({reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
