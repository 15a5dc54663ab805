#include "nodes/graph/wire.h"

#include <cstring>

namespace turnlight::nodes::graph {

void WireWriter::Text(std::string_view text) {
  U64(text.size());
  Raw(text.data(), text.size());
}

void WireReader::Raw(void* to, std::size_t count) {
  if (count > Left()) return Fail(std::to_string(count) + " bytes");
  if (count > 0) std::memcpy(to, bytes_.data() + at_, count);
  at_ += count;
}

bool WireReader::Bool() {
  const std::uint8_t value = U8();
  if (value > 1) Fail("a 0 or 1, not " + std::to_string(value));
  return value == 1;
}

std::string WireReader::Text() {
  const std::uint64_t size = U64();
  if (size > Left()) {
    Fail("a text of " + std::to_string(size) + " bytes");
    return {};
  }
  std::string text(bytes_.substr(at_, size));
  at_ += size;
  return text;
}

void WireReader::Fail(std::string what) {
  if (failure_.empty())
    failure_ = "at byte " + std::to_string(at_) + " of " + std::to_string(bytes_.size()) +
               ": expected " + std::move(what);
  at_ = bytes_.size();
}

Status WireReader::Finish() const {
  if (!failure_.empty()) return InputError(failure_);
  if (Left() > 0)
    return InputError(std::to_string(Left()) + " bytes are left over of " +
                      std::to_string(bytes_.size()));
  return {};
}

}  // namespace turnlight::nodes::graph
