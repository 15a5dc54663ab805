// An open serial port: bytes in and out, without waiting. The real thing is libserialport, for
// every device that the system knows as a serial port; a pseudo-terminal, which it does not know,
// is opened by termios.
//
// A port is held by one program at a time: an advisory lock (flock) on the device itself, which
// ends with its holder, and the refusal names the holder. Not for several threads at once.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "base/result.h"

namespace turnlight::rig::serial {

enum class FlowControl { kNone, kXonXoff, kRtsCts };

// 8 data bits, no parity, 1 stop bit.
struct LineSettings {
  int baud = 115200;  // 50..4000000
  FlowControl flow = FlowControl::kNone;
};

class SerialLink {
 public:
  virtual ~SerialLink() = default;
  // To wait on with poll(2).
  virtual int handle() const = 0;
  // What has come, up to 64 KiB; empty if nothing. Fails (kDevice) when the other end is gone.
  virtual Result<std::string> Read() = 0;
  // Hands over what the port takes now; gives how much that was. Fails (kDevice) like Read.
  virtual Result<std::size_t> Write(std::string_view bytes) = 0;
  // What opened it, for doctor: "libserialport" or "termios (pseudo-terminal)".
  virtual std::string Backend() const = 0;
};

// path: of a device, symbolic links are followed. Fails (kDevice): it is not there, no serial port,
// may not be opened (with the line that mends that), or another program holds it (with its name).
Result<std::unique_ptr<SerialLink>> OpenSerialLink(const std::string& path,
                                                   const LineSettings& settings);

// The programs that have the device open, as "NAME (process PID)", as far as this user may see;
// this process aside.
std::string HoldersOf(const std::string& path);

}  // namespace turnlight::rig::serial
