// What a call that can fail returns: a value, or an Error that the caller must look at.
//
// Three kinds of failure are never mixed: a bug is an assert; bad input of a user is an Error of
// kind kInput that names file, key, value and what was allowed; a fault of hardware or data is an
// Error of its own kind. Nothing in turnlight throws across a public function.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace turnlight {

enum class ErrorKind {
  kInput,        // usage, configuration or input refused: exit code 2
  kIncomplete,   // some frames lost, the rest kept: exit code 3
  kDevice,       // a device fault: exit code 4
  kNoEstimate,   // the data give no usable estimate: exit code 5
  kInterrupted,  // asked to end before it was done: exit code 130
  kSystem,       // the file system or the operating system said no: exit code 2
};

struct Error {
  ErrorKind kind = ErrorKind::kInput;
  std::string text;  // one line or more, for a person: what, where, measured against allowed
};

template <typename T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

inline tl::unexpected<Error> InputError(std::string text) {
  return tl::unexpected<Error>(Error{ErrorKind::kInput, std::move(text)});
}
inline tl::unexpected<Error> SystemError(std::string text) {
  return tl::unexpected<Error>(Error{ErrorKind::kSystem, std::move(text)});
}
// What a device's call returns when it cannot do its part.
inline tl::unexpected<Error> DeviceError(std::string text) {
  return tl::unexpected<Error>(Error{ErrorKind::kDevice, std::move(text)});
}
inline tl::unexpected<Error> NoEstimateError(std::string text) {
  return tl::unexpected<Error>(Error{ErrorKind::kNoEstimate, std::move(text)});
}
inline tl::unexpected<Error> InterruptedError() {
  return tl::unexpected<Error>(Error{ErrorKind::kInterrupted, "interrupted"});
}
// Passes an error on from a Result of another type.
template <typename T>
tl::unexpected<Error> Forward(const Result<T>& result) {
  return tl::unexpected<Error>(result.error());
}

}  // namespace turnlight
