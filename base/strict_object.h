// Reads objects of JSON and YAML files strictly: every key is known, every value is of the right
// kind and in its range, and every refusal names file, key, value and what is allowed.
//
// Usage:
//   StrictObject object(document.Root());
//   const double radius = object.Number("radius", {.above = 0.0});
//   const auto mask = object.OptionalString("mask");
//   if (Status status = object.Finish(); !status) return Forward(status);
//
// The first refusal is kept, later reads return harmless defaults, and Finish() reports it (or the
// first key that nobody asked for): a reader is straight-line code with one check at its end.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/document.h"
#include "base/result.h"

namespace turnlight {

// The allowed interval of a number; finite is required unless allow_nonfinite.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  double above = -std::numeric_limits<double>::infinity();  // exclusive lower end
};

class StrictObject {
 public:
  // The document must outlive the reader. pointer is the JSON pointer of value within it.
  explicit StrictObject(const Document& document);
  StrictObject(const Document& document, const nlohmann::json& value, std::string pointer);

  bool Has(std::string_view key);

  double Number(std::string_view key, Range range = {});
  std::optional<double> OptionalNumber(std::string_view key, Range range = {});
  std::int64_t Integer(std::string_view key, std::int64_t min, std::int64_t max);
  std::optional<std::int64_t> OptionalInteger(std::string_view key, std::int64_t min,
                                              std::int64_t max);
  bool Boolean(std::string_view key);
  std::optional<bool> OptionalBoolean(std::string_view key);
  std::string String(std::string_view key);
  std::optional<std::string> OptionalString(std::string_view key);
  // One of the listed words.
  std::string Choice(std::string_view key, const std::vector<std::string>& allowed);
  std::optional<std::string> OptionalChoice(std::string_view key,
                                            const std::vector<std::string>& allowed);
  // A list of exactly count finite numbers, each in range.
  std::vector<double> Numbers(std::string_view key, std::size_t count, Range range = {});
  std::optional<std::vector<double>> OptionalNumbers(std::string_view key, std::size_t count,
                                                     Range range = {});
  // A list of at least one finite number, each in range.
  std::optional<std::vector<double>> OptionalList(std::string_view key, Range range = {});
  // rows x columns finite numbers, row by row.
  std::vector<double> Matrix(std::string_view key, std::size_t rows, std::size_t columns);

  // A nested object; its refusals are reported by its own Finish().
  StrictObject Object(std::string_view key);
  std::optional<StrictObject> OptionalObject(std::string_view key);
  // The objects of a list with at least min_count elements.
  std::vector<StrictObject> Objects(std::string_view key, std::size_t min_count);
  // The raw value, marked as read; null if absent.
  const nlohmann::json& Raw(std::string_view key);

  // Accepts any value under keys that begin so, such as "x-".
  void AllowPrefix(std::string prefix);
  void Ignore(std::string_view key);
  // Passes over keys that it does not know, for files that a newer program may have written. What
  // looks like the misspelling of a missing key is still named.
  void AllowUnknown() { allows_unknown_ = true; }

  // Records a refusal of key's value: "FILE: KEY: VALUE, allowed is ...".
  void Refuse(std::string_view key, std::string_view allowed);
  // Records a refusal in free words.
  void RefuseText(std::string_view key, std::string_view text);
  // Takes over what an object within it refused.
  void Adopt(const Status& inner);
  bool ok() const { return !error_; }

  // The first refusal, or the first unknown key, or success. Instead of a missing key its
  // misspelling is named, if it is there.
  Status Finish();
  // "FILE: KEY" or "FILE:LINE: KEY" for messages about this object's key.
  std::string Where(std::string_view key) const;

 private:
  const nlohmann::json* Find(std::string_view key);
  // Refuses an object without the key.
  const nlohmann::json* Require(std::string_view key, const std::string& allowed);
  std::optional<double> ReadNumber(std::string_view key, const nlohmann::json& value, Range range);

  const Document* document_;
  const nlohmann::json* value_;
  std::string pointer_;
  std::set<std::string, std::less<>> known_;
  std::vector<std::string> prefixes_;
  bool allows_unknown_ = false;
  std::optional<Error> error_;
  std::string missing_;  // if that is what the error says
};

}  // namespace turnlight
