// A file's text as a tree of values, with what it takes to name their places in messages.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace turnlight {

// A parsed file. Values are JSON whatever the file's syntax; lines are known for YAML.
struct Document {
  std::string file;  // as shown in messages
  nlohmann::json root;
  std::map<std::string, int> lines;  // JSON pointer -> line (from 1), YAML only
};

// file is only for messages. Fails (kInput) on a syntax error, with its line; on duplicate keys;
// and on nesting deeper than 32 levels.
Result<Document> ParseJson(std::string_view text, std::string file);
Result<Document> ParseYaml(const std::string& text, std::string file);

// A value as messages show it: on one line, at most 80 characters.
std::string ShowValue(const nlohmann::json& value);

}  // namespace turnlight
