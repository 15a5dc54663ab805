#include "calib/camera_model_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/printable.h"

namespace turnlight::calib {
namespace {

// The names of the lens model's key; the first that is there counts, as with mrcal.
constexpr std::array<std::string_view, 3> kLensModelKeys{"lensmodel", "distortion_model",
                                                         "lens_model"};
constexpr std::array<std::string_view, 2> kExtrinsicsKeys{"extrinsics", "rt_cam_ref"};

template <std::size_t N>
bool IsOneOf(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool IsOpening(char c) { return c == '[' || c == '('; }
bool IsClosing(char c) { return c == ']' || c == ')'; }
bool EndsWord(char c) {
  return IsBlank(c) || IsOpening(c) || IsClosing(c) || c == ',' || c == '#' || c == ':' ||
         c == '{' || c == '}' || c == '\'' || c == '"';
}

// What can be shown of hostile text in a message.
std::string Show(std::string_view text) {
  const std::string shown = Printable(text.substr(0, 60));
  return text.size() > 60 ? shown + "..." : shown;
}

// Walks through the text; the first problem is kept, and then everything reads as empty.
class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  // The next character that is neither blank nor in a comment; 0 at the end.
  char Peek() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (IsBlank(text_[at_]))
        ++at_;
      else
        return text_[at_];
    }
    return '\0';
  }

  bool Take(char c) {
    if (error_ || Peek() != c || at_ >= text_.size()) return false;
    ++at_;
    return true;
  }

  void Expect(char c, const std::string& where) {
    if (!Take(c)) Fail(where + ": " + Next() + ", allowed is '" + c + "'");
  }

  // A quoted text; a b in front is Python's mark of bytes.
  std::string_view String(const std::string& where) {
    if (Peek() == 'b' && at_ + 1 < text_.size()) ++at_;
    const char quote = Peek();
    if (error_ || (quote != '\'' && quote != '"')) {
      Fail(where + ": " + Next() + ", allowed is a text in quotes");
      return {};
    }
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) {
      Fail(where + ": the closing quote is missing");
      return {};
    }
    const std::string_view value = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return value;
  }

  std::vector<double> Numbers(const std::string& where) {
    std::vector<double> numbers;
    if (!Take('[') && !Take('(')) {
      Fail(where + ": " + Next() + ", allowed is a list of numbers");
      return {};
    }
    while (!error_ && !IsClosing(Peek())) {
      numbers.push_back(Number(where));
      if (!Take(',') && !IsClosing(Peek()))
        Fail(where + ": " + Next() + " after " + std::to_string(numbers.size()) +
             " numbers, allowed is ',' or ']'");
    }
    if (!error_) ++at_;
    return numbers;
  }

  // Any value of a key that is not ours: a text, a word, or a nested list of such.
  void Skip(const std::string& where) {
    int depth = 0;
    do {
      const char c = Peek();
      if (IsOpening(c)) {
        ++depth;
        ++at_;
      } else if (IsClosing(c) && depth > 0) {
        --depth;
        ++at_;
      } else if (c == ',' && depth > 0) {
        ++at_;
      } else if (c == '\'' || c == '"' ||
                 (c == 'b' && at_ + 1 < text_.size() &&
                  (text_[at_ + 1] == '\'' || text_[at_ + 1] == '"'))) {
        String(where);
      } else if (Word().empty()) {
        Fail(where + ": " + Next() + ", allowed is a text, a number or a list");
      }
    } while (!error_ && depth > 0);
  }

  void Fail(const std::string& text) {
    if (error_) return;
    const auto line =
        std::count(text_.begin(),
                   text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size())), '\n');
    error_ = Error{ErrorKind::kInput, file_ + ":" + std::to_string(line + 1) + ": " + text};
  }

  // The next thing in the text, for messages.
  std::string Next() {
    if (Peek() == '\0' && at_ >= text_.size()) return "the text ends";
    const std::string_view word = PeekWord();
    return "'" + Show(word.empty() ? text_.substr(at_, 1) : word) + "'";
  }

  const std::optional<Error>& error() const { return error_; }

 private:
  std::string_view PeekWord() {
    Peek();
    std::size_t end = at_;
    while (end < text_.size() && !EndsWord(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }
  std::string_view Word() {
    const std::string_view word = PeekWord();
    at_ += word.size();
    return word;
  }
  double Number(const std::string& where) {
    const std::string_view word = PeekWord();
    double value = 0.0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || code != std::errc() || end != word.data() + word.size() ||
        !std::isfinite(value)) {
      Fail(where + ": " + Next() + ", allowed is a finite number");
      return 0.0;
    }
    at_ += word.size();
    return value;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::optional<Error> error_;
};

// What was read, and under which names.
struct ReadKeys {
  CameraModelText model;
  std::map<std::string_view, std::string> lens_models;  // by key
  std::set<std::string_view> seen;
};

void ReadKey(Scanner& scanner, ReadKeys& keys) {
  const std::string_view name = scanner.String("a key");
  const std::string where = "'" + Show(name) + "'";
  scanner.Expect(':', where);
  const bool lens_model = IsOneOf(kLensModelKeys, name);
  const bool extrinsics = IsOneOf(kExtrinsicsKeys, name);
  const bool ours = lens_model || extrinsics || name == "intrinsics" || name == "imagersize";
  if (ours && !keys.seen.insert(name).second)
    scanner.Fail(where + ": this key appears more than once");
  if (lens_model) {
    keys.lens_models[name] = std::string(scanner.String(where));
  } else if (name == "intrinsics") {
    keys.model.intrinsics = scanner.Numbers(where);
  } else if (extrinsics) {
    const std::size_t count = scanner.Numbers(where).size();
    if (count != 6) scanner.Fail(where + ": " + std::to_string(count) + " numbers, allowed are 6");
  } else if (name == "imagersize") {
    keys.model.imager_size = scanner.Numbers(where);
    if (keys.model.imager_size.size() != 2)
      scanner.Fail(where + ": " + std::to_string(keys.model.imager_size.size()) +
                   " numbers, allowed are 2, width and height");
  } else {
    scanner.Skip(where);
  }
}

// A lens model by its name of today.
std::string CurrentLensModel(std::string name) {
  constexpr std::string_view kFormer = "DISTORTION", kNow = "LENSMODEL";
  for (std::size_t at = 0; (at = name.find(kFormer, at)) != std::string::npos; at += kNow.size())
    name.replace(at, kFormer.size(), kNow);
  return name == "LENSMODEL_NONE" ? "LENSMODEL_PINHOLE" : name;
}

template <std::size_t N>
bool SeenAny(const std::set<std::string_view>& seen, const std::array<std::string_view, N>& names) {
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return seen.contains(name); });
}

// The first key that is missing under all its names, by its name of today; empty if none is.
std::string_view MissingKey(const std::set<std::string_view>& seen) {
  if (!SeenAny(seen, kLensModelKeys)) return kLensModelKeys.front();
  if (!seen.contains("intrinsics")) return "intrinsics";
  if (!SeenAny(seen, kExtrinsicsKeys)) return kExtrinsicsKeys.front();
  return seen.contains("imagersize") ? "" : "imagersize";
}

}  // namespace

Result<CameraModelText> ReadCameraModelText(std::string_view text, const std::string& file) {
  if (text.size() > kMaxCameraModelBytes)
    return InputError(file + ": " + std::to_string(text.size()) + " bytes, allowed are at most " +
                      std::to_string(kMaxCameraModelBytes));
  ReadKeys keys;
  Scanner scanner(text, file);
  scanner.Expect('{', "a camera model");
  while (!scanner.error() && scanner.Peek() != '}') {
    ReadKey(scanner, keys);
    if (!scanner.Take(',') && scanner.Peek() != '}')
      scanner.Fail("after a value: " + scanner.Next() + ", allowed is ',' or '}'");
  }
  scanner.Expect('}', "the end");
  if (!scanner.error() && scanner.Next() != "the text ends")
    scanner.Fail("after the closing '}': " + scanner.Next() + ", allowed is nothing");
  if (scanner.error()) return tl::unexpected<Error>(*scanner.error());
  if (const std::string_view missing = MissingKey(keys.seen); !missing.empty())
    return InputError(file + ": '" + std::string(missing) + "': this key is missing");
  const auto counts =
      std::find_if(kLensModelKeys.begin(), kLensModelKeys.end(),
                   [&](std::string_view name) { return keys.lens_models.contains(name); });
  keys.model.lens_model = CurrentLensModel(keys.lens_models.at(*counts));
  return std::move(keys.model);
}

}  // namespace turnlight::calib
