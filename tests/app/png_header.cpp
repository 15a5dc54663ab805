#include "tests/app/png_header.h"

#include <png.h>

#include <vector>

namespace turnlight::app {
namespace {

constexpr std::size_t kHeaderType = 12;  // where "IHDR" stands
constexpr std::size_t kWidth = 16;
constexpr std::size_t kHeight = 20;
constexpr std::size_t kHeaderEnd = 29;  // where its checksum stands

// The CRC-32 of PNG, bit by bit.
std::uint32_t Crc(const std::string& bytes, std::size_t begin, std::size_t end) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = begin; i < end; ++i) {
    crc ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

void PutBigEndian(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
}

}  // namespace

std::string WithPngSize(std::string png, std::uint32_t width, std::uint32_t height) {
  PutBigEndian(png, kWidth, width);
  PutBigEndian(png, kHeight, height);
  PutBigEndian(png, kHeaderEnd, Crc(png, kHeaderType, kHeaderEnd));
  return png;
}

std::string RgbaPng(int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGBA;
  const std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image), 40);
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

}  // namespace turnlight::app
