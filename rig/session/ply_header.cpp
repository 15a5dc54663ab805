#include "rig/session/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "base/printable.h"

namespace turnlight::rig {
namespace {

constexpr std::size_t kMaxLine = std::size_t{1} << 16;  // comments can be long
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::optional<PlyType> TypeOf(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{
      {{"char", PlyType::kInt8},
       {"int8", PlyType::kInt8},
       {"uchar", PlyType::kUint8},
       {"uint8", PlyType::kUint8},
       {"short", PlyType::kInt16},
       {"int16", PlyType::kInt16},
       {"ushort", PlyType::kUint16},
       {"uint16", PlyType::kUint16},
       {"int", PlyType::kInt32},
       {"int32", PlyType::kInt32},
       {"uint", PlyType::kUint32},
       {"uint32", PlyType::kUint32},
       {"float", PlyType::kFloat},
       {"float32", PlyType::kFloat},
       {"double", PlyType::kDouble},
       {"float64", PlyType::kDouble}}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

std::vector<std::string_view> WordsOf(std::string_view line) {
  constexpr std::string_view kBlank = " \t\v\f";
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(kBlank, at)) < line.size();) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool TakeProperty(const std::vector<std::string_view>& words, PlyElement& element) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return false;
  const auto type = TypeOf(words[words.size() - 2]);
  if (!type) return false;
  PlyProperty property{std::string(words.back()), *type, std::nullopt};
  if (list) {
    property.count_type = TypeOf(words[2]);
    if (!property.count_type || *property.count_type >= PlyType::kFloat) return false;
  }
  element.properties.push_back(std::move(property));
  return true;
}

bool TakeFormat(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() != 3 || words[2] != "1.0") return false;
  if (words[1] == "ascii")
    header.format = PlyFormat::kAscii;
  else if (words[1] == "binary_little_endian")
    header.format = PlyFormat::kLittleEndian;
  else if (words[1] == "binary_big_endian")
    header.format = PlyFormat::kBigEndian;
  else
    return false;
  return true;
}

bool TakeElement(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() != 3) return false;
  PlyElement element{std::string(words[1]), 0, {}};
  const char* end = words[2].data() + words[2].size();
  const auto read = std::from_chars(words[2].data(), end, element.count);
  header.elements.push_back(std::move(element));
  return read.ec == std::errc() && read.ptr == end;
}

// Takes one line of the header; false if it cannot be understood.
bool TakeLine(const std::vector<std::string_view>& words, PlyHeader& header, bool& has_format) {
  if (words[0] == "comment" || words[0] == "obj_info") return true;
  if (words[0] == "format") {
    has_format = true;
    return TakeFormat(words, header);
  }
  if (words[0] == "element") return TakeElement(words, header);
  return words[0] == "property" && !header.elements.empty() &&
         TakeProperty(words, header.elements.back());
}

bool IsMagic(std::string_view line) {
  const std::vector<std::string_view> words = WordsOf(line);
  return words.size() == 1 && (words[0] == "ply" || words[0] == "PLY");
}

}  // namespace

std::size_t SizeOf(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      return 8;
  }
  return 1;
}

Result<PlyHeader> ReadPlyHeader(const std::string& bytes, const std::string& file) {
  const std::string_view text(bytes);
  PlyHeader header;
  if (text.starts_with(kByteOrderMark)) header.size = kByteOrderMark.size();
  bool has_format = false;
  bool cr_only = false;
  for (std::size_t number = 1;; ++number) {
    const std::size_t end = text.find_first_of("\r\n", header.size);
    if (number == 1 && !IsMagic(text.substr(header.size, std::min(end - header.size, kMaxLine))))
      return InputError(file + ": not a PLY file: it does not begin with \"ply\"");
    if (end == std::string_view::npos || end - header.size > kMaxLine)
      return InputError(file + ": truncated PLY: its header does not end");
    const std::string_view line = text.substr(header.size, end - header.size);
    const bool both = text.substr(end).starts_with("\r\n");
    // After "ply" and a lone CR, an LF behind another CR is the first byte of the values.
    if (number == 1) cr_only = text[end] == '\r' && !both;
    header.size = end + (both && !cr_only ? 2 : 1);
    const std::vector<std::string_view> words = WordsOf(line);
    if (number == 1 || words.empty()) continue;
    if (words[0] == "end_header") break;
    if (!TakeLine(words, header, has_format))
      return InputError(
          file + ":" + std::to_string(number) + ": \"" + Printable(line.substr(0, 80)) +
          "\", allowed are format 1.0, element, property, comment and obj_info lines" +
          " with PLY's types");
  }
  if (!has_format) return InputError(file + ": damaged PLY: its header has no format");
  return header;
}

}  // namespace turnlight::rig
