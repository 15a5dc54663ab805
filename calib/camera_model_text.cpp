#include "calib/camera_model_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

namespace turnlight::calib {
namespace {

constexpr std::array<std::string_view, 4> kNeeded{"lensmodel", "intrinsics", "extrinsics",
                                                  "imagersize"};

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool IsOpening(char c) { return c == '[' || c == '('; }
bool IsClosing(char c) { return c == ']' || c == ')'; }
bool EndsWord(char c) {
  return IsBlank(c) || IsOpening(c) || IsClosing(c) || c == ',' || c == '#' || c == ':' ||
         c == '{' || c == '}' || c == '\'' || c == '"';
}

// What can be shown of hostile text in a message.
std::string Show(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 60)) shown += c >= ' ' && c <= '~' ? c : '?';
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

void ReadKey(Scanner& scanner, std::set<std::string, std::less<>>& seen, CameraModelText& model) {
  const std::string_view name = scanner.String("a key");
  const std::string where = "'" + Show(name) + "'";
  scanner.Expect(':', where);
  const bool needed = std::find(kNeeded.begin(), kNeeded.end(), name) != kNeeded.end();
  if (needed && !seen.emplace(name).second)
    scanner.Fail(where + ": this key appears more than once");
  if (name == "lensmodel") {
    model.lens_model = std::string(scanner.String(where));
  } else if (name == "intrinsics") {
    model.intrinsics = scanner.Numbers(where);
  } else if (name == "extrinsics") {
    const std::size_t count = scanner.Numbers(where).size();
    if (count != 6) scanner.Fail(where + ": " + std::to_string(count) + " numbers, allowed are 6");
  } else if (name == "imagersize") {
    model.imager_size = scanner.Numbers(where);
    if (model.imager_size.size() != 2)
      scanner.Fail(where + ": " + std::to_string(model.imager_size.size()) +
                   " numbers, allowed are 2, width and height");
  } else {
    scanner.Skip(where);
  }
}

}  // namespace

Result<CameraModelText> ReadCameraModelText(std::string_view text, const std::string& file) {
  if (text.size() > kMaxCameraModelBytes)
    return InputError(file + ": " + std::to_string(text.size()) + " bytes, allowed are at most " +
                      std::to_string(kMaxCameraModelBytes));
  CameraModelText model;
  std::set<std::string, std::less<>> seen;
  Scanner scanner(text, file);
  scanner.Expect('{', "a camera model");
  while (!scanner.error() && scanner.Peek() != '}') {
    ReadKey(scanner, seen, model);
    if (!scanner.Take(',') && scanner.Peek() != '}')
      scanner.Fail("after a value: " + scanner.Next() + ", allowed is ',' or '}'");
  }
  scanner.Expect('}', "the end");
  if (!scanner.error() && scanner.Next() != "the text ends")
    scanner.Fail("after the closing '}': " + scanner.Next() + ", allowed is nothing");
  if (scanner.error()) return tl::unexpected<Error>(*scanner.error());
  for (const std::string_view key : kNeeded)
    if (!seen.contains(key))
      return InputError(file + ": '" + std::string(key) + "': this key is missing");
  return model;
}

}  // namespace turnlight::calib
