// PNG by libpng, after this file has walked the chunks: the size is checked before memory is taken,
// damage is told by its kind, palettes and alpha are refused, and the decoder gets no odd chunks.
#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <string_view>
#include <vector>

#include "rig/session/image_formats.h"

namespace turnlight::rig {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kHeaderBytes = 13;
constexpr int kGrey = 0;
constexpr int kRgb = 2;

std::uint32_t BigEndian32(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

struct Chunk {
  std::string_view type;
  std::string_view data;
  std::string_view whole;  // length, type, data and checksum
};

// Takes the first chunk off `rest` and checks its length and checksum.
Result<Chunk> TakeChunk(std::string_view& rest, const std::string& file) {
  if (rest.size() < 12) return InputError(file + ": truncated PNG: it ends before its end chunk");
  const std::size_t length = BigEndian32(rest);
  if (length > rest.size() - 12)
    return InputError(file + ": truncated PNG: a chunk of " + std::to_string(length) +
                      " bytes, but " + std::to_string(rest.size() - 12) + " are left");
  const Chunk chunk{rest.substr(4, 4), rest.substr(8, length), rest.substr(0, length + 12)};
  const auto* checked = reinterpret_cast<const Bytef*>(rest.data() + 4);
  if (crc32_z(0, checked, length + 4) != BigEndian32(rest.substr(8 + length)))
    return InputError(file + ": damaged PNG: a chunk's checksum is wrong");
  rest.remove_prefix(chunk.whole.size());
  return chunk;
}

Status CheckHeader(std::string_view data, const std::string& file, cv::Size expected,
                   std::size_t file_bytes) {
  const int bits = data[8];
  const int colour = data[9];
  if (colour != kGrey && colour != kRgb)
    return InputError(file + ": PNG colour type " + std::to_string(colour) + " (" +
                      (colour == 3   ? "palette"
                       : colour == 4 ? "grey with alpha, 2 channels"
                       : colour == 6 ? "RGB with alpha, 4 channels"
                                     : "unknown") +
                      "), allowed are grey (0) and RGB (2)");
  if (bits != 8 && bits != 16)
    return InputError(file + ": " + std::to_string(bits) +
                      " bits per channel, allowed are 8 and 16 in a PNG");
  const ImageHeader header{BigEndian32(data), BigEndian32(data.substr(4)),
                           (bits / 8) * (colour == kRgb ? 3 : 1)};
  return CheckImageHeader(header, file, expected, file_bytes);
}

// The chunks that make up the pixels, all checked, without the optional ones.
Result<std::string> PixelChunks(const std::string& bytes, const std::string& file,
                                cv::Size expected) {
  std::string_view rest(bytes);
  if (!rest.starts_with(kSignature))
    return InputError(file + ": not a PNG file: its first 8 bytes are not PNG's signature");
  rest.remove_prefix(kSignature.size());
  std::string kept(kSignature);
  for (bool first = true;; first = false) {
    const auto chunk = TakeChunk(rest, file);
    if (!chunk) return Forward(chunk);
    if (first) {
      if (chunk->type != "IHDR" || chunk->data.size() != kHeaderBytes)
        return InputError(file + ": damaged PNG: it does not begin with a header chunk");
      const Status status = CheckHeader(chunk->data, file, expected, bytes.size());
      if (!status) return Forward(status);
    }
    if (chunk->type == "tRNS")
      return InputError(file + ": a PNG with a transparent colour, allowed are grey and RGB");
    if (chunk->type == "IHDR" || chunk->type == "IDAT" || chunk->type == "IEND")
      kept += chunk->whole;
    if (chunk->type == "IEND") return kept;
  }
}

// libpng tells of an error by a longjmp. What it may leave in this way, ReadPixels and WritePixels,
// holds nothing that must be destroyed; the callbacks throw nothing.
void Fail(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void Ignore(png_structp, png_const_charp) {}

void Take(png_structp png, png_bytep to, std::size_t count) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > rest.size()) png_error(png, "too short");
  std::memcpy(to, rest.data(), count);
  rest.remove_prefix(count);
}

void Append(png_structp png, png_bytep from, std::size_t count) {
  bool done = true;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(from), count);
  } catch (const std::exception&) {
    done = false;
  }
  if (!done) png_error(png, "no memory");
}

// Rows of a picture whose header was checked, R, G, B and in the machine's byte order.
bool ReadPixels(png_structp png, png_infop info, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  if (std::endian::native == std::endian::little && png_get_bit_depth(png, info) == 16)
    png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

// Quick rather than small: noise hardly compresses.
bool WritePixels(png_structp png, png_infop info, png_bytepp rows, const cv::Mat& image) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const int bits = image.depth() == CV_16U ? 16 : 8;
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_level(png, Z_BEST_SPEED);
  png_set_compression_strategy(png, Z_RLE);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols),
               static_cast<png_uint_32>(image.rows), bits,
               image.channels() == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (std::endian::native == std::endian::little && bits == 16) png_set_swap(png);
  png_write_image(png, rows);
  png_write_end(png, nullptr);
  return true;
}

std::vector<png_bytep> RowsOf(const cv::Mat& image) {
  std::vector<png_bytep> rows;
  for (int y = 0; y < image.rows; ++y) rows.push_back(const_cast<png_bytep>(image.ptr(y)));
  return rows;
}

}  // namespace

Result<cv::Mat> DecodePng(const std::string& bytes, const std::string& file, cv::Size expected) {
  const auto chunks = PixelChunks(bytes, file, expected);
  if (!chunks) return Forward(chunks);
  const std::string_view header = std::string_view(*chunks).substr(kSignature.size() + 8);
  const int depth = header[8] == 16 ? CV_16U : CV_8U;
  cv::Mat image(static_cast<int>(BigEndian32(header.substr(4))),
                static_cast<int>(BigEndian32(header)),
                CV_MAKETYPE(depth, header[9] == kRgb ? 3 : 1));
  auto rows = RowsOf(image);
  std::string_view rest(*chunks);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, Fail, Ignore);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) png_set_read_fn(png, &rest, Take);
  const bool done = info && ReadPixels(png, info, rows.data());
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done) return InputError(file + ": damaged or truncated PNG: its pixels cannot be decoded");
  return image;
}

Result<std::string> EncodePng(const cv::Mat& image, const std::string& file) {
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    return InputError(file + ": PNG holds 8 and 16 bits, not this depth; use .tif or .exr");
  std::string bytes;
  auto rows = RowsOf(image);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, Fail, Ignore);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) png_set_write_fn(png, &bytes, Append, nullptr);
  const bool done = info && WritePixels(png, info, rows.data(), image);
  png_destroy_write_struct(&png, &info);
  if (!done) return SystemError(file + ": cannot encode the PNG");
  return bytes;
}

}  // namespace turnlight::rig
