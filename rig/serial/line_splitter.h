// Lines out of a stream of bytes: bounded in length, whatever comes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace turnlight::rig::serial {

// Lines end in CR, LF or both; empty ones are left out. A line that is longer than max_length, or
// holds a byte that is no printable ASCII, is no text of a controller: it is dropped whole, up to
// its end, and counted.
class LineSplitter {
 public:
  explicit LineSplitter(std::size_t max_length) : max_length_(max_length) {}

  // The lines that these bytes complete.
  std::vector<std::string> Take(std::string_view bytes);
  // Lines dropped since the last call.
  std::size_t TakeBad();
  // Forgets what has begun.
  void Reset();

 private:
  std::size_t max_length_;
  std::string line_;
  bool bad_line_ = false;
  std::size_t bad_ = 0;
};

}  // namespace turnlight::rig::serial
