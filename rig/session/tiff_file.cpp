// TIFF by libtiff, from and to memory.
#include <tiffio.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "rig/session/image_formats.h"
#include "rig/session/tiff_layout.h"
#include "rig/session/tiff_memory.h"
#include "rig/session/tiff_samples.h"

namespace turnlight::rig {
namespace {

// One open file being decoded.
struct TiffSource {
  TIFF* tiff;
  const TiffMemory& memory;
  const std::string& file;
};

// The channels of a page that are stored together, into those of the picture from `channel` on.
struct TiffPlane {
  std::uint16_t stored = 0;  // which of the page's planes
  int channel = 0, channels = 1;
};

Status ReadRows(const TiffSource& source, const TiffLayout& layout, const TiffPlane& plane,
                cv::Mat& image) {
  const tmsize_t row_bytes = TIFFScanlineSize(source.tiff);
  const std::int64_t needed = (std::int64_t{image.cols} * plane.channels * layout.bits + 7) / 8;
  if (row_bytes != needed)
    return InputError(source.file + ": damaged TIFF: its rows are not width times channels long");
  std::vector<unsigned char> row(static_cast<std::size_t>(row_bytes));
  for (int y = 0; y < image.rows; ++y) {
    if (TIFFReadScanline(source.tiff, row.data(), static_cast<std::uint32_t>(y), plane.stored) != 1)
      return DamagedTiff(source.file, source.memory);
    const TiffPlace place{0, y, image.cols, plane.channel, plane.channels};
    if (Status status = StoreSamples(layout, row.data(), place, source.file, image); !status)
      return status;
  }
  return {};
}

Status ReadTiles(const TiffSource& source, const TiffLayout& layout, const TiffPlane& plane,
                 cv::Mat& image) {
  const auto width = TiffField<std::uint32_t>(source.tiff, TIFFTAG_TILEWIDTH, 0);
  const auto height = TiffField<std::uint32_t>(source.tiff, TIFFTAG_TILELENGTH, 0);
  constexpr std::uint32_t kMostTile = 1 << 15;
  if (width < 1 || height < 1 || width > kMostTile || height > kMostTile)
    return InputError(source.file + ": damaged TIFF: its tiles are " + std::to_string(width) +
                      " x " + std::to_string(height) + " pixels");
  const std::int64_t row_bytes = (std::int64_t{width} * plane.channels * layout.bits + 7) / 8;
  const auto whole = static_cast<std::int64_t>(image.total() * image.elemSize());
  if (TIFFTileRowSize(source.tiff) != row_bytes ||
      TIFFTileSize(source.tiff) != row_bytes * height ||
      row_bytes * height > whole + (std::int64_t{1} << 26))
    return InputError(source.file + ": damaged TIFF: its tiles are not width times channels long");
  std::vector<unsigned char> tile(static_cast<std::size_t>(row_bytes * height));
  const int tile_width = static_cast<int>(width), tile_height = static_cast<int>(height);
  for (int y0 = 0; y0 < image.rows; y0 += tile_height)
    for (int x0 = 0; x0 < image.cols; x0 += tile_width) {
      if (TIFFReadTile(source.tiff, tile.data(), static_cast<std::uint32_t>(x0),
                       static_cast<std::uint32_t>(y0), 0, plane.stored) < 0)
        return DamagedTiff(source.file, source.memory);
      const int columns = std::min(tile_width, image.cols - x0);
      for (int y = y0; y < std::min(y0 + tile_height, image.rows); ++y) {
        const TiffPlace place{x0, y, columns, plane.channel, plane.channels};
        const Status status =
            StoreSamples(layout, tile.data() + row_bytes * (y - y0), place, source.file, image);
        if (!status) return status;
      }
    }
  return {};
}

// The current page into the picture's channels from `channel` on.
Status ReadPage(const TiffSource& source, const TiffLayout& layout, int channel, cv::Mat& image) {
  const int planes = layout.planes ? layout.channels : 1;
  for (int i = 0; i < planes; ++i) {
    const TiffPlane plane{static_cast<std::uint16_t>(i), channel + i,
                          layout.planes ? 1 : layout.channels};
    const Status status = TIFFIsTiled(source.tiff) ? ReadTiles(source, layout, plane, image)
                                                   : ReadRows(source, layout, plane, image);
    if (!status) return status;
  }
  return {};
}

// What the first page says of its values.
std::optional<TransferClaim> TransferOf(TIFF* tiff, const TiffLayout& layout,
                                        const std::string& bytes) {
  if (layout.sample == TiffSample::kLogLuv || layout.sample == TiffSample::kLogL)
    return TransferClaim{Transfer::kLinear, 1.0, "its compression (LogLuv)"};
  std::uint32_t count = 0;
  const void* profile = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &count, &profile) == 1)
    if (auto claim = IccClaim({static_cast<const char*>(profile), std::size_t{count}}))
      return claim;
  const std::uint16_t *red = nullptr, *green = nullptr, *blue = nullptr;
  if (layout.sample == TiffSample::kUnsigned && layout.bits >= 8 && layout.bits <= 16 &&
      TIFFGetField(tiff, TIFFTAG_TRANSFERFUNCTION, &red, &green, &blue) == 1) {
    constexpr std::size_t kSteps = 64;
    const std::size_t last = (std::size_t{1} << layout.bits) - 1;
    std::vector<double> samples;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      const std::size_t at = i * last / kSteps;
      samples.push_back(red[at] / 65535.0);
    }
    return CurveClaim(samples, "the TIFF's TransferFunction tag");
  }
  if (ReadExif(bytes).srgb) return TransferClaim{Transfer::kSrgb, 2.2, "EXIF's ColorSpace (1)"};
  return {};
}

}  // namespace

Result<Picture> DecodeTiff(const std::string& bytes, const std::string& file, cv::Size expected,
                           PictureUse use) {
  TiffMemory memory{bytes, 0, {}};
  const TiffHandle tiff = OpenTiff(memory, "rm");
  if (!tiff) return DamagedTiff(file, memory);
  const TiffSource source{tiff.get(), memory, file};
  const auto pages = PagesOfPicture(tiff.get(), file);
  if (!pages) return Forward(pages);
  if (!memory.complaint.empty()) return DamagedTiff(file, memory);  // a page that cannot be read
  Picture picture;
  std::optional<TiffLayout> first;
  for (std::size_t i = 0; i < pages->size(); ++i) {
    if (TIFFSetDirectory(tiff.get(), (*pages)[i]) != 1) return DamagedTiff(file, memory);
    const auto layout = LayoutOfPage(tiff.get(), file, use);
    if (!layout) return Forward(layout);
    if (i == 0) {
      first = *layout;
      const int channels = pages->size() == 1 ? layout->channels : static_cast<int>(pages->size());
      const ImageHeader header{layout->width, layout->height,
                               std::int64_t{channels} * layout->bits};
      const Status status = CheckImageHeader(header, file, expected, bytes.size());
      if (!status) return Forward(status);
      if (use == PictureUse::kFrame)
        picture.claims = {TransferOf(tiff.get(), *layout, bytes), layout->remarks};
      picture.image.create(static_cast<int>(layout->height), static_cast<int>(layout->width),
                           CV_MAKETYPE(layout->depth, channels));
    }
    if (pages->size() > 1 && (*layout != *first || layout->channels != 1))
      return InputError(file + ": a TIFF of " + std::to_string(pages->size()) +
                        " pages that differ in size or kind, allowed as R, G, B are grey pages "
                        "alike");
    const Status status = ReadPage(source, *layout, static_cast<int>(i), picture.image);
    if (!status) return Forward(status);
    if (use == PictureUse::kMask) ResolveMask(tiff.get(), *layout, picture.image);
  }
  if (pages->size() > 1)
    picture.claims.remarks.emplace_back(
        "a TIFF of 3 pages, which ImageJ's description names as channels: read as R, G, B");
  if (first->sample == TiffSample::kLogLuv) ResolveLogLuv(picture.image);
  return picture;
}

Result<std::string> EncodeTiff(const cv::Mat& image, const std::string& file) {
  if (image.depth() != CV_8U && image.depth() != CV_16U && image.depth() != CV_32F)
    return InputError(file + ": TIFF is written with 8 and 16 bits and float, not this depth");
  TiffMemory memory;
  TiffHandle tiff = OpenTiff(memory, "wlm");
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
