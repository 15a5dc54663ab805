// TIFFs in memory, for libtiff. Internal to this folder.
#pragma once

#include <tiffio.h>

#include <cstddef>
#include <memory>
#include <string>

#include "base/result.h"

namespace turnlight::rig {

// The bytes behind an open TIFF, and the first complaint of the library about them.
struct TiffMemory {
  std::string bytes;
  std::size_t position = 0;
  std::string complaint;
};

using TiffHandle = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

// mode as TIFFOpen's. Null: not a TIFF. memory has to outlive the handle.
TiffHandle OpenTiff(TiffMemory& memory, const char* mode);

// A tag of one value, the format's default without it, or `otherwise`.
template <typename T>
T TiffField(TIFF* tiff, ttag_t tag, T otherwise) {
  T value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) ? value : otherwise;
}

tl::unexpected<Error> DamagedTiff(const std::string& file, const TiffMemory& memory);

}  // namespace turnlight::rig
