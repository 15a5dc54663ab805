#include "rig/sim/config_fields.h"

#include <cstdio>

namespace turnlight::rig::sim {
namespace {

// Wide enough that Validate is the one that judges.
constexpr std::int64_t kAnyInteger = 1'000'000'000;

}  // namespace

std::string ShowNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void ConfigChecker::From(const std::string& key, double value, double min, double max) {
  Require(value >= min && value <= max, key,
          ShowNumber(value) + ", allowed is a number from " + ShowNumber(min) + " to " +
              ShowNumber(max));
}

void ConfigChecker::Above(const std::string& key, double value, double above, double max,
                          const std::string& because) {
  Require(value > above && value <= max, key,
          ShowNumber(value) + ", allowed is a number above " + ShowNumber(above) +
              (because.empty() ? "" : " (" + because + ")") + " and at most " + ShowNumber(max));
}

void ConfigChecker::Require(bool good, const std::string& key, const std::string& text) {
  if (!good && !problem_) problem_ = ConfigProblem{key, text};
}

void ReadField(StrictObject& object, const char* key, double& value) {
  value = object.OptionalNumber(key).value_or(value);
}

void ReadField(StrictObject& object, const char* key, int& value) {
  value = static_cast<int>(object.OptionalInteger(key, -kAnyInteger, kAnyInteger).value_or(value));
}

void ReadField(StrictObject& object, const char* key, std::string& value) {
  value = object.OptionalString(key).value_or(value);
}

}  // namespace turnlight::rig::sim
