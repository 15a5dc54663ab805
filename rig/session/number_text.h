// Numbers as mesh files write them. Internal to this folder.
#pragma once

#include <optional>
#include <string_view>

namespace turnlight::rig {

// The number that a whole word is, with a point whatever the locale; NaN and infinity in all their
// spellings ("nan", "-inf", "1.#QNAN") are numbers. None if it is no number. What is too large or
// too small for a double is infinity or 0.
std::optional<double> NumberOf(std::string_view word);

}  // namespace turnlight::rig
