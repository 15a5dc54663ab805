// PNGs made chunk by chunk, for tests.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>

namespace turnlight::rig {

inline std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

inline std::string PngChunk(const std::string& type, const std::string& data) {
  const std::string checked = type + data;
  const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
  return BigEndian(static_cast<std::uint32_t>(data.size())) + checked +
         BigEndian(static_cast<std::uint32_t>(sum));
}

inline std::string Deflated(const std::string& bytes) {
  std::string out(compressBound(bytes.size()), '\0');
  uLongf length = out.size();
  compress(reinterpret_cast<Bytef*>(out.data()), &length,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  return out.substr(0, length);
}

// rows: each row's filter byte and bytes. before: chunks ahead of the pixels.
inline std::string PngOfRows(std::uint32_t width, std::uint32_t height, int bits, int colour,
                             const std::string& rows, const std::string& before = "") {
  std::string header = BigEndian(width) + BigEndian(height);
  header += {static_cast<char>(bits), static_cast<char>(colour), 0, 0, 0};
  return std::string("\x89PNG\r\n\x1a\n", 8) + PngChunk("IHDR", header) + before +
         PngChunk("IDAT", Deflated(rows)) + PngChunk("IEND", "");
}

// A PNG with one more chunk behind its header.
inline std::string WithChunk(const std::string& png, const std::string& chunk) {
  constexpr std::size_t kHeaderEnd = 8 + 25;
  return png.substr(0, kHeaderEnd) + chunk + png.substr(kHeaderEnd);
}

// An EXIF block of one tag of two bytes.
inline std::string ExifOf(int tag, int value) {
  std::string bytes("MM\0*\0\0\0\x08\0\x01", 10);
  bytes += {static_cast<char>(tag >> 8), static_cast<char>(tag), 0, 3, 0, 0, 0, 1};
  bytes += {static_cast<char>(value >> 8), static_cast<char>(value)};
  return bytes + std::string(6, '\0');
}

}  // namespace turnlight::rig
