// TIFFs of any kind, written by libtiff's own calls, for tests.
#pragma once

#include <tiffio.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/file.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig {

// One page of raw samples. tags: sets what else is wanted, before the samples.
struct TiffPage {
  int width = 4, height = 3;
  int bits = 8, samples = 1;
  int format = SAMPLEFORMAT_UINT, photometric = PHOTOMETRIC_MINISBLACK;
  std::function<void(TIFF*)> tags = [](TIFF*) {};
  std::string pixels = "";  // row by row, plane by plane; or of tiles, whole
};

inline void WritePage(TIFF* tiff, const TiffPage& page) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, page.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, page.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, page.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, page.samples);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, page.format);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, page.photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  page.tags(tiff);
  std::string pixels = page.pixels;
  if (TIFFIsTiled(tiff)) {
    const auto size = static_cast<std::size_t>(TIFFTileSize(tiff));
    pixels.resize(size * TIFFNumberOfTiles(tiff));
    for (std::uint32_t i = 0; i < TIFFNumberOfTiles(tiff); ++i)
      TIFFWriteEncodedTile(tiff, i, pixels.data() + size * i, static_cast<tmsize_t>(size));
  } else {
    const auto size = static_cast<std::size_t>(TIFFScanlineSize(tiff));
    std::uint16_t planar = PLANARCONFIG_CONTIG;
    TIFFGetField(tiff, TIFFTAG_PLANARCONFIG, &planar);
    const int planes = planar == PLANARCONFIG_SEPARATE ? page.samples : 1;
    pixels.resize(size * static_cast<std::size_t>(page.height * planes));
    std::size_t at = 0;
    for (int plane = 0; plane < planes; ++plane)
      for (int y = 0; y < page.height; ++y, at += size)
        TIFFWriteScanline(tiff, pixels.data() + at, static_cast<std::uint32_t>(y),
                          static_cast<std::uint16_t>(plane));
  }
  TIFFWriteDirectory(tiff);
}

// mode: TIFFOpen's; "w8" is a BigTIFF, "wb" has the bytes of big-endian machines.
inline std::string TiffOfPages(const std::vector<TiffPage>& pages, const char* mode = "w") {
  const TemporaryFolder folder;
  const std::string path = folder / "made.tif";
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  for (const TiffPage& page : pages) WritePage(tiff, page);
  TIFFClose(tiff);
  return ReadFile(path).value_or("");
}

template <typename T>
std::string BytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace turnlight::rig
