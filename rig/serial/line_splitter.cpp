#include "rig/serial/line_splitter.h"

#include <utility>

namespace turnlight::rig::serial {

std::vector<std::string> LineSplitter::Take(std::string_view bytes) {
  std::vector<std::string> lines;
  for (const char byte : bytes) {
    if (byte == '\r' || byte == '\n') {
      bad_ += bad_line_;
      if (!bad_line_ && !line_.empty()) lines.push_back(std::move(line_));
      Reset();
    } else if (byte < 0x20 || byte > 0x7e || line_.size() == max_length_) {
      bad_line_ = true;
    } else {
      line_ += byte;
    }
  }
  return lines;
}

std::size_t LineSplitter::TakeBad() { return std::exchange(bad_, 0); }

void LineSplitter::Reset() {
  line_.clear();
  bad_line_ = false;
}

}  // namespace turnlight::rig::serial
