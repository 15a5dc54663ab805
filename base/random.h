// Counter-based random numbers: the value is a pure function of (seed, stream, index), so results
// do not depend on the order of evaluation, the number of threads, or how often something was
// tried.
//
// Generator: Philox4x32-10 of Salmon, Moraes, Dror, Shaw, "Parallel Random Numbers: As Easy as 1,
// 2, 3" (SC 2011), checked against the known answers published with it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace turnlight {

inline std::array<std::uint32_t, 4> Philox4x32(std::array<std::uint32_t, 4> counter,
                                               std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

// One stream of numbers, addressed by index: Uniform(i) is the same whenever it is asked for.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        stream_(stream) {}

  // In the open interval (0, 1), 53 bits.
  double Uniform(std::uint64_t index) const {
    const auto words = Words(index);
    return ToUnit(words[0], words[1]);
  }
  double Uniform(std::uint64_t index, double low, double high) const {
    return low + (high - low) * Uniform(index);
  }
  // Standard normal, by Box and Muller.
  double Normal(std::uint64_t index) const {
    const auto words = Words(index);
    const double radius = std::sqrt(-2.0 * std::log(ToUnit(words[0], words[1])));
    return radius * std::cos(2.0 * std::numbers::pi * ToUnit(words[2], words[3]));
  }

 private:
  std::array<std::uint32_t, 4> Words(std::uint64_t index) const {
    return Philox4x32(
        {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
         static_cast<std::uint32_t>(stream_), static_cast<std::uint32_t>(stream_ >> 32)},
        key_);
  }
  static double ToUnit(std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t{high} << 32 | low) >> 11;
    return (static_cast<double>(bits) + 0.5) * 0x1p-53;
  }

  std::array<std::uint32_t, 2> key_;
  std::uint64_t stream_;
};

}  // namespace turnlight
