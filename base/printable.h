// Text of files, devices and other programs, made fit to be printed: what would steer a terminal,
// forge a line or reorder what is read is shown as an escape instead.
#pragma once

#include <string>
#include <string_view>

namespace turnlight {

enum class Newlines {
  kEscaped,  // a field or a message of one line
  kKept,     // whole lines
};

// Escaped are control characters (ESC, DEL and those of U+0080 to U+009F among them; not the tab),
// line separators and marks that turn the direction of writing: \n, \r, else \u001b, as JSON has
// them, so that JSON's meaning stays the same; and bytes that are no UTF-8: \xff. All else comes as
// it is.
std::string Printable(std::string_view text, Newlines newlines = Newlines::kEscaped);

// How many bytes at the end of text are the begin of a UTF-8 character that is not complete: 0
// to 3.
std::size_t IncompleteBytes(std::string_view text);

}  // namespace turnlight
