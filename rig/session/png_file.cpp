// PNG by libpng, which gets only chunks that png_chunks.cpp has checked.
#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <string_view>
#include <vector>

#include "rig/session/image_formats.h"
#include "rig/session/png_chunks.h"

namespace turnlight::rig {
namespace {

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

// libpng's state while it reads, freed at the end.
struct PngReader {
  explicit PngReader(std::string_view& bytes)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, Fail, Ignore)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (info) png_set_read_fn(png, &bytes, Take);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  png_structp png;
  png_infop info;
};

// The header, and that pixels come with 8 or 16 bits a channel, in the machine's byte order, and
// palettes as R, G, B. False: damaged.
bool ReadInfo(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  png_set_expand(png);
  if (std::endian::native == std::endian::little && png_get_bit_depth(png, info) == 16)
    png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool ReadPixels(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
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

Result<Picture> DecodePng(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use) {
  auto chunks = WalkPng(bytes, file, expected, use);
  if (!chunks) return Forward(chunks);
  const auto damaged = [&] {
    return InputError(file + ": damaged or truncated PNG: its pixels cannot be decoded");
  };
  std::string_view rest(chunks->pixels);
  PngReader reader(rest);
  if (!reader.info || !ReadInfo(reader.png, reader.info)) return damaged();
  const int depth = png_get_bit_depth(reader.png, reader.info) == 16 ? CV_16U : CV_8U;
  const int channels = png_get_channels(reader.png, reader.info);
  cv::Mat image(chunks->height, chunks->width, CV_MAKETYPE(depth, channels));
  auto rows = RowsOf(image);
  if (!ReadPixels(reader.png, rows.data())) return damaged();
  return Picture{std::move(image), std::move(chunks->claims)};
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
