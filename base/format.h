// printf's formats for texts, in place of streams; formats and arguments are checked by the
// compiler.
#pragma once

#include <string>

namespace turnlight {

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace turnlight
