// Messages as bytes: little-endian, no padding, lengths in front of what varies.
//
// A message type T describes itself once, in a specialisation beside its definition:
//   template <>
//   struct turnlight::nodes::graph::Wire<Angle> {
//     static constexpr std::string_view kName = "Angle";
//     static constexpr std::uint32_t kVersion = 1;  // goes up with every change of the two below
//     static void Encode(const Angle& angle, WireWriter& out) { out.F64(angle.deg); }
//     static Angle Decode(WireReader& in) { return {.deg = in.F64()}; }
//   };
// The name and version stand in every log; a log of another version is refused, not guessed at.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/result.h"

namespace turnlight::nodes::graph {

static_assert(std::endian::native == std::endian::little, "the wire format is memory order");

template <typename T>
struct Wire;

// Appends to a string that the caller owns and may reuse.
class WireWriter {
 public:
  explicit WireWriter(std::string& out) : out_(out) {}

  void U8(std::uint8_t value) { Plain(value); }
  void U16(std::uint16_t value) { Plain(value); }
  void U32(std::uint32_t value) { Plain(value); }
  void U64(std::uint64_t value) { Plain(value); }
  void I64(std::int64_t value) { Plain(value); }
  void F32(float value) { Plain(value); }
  void F64(double value) { Plain(value); }
  void Bool(bool value) { U8(value ? 1 : 0); }
  void Text(std::string_view text);
  // The count and then the elements, copied as one block.
  template <typename Number>
  void Numbers(std::span<const Number> numbers) {
    static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
    U64(numbers.size());
    Raw(numbers.data(), numbers.size_bytes());
  }

 private:
  template <typename Number>
  void Plain(Number value) {
    Raw(&value, sizeof value);
  }
  void Raw(const void* bytes, std::size_t count) {
    out_.append(static_cast<const char*>(bytes), count);
  }

  std::string& out_;
};

// Reads what WireWriter wrote. Never reads past the end and never allocates more than the bytes
// there are: after the first failure every read returns zero or nothing, and Finish() says what was
// wrong.
class WireReader {
 public:
  explicit WireReader(std::string_view bytes) : bytes_(bytes) {}

  std::uint8_t U8() { return Plain<std::uint8_t>(); }
  std::uint16_t U16() { return Plain<std::uint16_t>(); }
  std::uint32_t U32() { return Plain<std::uint32_t>(); }
  std::uint64_t U64() { return Plain<std::uint64_t>(); }
  std::int64_t I64() { return Plain<std::int64_t>(); }
  float F32() { return Plain<float>(); }
  double F64() { return Plain<double>(); }
  bool Bool();
  std::string Text();
  template <typename Number>
  std::vector<Number> Numbers() {
    const std::uint64_t count = U64();
    if (count > Left() / sizeof(Number)) {
      Fail("a list of " + std::to_string(count) + " numbers");
      return {};
    }
    std::vector<Number> numbers(count);
    Raw(numbers.data(), count * sizeof(Number));
    return numbers;
  }

  // For a decoder that finds a value out of range.
  void Fail(std::string what);
  std::size_t Left() const { return bytes_.size() - at_; }
  // Success if every byte was read and nothing failed.
  Status Finish() const;

 private:
  template <typename Number>
  Number Plain() {
    Number value{};
    Raw(&value, sizeof value);
    return value;
  }
  void Raw(void* to, std::size_t count);

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::string failure_;
};

}  // namespace turnlight::nodes::graph
