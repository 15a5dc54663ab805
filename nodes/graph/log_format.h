// Numbers of the log's layout, shared by its writer and reader; see log.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace turnlight::nodes::graph::log_format {

using namespace std::string_view_literals;

// The line ends show a transfer in text mode, as PNG's do.
inline constexpr std::string_view kMagic = "turnlight-log\0\r\n"sv;
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::size_t kPrefixBytes = 8;         // length and checksum of a record
inline constexpr std::size_t kRecordHeaderBytes = 26;  // topic, sequence, two times
inline constexpr std::uint32_t kMaxBody = 0x7FFFFFFF;
inline constexpr std::uint32_t kMaxHeader = 1 << 24;
inline constexpr std::uint16_t kEndTopic = 65535;

}  // namespace turnlight::nodes::graph::log_format
