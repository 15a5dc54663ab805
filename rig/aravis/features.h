// A camera's features by name: the nodes of its GenICam description, read and written with errors
// as values. For one thread; every call may take as long as Aravis waits for a dead camera (2.5 s).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/aravis/gobject.h"

namespace turnlight::rig::aravis {

struct NumberBounds {
  double min = 0.0, max = 0.0;
};

class Features {
 public:
  // The device outlives it.
  explicit Features(ArvDevice* device) : device_(device) {}

  // There, be it usable now or not.
  bool Exists(const std::string& name);
  // There, and usable as the camera is set now.
  bool Has(const std::string& name);
  // The first of these names that the camera has; empty if none. Standard names first, their older
  // spellings after them.
  std::string FirstOf(std::initializer_list<const char*> names);

  // Integer and float features alike; a whole number is rounded to.
  bool IsFloat(const std::string& name);
  std::string Unit(const std::string& name);  // as the camera says, or empty
  Result<double> Number(const std::string& name);
  Result<std::int64_t> Integer(const std::string& name);
  Result<NumberBounds> Bounds(const std::string& name);
  Status SetNumber(const std::string& name, double value);

  // Enumerations and strings.
  Result<std::string> Word(const std::string& name);
  std::vector<std::string> Words(const std::string& name);  // what may be set now
  bool Allows(const std::string& name, const std::string& word);
  Status SetWord(const std::string& name, const std::string& word);

  Result<bool> IsOff(const std::string& name);
  // Switches off a boolean, an enumeration with "Off", or a number; reads back that it is.
  Status SwitchOff(const std::string& name);

  Status Execute(const std::string& name);
  Result<std::uint32_t> Register(std::uint64_t address);

  // Some call since the beginning found that the camera does not answer, or not to us. All after it
  // fail at once.
  bool lost() const { return lost_; }
  void Lose() { lost_ = true; }

 private:
  template <typename F>
  auto Ask(const std::string& name, F call) -> Result<decltype(call(nullptr))>;
  ArvGcNode* Node(const std::string& name) { return arv_device_get_feature(device_, name.c_str()); }

  ArvDevice* device_;
  bool lost_ = false;
};

}  // namespace turnlight::rig::aravis
