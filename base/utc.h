// The time of day, as a label for people: no logic may depend on it.
#pragma once

#include <string>

namespace turnlight {

// "2024-05-01T12:00:00.123Z".
std::string UtcNow();

}  // namespace turnlight
