// How the program ends.
#pragma once

#include <string>

#include "base/result.h"

namespace turnlight::app {

inline constexpr int kDone = 0;
inline constexpr int kRefused = 2;     // usage, config or input
inline constexpr int kIncomplete = 3;  // some frames lost, the rest kept
inline constexpr int kDifferent = 3;   // of `compare`
inline constexpr int kDeviceFault = 4;
inline constexpr int kNoEstimate = 5;
inline constexpr int kInterrupted = 130;
inline constexpr int kReaderGone = 141;  // all done, but nobody read the whole standard output

// Prints the error on standard error and gives its exit code.
int Fail(const Error& error);
// The same of a command for single devices: of a device fault that does not say what to do, the
// command that looks for its cause.
int FailAtDevice(Error error, const std::string& config);

}  // namespace turnlight::app
