// The header of a PLY file: which elements with which properties follow it. Internal to this
// folder.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
std::size_t SizeOf(PlyType type);  // bytes

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  std::optional<PlyType> count_type;  // of a list's length; none for a single value
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  // in the file's order
  std::size_t size = 0;              // bytes up to the first value
};

// Lines end with CR, LF or both; a byte-order mark is passed over. Fails (kInput) with file and
// line: not a PLY, a line that is none of the format's, a header that does not end.
Result<PlyHeader> ReadPlyHeader(const std::string& bytes, const std::string& file);

}  // namespace turnlight::rig
