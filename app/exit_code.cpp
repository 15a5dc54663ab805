#include "app/exit_code.h"

#include <iostream>

#include "base/printable.h"

namespace turnlight::app {
namespace {

int ExitCodeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInput:
    case ErrorKind::kSystem:
      return kRefused;
    case ErrorKind::kIncomplete:
      return kIncomplete;
    case ErrorKind::kDevice:
      return kDeviceFault;
    case ErrorKind::kNoEstimate:
      return kNoEstimate;
    case ErrorKind::kInterrupted:
      return kInterrupted;
  }
  return kRefused;
}

}  // namespace

int Fail(const Error& error) {
  std::cerr << "turnlight: " << Printable(error.text) << std::endl;
  return ExitCodeOf(error.kind);
}

int FailAtDevice(Error error, const std::string& config) {
  if (error.kind == ErrorKind::kDevice && error.text.find("turnlight ") == std::string::npos)
    error.text += "; turnlight doctor " + config + " looks for the cause";
  return Fail(error);
}

}  // namespace turnlight::app
