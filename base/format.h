// Short texts: printf's formats in place of streams, formats and arguments being checked by the
// compiler; lists of words.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace turnlight {

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));

// A number as messages show it: %g with so many digits, at most 17, and a point in any locale.
std::string NumberText(double value, int digits = 9);

// "1 frame", "3 frames".
std::string Counted(std::size_t count, const std::string& noun);

// "a, b, c", as messages name what is allowed.
std::string Listed(const std::vector<std::string>& words);

}  // namespace turnlight
