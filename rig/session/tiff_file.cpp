// TIFF by libtiff, from and to memory.
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "rig/session/image_formats.h"

namespace turnlight::rig {
namespace {

// The bytes behind an open TIFF, and the first complaint of the library about them.
struct Memory {
  std::string bytes;
  std::size_t position = 0;
  std::string complaint;
};

Memory& MemoryOf(thandle_t handle) { return *static_cast<Memory*>(handle); }

tmsize_t ReadBytes(thandle_t handle, void* buffer, tmsize_t count) {
  Memory& memory = MemoryOf(handle);
  if (count <= 0 || memory.position >= memory.bytes.size()) return 0;
  const std::size_t n =
      std::min(static_cast<std::size_t>(count), memory.bytes.size() - memory.position);
  std::memcpy(buffer, memory.bytes.data() + memory.position, n);
  memory.position += n;
  return static_cast<tmsize_t>(n);
}

tmsize_t WriteBytes(thandle_t handle, void* buffer, tmsize_t count) {
  Memory& memory = MemoryOf(handle);
  const std::size_t end = memory.position + static_cast<std::size_t>(count);
  if (end > memory.bytes.size()) memory.bytes.resize(end, '\0');
  std::memcpy(memory.bytes.data() + memory.position, buffer, static_cast<std::size_t>(count));
  memory.position = end;
  return count;
}

toff_t Seek(thandle_t handle, toff_t offset, int whence) {
  Memory& memory = MemoryOf(handle);
  const std::size_t base = whence == SEEK_SET   ? 0
                           : whence == SEEK_CUR ? memory.position
                                                : memory.bytes.size();
  memory.position = base + offset;
  return memory.position;
}

int Close(thandle_t) { return 0; }
toff_t Size(thandle_t handle) { return MemoryOf(handle).bytes.size(); }

int KeepComplaint(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  Memory& memory = MemoryOf(user_data);
  char text[256];
  std::vsnprintf(text, sizeof text, format, arguments);
  if (memory.complaint.empty()) memory.complaint = text;
  return 1;
}
int Silence(TIFF*, void*, const char*, const char*, va_list) { return 1; }

using TiffHandle = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

TiffHandle Open(Memory& memory, const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  // A hostile directory may ask for any amount; nothing we read needs more than the file and a row.
  TIFFOpenOptionsSetMaxSingleMemAlloc(
      options, static_cast<tmsize_t>(memory.bytes.size()) + (tmsize_t{1} << 26));
  TIFFOpenOptionsSetErrorHandlerExtR(options, KeepComplaint, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options, Silence, nullptr);
  TIFF* tiff = TIFFClientOpenExt("", mode, &memory, ReadBytes, WriteBytes, Seek, Close, Size,
                                 nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return {tiff, TIFFClose};
}

template <typename T>
T Field(TIFF* tiff, ttag_t tag, T otherwise) {
  T value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) ? value : otherwise;
}

tl::unexpected<Error> Damaged(const std::string& file, const Memory& memory) {
  return InputError(file + ": damaged or truncated TIFF: " + memory.complaint);
}

// How the pixels are laid out; fails when that is not plain rows of grey or RGB.
struct Layout {
  int depth = CV_8U;
  int channels = 1;
};

Result<Layout> CheckLayout(TIFF* tiff, const std::string& file) {
  const int channels = Field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  const int bits = Field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  const int format = Field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const int photometric = Field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, 0xffff);
  const int compression = Field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (channels != 1 && channels != 3)
    return InputError(file + ": " + std::to_string(channels) +
                      " channels, allowed are 1 (grey) and 3 (RGB)");
  if (photometric != (channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB))
    return InputError(file + ": TIFF photometric interpretation " + std::to_string(photometric) +
                      ", allowed are 1 (grey, black is 0) and 2 (RGB)");
  const bool whole = format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16);
  if (!whole && !(format == SAMPLEFORMAT_IEEEFP && bits == 32))
    return InputError(file + ": TIFF samples of " + std::to_string(bits) + " bits and format " +
                      std::to_string(format) +
                      ", allowed are 8 and 16 bits unsigned (1) and 32 bits float (3)");
  if (compression != COMPRESSION_NONE && compression != COMPRESSION_LZW &&
      compression != COMPRESSION_DEFLATE && compression != COMPRESSION_ADOBE_DEFLATE &&
      compression != COMPRESSION_PACKBITS)
    return InputError(file + ": TIFF compression " + std::to_string(compression) +
                      ", allowed are none, LZW, deflate and PackBits");
  if (TIFFIsTiled(tiff) ||
      (channels > 1 && Field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) !=
                           PLANARCONFIG_CONTIG) ||
      Field<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
    return InputError(file +
                      ": a tiled, planar or turned TIFF, allowed are rows from the top left" +
                      " with the channels side by side");
  return Layout{bits == 8 ? CV_8U : bits == 16 ? CV_16U : CV_32F, channels};
}

}  // namespace

Result<cv::Mat> DecodeTiff(const std::string& bytes, const std::string& file, cv::Size expected) {
  Memory memory{bytes, 0, {}};
  const TiffHandle tiff = Open(memory, "rm");
  if (!tiff) return Damaged(file, memory);
  const auto width = Field<std::uint32_t>(tiff.get(), TIFFTAG_IMAGEWIDTH, 0);
  const auto height = Field<std::uint32_t>(tiff.get(), TIFFTAG_IMAGELENGTH, 0);
  const auto layout = CheckLayout(tiff.get(), file);
  if (!layout) return Forward(layout);
  const int type = CV_MAKETYPE(layout->depth, layout->channels);
  const Status status =
      CheckImageHeader({width, height, CV_ELEM_SIZE(type)}, file, expected, bytes.size());
  if (!status) return Forward(status);
  cv::Mat image(static_cast<int>(height), static_cast<int>(width), type);
  if (TIFFScanlineSize(tiff.get()) != static_cast<tmsize_t>(width * image.elemSize()))
    return InputError(file + ": damaged TIFF: its rows are not width times channels long");
  for (int row = 0; row < image.rows; ++row)
    if (TIFFReadScanline(tiff.get(), image.ptr(row), static_cast<std::uint32_t>(row), 0) != 1)
      return Damaged(file, memory);
  return image;
}

Result<std::string> EncodeTiff(const cv::Mat& image, const std::string& file) {
  if (image.depth() != CV_8U && image.depth() != CV_16U && image.depth() != CV_32F)
    return InputError(file + ": TIFF is written with 8 and 16 bits and float, not this depth");
  Memory memory;
  TiffHandle tiff = Open(memory, "wlm");
  if (!tiff) return SystemError(file + ": cannot encode the TIFF: " + memory.complaint);
  const bool is_float = image.depth() == CV_32F;
  const bool is_grey = image.channels() == 1;
  TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, image.cols);
  TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, image.rows);
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, image.channels());
  TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * image.elemSize1()));
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT,
               is_float ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, is_grey ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, TIFFDefaultStripSize(tiff.get(), 0));
  cv::Mat row;  // libtiff may change the row that it is given
  for (int y = 0; y < image.rows; ++y) {
    image.row(y).copyTo(row);
    if (TIFFWriteScanline(tiff.get(), row.data, static_cast<std::uint32_t>(y), 0) != 1)
      return SystemError(file + ": cannot encode the TIFF: " + memory.complaint);
  }
  tiff.reset();  // writes the directory
  if (!memory.complaint.empty())
    return SystemError(file + ": cannot encode the TIFF: " + memory.complaint);
  return std::move(memory.bytes);
}

}  // namespace turnlight::rig
