#include "base/junit.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace turnlight {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

// The length of the well-formed UTF-8 character that the text begins with and that XML 1.0 allows;
// 0 if there is none.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return first >= ' ' || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  std::uint32_t code = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  const std::uint32_t smallest = length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
  const bool allowed = code >= smallest && code <= 0x10FFFF && code != 0xFFFE && code != 0xFFFF &&
                       !(code >= 0xD800 && code <= 0xDFFF);
  return allowed ? length : 0;
}

// As text of an attribute in double quotes or of an element.
std::string Escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const char first = text[0];
    if (length == 0)
      out += kReplacement;
    else if (first == '&')
      out += "&amp;";
    else if (first == '<')
      out += "&lt;";
    else if (first == '>')
      out += "&gt;";
    else if (first == '"')
      out += "&quot;";
    else if (first == '\t' || first == '\n' || first == '\r')
      out += "&#" + std::to_string(static_cast<int>(first)) + ";";
    else
      out += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string CaseXml(const JunitCase& test) {
  const std::string begin = "  <testcase classname=\"" + Escaped(test.group) + "\" name=\"" +
                            Escaped(test.name) + "\" time=\"0\"";
  const std::string text = Escaped(test.text);
  if (test.outcome == JunitOutcome::kFailed)
    return begin + "><failure message=\"" + text + "\">" + text + "</failure></testcase>\n";
  if (test.outcome == JunitOutcome::kSkipped)
    return begin + "><skipped message=\"" + text + "\"/></testcase>\n";
  if (text.empty()) return begin + "/>\n";
  return begin + "><system-out>" + text + "</system-out></testcase>\n";
}

}  // namespace

std::string JunitXml(const std::string& suite, const std::vector<JunitCase>& cases) {
  const auto count = [&](JunitOutcome outcome) {
    return std::to_string(std::count_if(cases.begin(), cases.end(), [&](const JunitCase& test) {
      return test.outcome == outcome;
    }));
  };
  const std::string totals = "name=\"" + Escaped(suite) + "\" tests=\"" +
                             std::to_string(cases.size()) + "\" failures=\"" +
                             count(JunitOutcome::kFailed) + "\" errors=\"0\" skipped=\"" +
                             count(JunitOutcome::kSkipped) + "\" time=\"0\"";
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite " + totals + ">\n";
  for (const JunitCase& test : cases) xml += CaseXml(test);
  return xml + "</testsuite>\n</testsuites>\n";
}

}  // namespace turnlight
