// Checks and reads the fields of a simulation's config structs: ranges refuse in the same words
// everywhere.
#pragma once

#include <optional>
#include <string>

#include "base/strict_object.h"

namespace turnlight::rig::sim {

// The first thing that is wrong with a config: its key, such as "motion/distance", and the value
// with what is allowed.
struct ConfigProblem {
  std::string key;
  std::string text;
};

// "%.9g".
std::string ShowNumber(double value);

// Keeps the first refusal, so that checks read as a list.
class ConfigChecker {
 public:
  void From(const std::string& key, double value, double min, double max);
  void Above(const std::string& key, double value, double above, double max,
             const std::string& because = "");
  void Require(bool good, const std::string& key, const std::string& text);
  const std::optional<ConfigProblem>& problem() const { return problem_; }

 private:
  std::optional<ConfigProblem> problem_;
};

// Overwrite value if the key is there; Validate judges the range.
void ReadField(StrictObject& object, const char* key, double& value);
void ReadField(StrictObject& object, const char* key, int& value);
void ReadField(StrictObject& object, const char* key, std::string& value);

}  // namespace turnlight::rig::sim
