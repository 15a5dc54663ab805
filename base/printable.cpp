#include "base/printable.h"

#include <algorithm>
#include <cstdint>

#include "base/format.h"

namespace turnlight {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: no UTF-8
};

unsigned ByteAt(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

// Bytes of the character that begins with this one; 0 if none does.
std::size_t LengthOf(unsigned first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return 2;
  if (first >= 0xe0 && first <= 0xef) return 3;
  return first >= 0xf0 && first <= 0xf4 ? 4 : 0;
}

Character CharacterAt(std::string_view text, std::size_t at) {
  const unsigned first = ByteAt(text, at);
  const std::size_t length = LengthOf(first);
  if (length == 0 || at + length > text.size()) return {};
  if (length == 1) return {first, 1};
  std::uint32_t code = first & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const unsigned next = ByteAt(text, at + i);
    if ((next & 0xc0) != 0x80) return {};
    code = code << 6 | (next & 0x3f);
  }
  static constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < kLeast[length] || surrogate || code > 0x10ffff ? Character{}
                                                               : Character{code, length};
}

bool IsHarmful(std::uint32_t code) {
  return (code < 0x20 && code != '\t') || (code >= 0x7f && code <= 0x9f) || code == 0x061c ||
         code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string Printable(std::string_view text, Newlines newlines) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character character = CharacterAt(text, at);
    if (character.bytes == 0)
      shown += Format("\\x%02x", ByteAt(text, at));
    else if (character.code == '\n')
      shown += newlines == Newlines::kKept ? "\n" : "\\n";
    else if (character.code == '\r')
      shown += "\\r";
    else if (IsHarmful(character.code))
      shown += Format("\\u%04x", static_cast<unsigned>(character.code));
    else
      shown += text.substr(at, character.bytes);
    at += std::max<std::size_t>(character.bytes, 1);
  }
  return shown;
}

std::size_t IncompleteBytes(std::string_view text) {
  for (std::size_t back = 1; back <= std::min<std::size_t>(text.size(), 3); ++back) {
    const unsigned byte = ByteAt(text, text.size() - back);
    if ((byte & 0xc0) == 0x80) continue;
    return LengthOf(byte) > back ? back : 0;
  }
  return 0;
}

}  // namespace turnlight
