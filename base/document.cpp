#include "base/document.h"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace turnlight {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 32;
constexpr std::size_t kMaxYamlValues = 100000;

// The JSON parser keeps the last of two equal keys silently; this one refuses them.
class DuplicateKeys {
 public:
  bool operator()(int depth, json::parse_event_t event, const json& parsed) {
    if (depth > kMaxDepth && problem_.empty())
      problem_ = "nested more than " + std::to_string(kMaxDepth) + " levels deep";
    if (event == json::parse_event_t::object_start) keys_.emplace_back();
    if (event == json::parse_event_t::object_end) keys_.pop_back();
    if (event == json::parse_event_t::key &&
        !keys_.back().insert(parsed.get<std::string>()).second && problem_.empty())
      problem_ = "the key " + ShowValue(parsed) + " appears twice in one object";
    return true;
  }
  const std::string& problem() const { return problem_; }

 private:
  std::vector<std::set<std::string>> keys_;
  std::string problem_;
};

// nlohmann's parser recurses per level when a value is destroyed; a cheap scan bounds it
// beforehand.
bool NestedTooDeep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxDepth) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

// Decimal numbers only: yaml-cpp's own conversion reads 010 as 8 and depends on the locale.
std::optional<json> PlainNumber(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.find_first_not_of("0123456789+-.eE") != std::string_view::npos) return std::nullopt;
  const char* end = text.data() + text.size();
  std::int64_t integer = 0;
  if (const auto read = std::from_chars(text.data(), end, integer);
      read.ec == std::errc() && read.ptr == end)
    return integer;
  double number = 0.0;
  if (const auto read = std::from_chars(text.data(), end, number);
      read.ec == std::errc() && read.ptr == end)
    return number;
  return std::nullopt;
}

json ScalarToJson(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str") return text;  // quoted, or !!str
  if (text == "null" || text == "~" || text.empty()) return nullptr;
  if (text == "true") return true;
  if (text == "false") return false;
  return PlainNumber(text).value_or(json(text));
}

Result<json> NodeToJson(const YAML::Node& node, const std::string& pointer, int depth,
                        Document& document) {
  document.lines[pointer] = node.Mark().line + 1;
  // Aliases of aliases expand without bound.
  if (document.lines.size() > kMaxYamlValues)
    return InputError(document.file + ": more than " + std::to_string(kMaxYamlValues) + " values");
  const std::string here = document.file + ":" + std::to_string(node.Mark().line + 1) + ": ";
  if (depth > kMaxDepth)
    return InputError(here + "nested more than " + std::to_string(kMaxDepth) + " levels deep");
  if (node.IsScalar()) return ScalarToJson(node);
  if (node.IsSequence()) {
    json list = json::array();
    for (std::size_t i = 0; i < node.size(); ++i) {
      auto value = NodeToJson(node[i], pointer + "/" + std::to_string(i), depth + 1, document);
      if (!value) return value;
      list.push_back(std::move(*value));
    }
    return list;
  }
  if (node.IsMap()) {
    json object = json::object();
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) return InputError(here + "a key must be a word");
      const std::string key = entry.first.Scalar();
      const int line = entry.first.Mark().line + 1;
      if (object.contains(key))
        return InputError(document.file + ":" + std::to_string(line) + ": the key \"" + key +
                          "\" appears twice in one object");
      auto value = NodeToJson(entry.second, pointer + "/" + key, depth + 1, document);
      if (!value) return value;
      // A value that is an object itself begins only at its first key.
      document.lines[pointer + "/" + key] = line;
      object[key] = std::move(*value);
    }
    return object;
  }
  return json(nullptr);
}

}  // namespace

Result<Document> ParseJson(std::string_view text, std::string file) {
  if (NestedTooDeep(text))
    return InputError(file + ": nested more than " + std::to_string(kMaxDepth) + " levels deep");
  DuplicateKeys duplicates;
  Document document{std::move(file), {}, {}};
  try {
    document.root = json::parse(text.begin(), text.end(), std::ref(duplicates));
  } catch (const json::exception& error) {
    const std::string text = error.what();  // "[json.exception.parse_error.101] parse error at ..."
    return InputError(document.file + ": not valid JSON: " + text.substr(text.find("] ") + 2));
  }
  if (!duplicates.problem().empty()) return InputError(document.file + ": " + duplicates.problem());
  return document;
}

Result<Document> ParseYaml(const std::string& text, std::string file) {
  Document document{std::move(file), {}, {}};
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1)
      return InputError(document.file + ": " + std::to_string(documents.size()) +
                        " documents, allowed is 1");
    auto root = NodeToJson(documents.empty() ? YAML::Node() : documents[0], "", 0, document);
    if (!root) return Forward(root);
    document.root = std::move(*root);
  } catch (const YAML::Exception& error) {
    return InputError(document.file + ":" + std::to_string(error.mark.line + 1) +
                      ": not valid YAML: " + error.msg);
  }
  return document;
}

std::string ShowValue(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 80) text = text.substr(0, 77) + "...";
  return text;
}

}  // namespace turnlight
