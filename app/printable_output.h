// What the program prints, made fit for a terminal in one place.
#pragma once

#include <memory>

namespace turnlight::app {

// While it lives, all that goes to std::cout and std::cerr is passed through Printable, lines kept:
// whatever a file or a device calls itself, it cannot steer the terminal. What may hold a line's
// end that is not ours (a message, a name) is passed through Printable where it is put in as well.
class PrintableOutput {
 public:
  PrintableOutput();
  ~PrintableOutput();
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 private:
  class Buffer;
  std::unique_ptr<Buffer> out_, err_;
};

}  // namespace turnlight::app
