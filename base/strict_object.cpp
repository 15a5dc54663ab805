#include "base/strict_object.h"

#include <cmath>
#include <utility>

#include "base/format.h"
#include "base/nearest.h"

namespace turnlight {
namespace {

using nlohmann::json;

std::string ShowRange(Range range) {
  std::string text = "a finite number";
  if (std::isfinite(range.above)) text += " above " + NumberText(range.above);
  if (std::isfinite(range.min)) text += " of at least " + NumberText(range.min);
  if (std::isfinite(range.max)) text += " of at most " + NumberText(range.max);
  return text;
}

std::string ShowIntegers(std::int64_t min, std::int64_t max) {
  return "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
}

std::string ShowNumbers(std::size_t count, Range range) {
  return "a list of " + std::to_string(count) + ", each " + ShowRange(range);
}

std::string ShowChoice(const std::vector<std::string>& allowed) {
  return "one of " + Listed(allowed);
}

constexpr const char* kBoolean = "true or false";
constexpr const char* kText = "a text";
constexpr const char* kObject = "an object of keys and values";

bool InRange(double value, Range range) {
  return std::isfinite(value) && value >= range.min && value <= range.max && value > range.above;
}

std::string PlainPointer(const std::string& pointer) {
  return pointer.empty() ? pointer : pointer.substr(1);
}

}  // namespace

StrictObject::StrictObject(const Document& document)
    : StrictObject(document, document.root, std::string()) {}

StrictObject::StrictObject(const Document& document, const json& value, std::string pointer)
    : document_(&document), value_(&value), pointer_(std::move(pointer)) {
  if (!value.is_object())
    error_ =
        Error{ErrorKind::kInput, Where("") + ": " + ShowValue(value) + ", allowed is " + kObject};
}

std::string StrictObject::Where(std::string_view key) const {
  const std::string pointer = key.empty() ? pointer_ : pointer_ + "/" + std::string(key);
  std::string text = document_->file;
  for (std::string at = pointer; !document_->lines.empty(); at = at.substr(0, at.rfind('/'))) {
    const auto line = document_->lines.find(at);
    if (line != document_->lines.end()) {
      text += ":" + std::to_string(line->second);
      break;
    }
    if (at.empty()) break;
  }
  return pointer.empty() ? text : text + ": " + PlainPointer(pointer);
}

void StrictObject::Adopt(const Status& inner) {
  if (!inner && !error_) error_ = inner.error();
}

void StrictObject::RefuseText(std::string_view key, std::string_view text) {
  if (!error_) error_ = Error{ErrorKind::kInput, Where(key) + ": " + std::string(text)};
}

void StrictObject::Refuse(std::string_view key, std::string_view allowed) {
  const json* value =
      value_->is_object() && value_->contains(key) ? &value_->at(std::string(key)) : nullptr;
  RefuseText(key, (value ? ShowValue(*value) : "missing") + ", allowed is " + std::string(allowed));
}

const json* StrictObject::Find(std::string_view key) {
  known_.emplace(key);
  if (!value_->is_object()) return nullptr;
  const auto found = value_->find(std::string(key));
  return found != value_->end() ? &*found : nullptr;
}

const json* StrictObject::Require(std::string_view key, const std::string& allowed) {
  if (const json* value = Find(key)) return value;
  if (!error_) missing_ = key;
  RefuseText(key, "this key is missing, allowed is " + allowed);
  return nullptr;
}

bool StrictObject::Has(std::string_view key) {
  return value_->is_object() && value_->contains(std::string(key));
}

std::optional<double> StrictObject::ReadNumber(std::string_view key, const json& value,
                                               Range range) {
  if (value.is_number() && InRange(value.get<double>(), range)) return value.get<double>();
  Refuse(key, ShowRange(range));
  return std::nullopt;
}

std::optional<double> StrictObject::OptionalNumber(std::string_view key, Range range) {
  const json* value = Find(key);
  return value ? ReadNumber(key, *value, range) : std::nullopt;
}

double StrictObject::Number(std::string_view key, Range range) {
  const json* value = Require(key, ShowRange(range));
  return value ? ReadNumber(key, *value, range).value_or(0.0) : 0.0;
}

std::optional<std::int64_t> StrictObject::OptionalInteger(std::string_view key, std::int64_t min,
                                                          std::int64_t max) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  const bool fits = value->is_number_unsigned()
                        ? value->get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)
                        : value->is_number_integer();
  if (fits && value->get<std::int64_t>() >= min && value->get<std::int64_t>() <= max)
    return value->get<std::int64_t>();
  Refuse(key, ShowIntegers(min, max));
  return std::nullopt;
}

std::int64_t StrictObject::Integer(std::string_view key, std::int64_t min, std::int64_t max) {
  if (!Require(key, ShowIntegers(min, max))) return min;
  return OptionalInteger(key, min, max).value_or(min);
}

std::optional<bool> StrictObject::OptionalBoolean(std::string_view key) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  if (value->is_boolean()) return value->get<bool>();
  Refuse(key, kBoolean);
  return std::nullopt;
}

bool StrictObject::Boolean(std::string_view key) {
  if (!Require(key, kBoolean)) return false;
  return OptionalBoolean(key).value_or(false);
}

std::optional<std::string> StrictObject::OptionalString(std::string_view key) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  if (value->is_string()) return value->get<std::string>();
  Refuse(key, kText);
  return std::nullopt;
}

std::string StrictObject::String(std::string_view key) {
  if (!Require(key, kText)) return {};
  return OptionalString(key).value_or(std::string());
}

std::optional<std::string> StrictObject::OptionalChoice(std::string_view key,
                                                        const std::vector<std::string>& allowed) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  for (const std::string& word : allowed)
    if (value->is_string() && value->get<std::string>() == word) return word;
  Refuse(key, ShowChoice(allowed));
  return std::nullopt;
}

std::string StrictObject::Choice(std::string_view key, const std::vector<std::string>& allowed) {
  if (!Require(key, ShowChoice(allowed))) return allowed.front();
  return OptionalChoice(key, allowed).value_or(allowed.front());
}

std::optional<std::vector<double>> StrictObject::OptionalNumbers(std::string_view key,
                                                                 std::size_t count, Range range) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  bool fits = value->is_array() && value->size() == count;
  std::vector<double> numbers;
  for (std::size_t i = 0; fits && i < count; ++i) {
    const json& element = (*value)[i];
    fits = element.is_number() && InRange(element.get<double>(), range);
    if (fits) numbers.push_back(element.get<double>());
  }
  if (fits) return numbers;
  Refuse(key, ShowNumbers(count, range));
  return std::nullopt;
}

std::optional<std::vector<double>> StrictObject::OptionalList(std::string_view key, Range range) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  if (value->is_array() && !value->empty()) return OptionalNumbers(key, value->size(), range);
  Refuse(key, "a list of numbers, at least one, each " + ShowRange(range));
  return std::nullopt;
}

std::vector<double> StrictObject::Numbers(std::string_view key, std::size_t count, Range range) {
  std::vector<double> zeros(count, 0.0);
  if (!Require(key, ShowNumbers(count, range))) return zeros;
  return OptionalNumbers(key, count, range).value_or(zeros);
}

std::vector<double> StrictObject::Matrix(std::string_view key, std::size_t rows,
                                         std::size_t columns) {
  const std::string allowed =
      std::to_string(rows) + " rows of " + std::to_string(columns) + " finite numbers";
  std::vector<double> numbers;
  const json* value = Require(key, allowed);
  bool fits = value && value->is_array() && value->size() == rows;
  for (std::size_t r = 0; fits && r < rows; ++r) {
    fits = (*value)[r].is_array() && (*value)[r].size() == columns;
    for (std::size_t c = 0; fits && c < columns; ++c) {
      const json& element = (*value)[r][c];
      fits = element.is_number() && std::isfinite(element.get<double>());
      if (fits) numbers.push_back(element.get<double>());
    }
  }
  if (fits) return numbers;
  if (value) Refuse(key, allowed);
  return std::vector<double>(rows * columns, 0.0);
}

std::optional<StrictObject> StrictObject::OptionalObject(std::string_view key) {
  const json* value = Find(key);
  if (!value) return std::nullopt;
  return StrictObject(*document_, *value, pointer_ + "/" + std::string(key));
}

StrictObject StrictObject::Object(std::string_view key) {
  static const json kEmpty = json::object();
  const json* value = Require(key, kObject);
  return StrictObject(*document_, value ? *value : kEmpty, pointer_ + "/" + std::string(key));
}

std::vector<StrictObject> StrictObject::Objects(std::string_view key, std::size_t min_count) {
  std::vector<StrictObject> objects;
  const std::string allowed = "a list of objects, at least " + std::to_string(min_count);
  const json* value = Require(key, allowed);
  if (!value) return objects;
  if (!value->is_array() || value->size() < min_count) {
    Refuse(key, allowed);
    return objects;
  }
  for (std::size_t i = 0; i < value->size(); ++i)
    objects.emplace_back(*document_, (*value)[i],
                         pointer_ + "/" + std::string(key) + "/" + std::to_string(i));
  return objects;
}

const json& StrictObject::Raw(std::string_view key) {
  static const json kNull;
  const json* value = Find(key);
  return value ? *value : kNull;
}

void StrictObject::AllowPrefix(std::string prefix) { prefixes_.push_back(std::move(prefix)); }

void StrictObject::Ignore(std::string_view key) { known_.emplace(key); }

Status StrictObject::Finish() {
  if (error_ && missing_.empty()) return tl::unexpected<Error>(*error_);
  for (const auto& entry : value_->items()) {
    bool allowed = known_.contains(entry.key());
    for (const std::string& prefix : prefixes_) allowed |= entry.key().starts_with(prefix);
    // Of a missing key only its misspelling is of interest: others may not have been asked for yet.
    allowed |=
        error_ ? Nearest(entry.key(), std::vector<std::string>{missing_}).empty() : allows_unknown_;
    if (!allowed)
      return InputError(Where(entry.key()) + ": unknown key, allowed are " +
                        Listed({known_.begin(), known_.end()}) + DidYouMean(entry.key(), known_));
  }
  return error_ ? Status(tl::unexpected<Error>(*error_)) : Status();
}

}  // namespace turnlight
