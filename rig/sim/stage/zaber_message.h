// Commands and checksums of the Zaber ASCII protocol.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace turnlight::rig::sim::stage {

// A command `/1 0 12 move abs 1000`, its checksum taken off.
struct ZaberCommand {
  int device = 0;         // 0: all
  int axis = 0;           // 0: all
  std::optional<int> id;  // 0..99
  std::vector<std::string> words;
};

// Of what stands between the marker and the colon: two hexadecimal digits, upper case.
std::string ZaberChecksum(std::string_view text);

// A line without its end. None: it is no command, or its checksum is wrong; a controller passes
// over it without a word.
std::optional<ZaberCommand> ReadZaberCommand(std::string_view line);

}  // namespace turnlight::rig::sim::stage
