// One camera on an address. Aravis' fake shares its port with any other camera without a word, so
// an address is held by a name that the system gives to one process only and takes back at its end.
#pragma once

#include <string>

#include "base/result.h"

namespace turnlight::rig::sim::gige {

class AddressLock {
 public:
  // Fails (kInput): it is no address of this machine, or it is taken; names the process if that is
  // a simulator, too.
  static Result<AddressLock> Take(const std::string& address);
  ~AddressLock();
  AddressLock(AddressLock&& other) noexcept;
  AddressLock& operator=(AddressLock&&) = delete;

 private:
  explicit AddressLock(int fd) : fd_(fd) {}
  int fd_;
};

// Whether nobody listens for control packets there. Fails (kInput) if it is no address of this
// machine.
Result<bool> IsFree(const std::string& address);

}  // namespace turnlight::rig::sim::gige
