// Lets Aravis' fake camera listen on any address of the loopback. It listens only on addresses that
// the system's list of interfaces has; all of 127.0.0.0/8 is the loopback's, but the list has one
// address of it. So this file has the program's getifaddrs: the system's, but for a thread that is
// starting a camera.
#pragma once

#include <string>

namespace turnlight::rig::sim::gige {

// While one lives, the list of interfaces that this thread gets is the loopback with that address,
// if it is one of 127.0.0.0/8; else nothing changes.
class LoopbackInterface {
 public:
  explicit LoopbackInterface(const std::string& address);
  ~LoopbackInterface();
  LoopbackInterface(const LoopbackInterface&) = delete;
  LoopbackInterface& operator=(const LoopbackInterface&) = delete;
};

}  // namespace turnlight::rig::sim::gige
