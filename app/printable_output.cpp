#include "app/printable_output.h"

#include <iostream>
#include <mutex>
#include <streambuf>
#include <string>

#include "base/printable.h"

namespace turnlight::app {

// Keeps nothing back but the begin of a character.
class PrintableOutput::Buffer : public std::streambuf {
 public:
  explicit Buffer(std::ostream& stream) : stream_(stream), under_(stream.rdbuf(this)) {}
  ~Buffer() override {
    Put(0);
    stream_.rdbuf(under_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

 protected:
  int_type overflow(int_type character) override {
    if (traits_type::eq_int_type(character, traits_type::eof())) return 0;
    const char byte = traits_type::to_char_type(character);
    return xsputn(&byte, 1) == 1 ? character : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    begun_.append(text, static_cast<std::size_t>(count));
    return Put(IncompleteBytes(begun_)) ? count : 0;
  }
  int sync() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return under_->pubsync();
  }

 private:
  // Puts all of what has begun but the last bytes, which stay.
  bool Put(std::size_t stay) {
    const std::string begun = begun_.substr(0, begun_.size() - stay);
    begun_.erase(0, begun.size());
    const std::string shown = Printable(begun, Newlines::kKept);
    const auto size = static_cast<std::streamsize>(shown.size());
    return under_->sputn(shown.data(), size) == size;
  }

  std::mutex mutex_;  // streams are written to from several threads
  std::ostream& stream_;
  std::streambuf* under_;
  std::string begun_;
};

PrintableOutput::PrintableOutput()
    : out_(std::make_unique<Buffer>(std::cout)), err_(std::make_unique<Buffer>(std::cerr)) {}
PrintableOutput::~PrintableOutput() = default;

}  // namespace turnlight::app
