// Frames chosen by hand: the value of --frames.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::app {

// "0-16,18-35": numbers and ranges of a session's frames, counted from 0 as messages count them,
// ascending, each once. Whether the session has them is not looked at. Fails (kInput) and says what
// is wrong: a word that is neither, a range that goes backwards, a number out of order or named
// twice.
Result<std::vector<std::size_t>> ParseFrames(const std::string& text);

}  // namespace turnlight::app
