// CRC-32C (Castagnoli), the checksum of iSCSI and of most log formats: finds every burst up to 32
// bits.
#pragma once

#include <cstdint>
#include <string_view>

namespace turnlight::nodes::graph {

// Crc32c("123456789") is 0xE3069283. before is the checksum of what came in front, to go on from
// it.
std::uint32_t Crc32c(std::string_view bytes, std::uint32_t before = 0);

}  // namespace turnlight::nodes::graph
