#include "app/frame_list.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace turnlight::app {
namespace {

constexpr std::size_t kMostFrames = 1'000'000;
constexpr char kAllowedFrames[] =
    "allowed are numbers and ranges, counted from 0 and ascending, such as 0-16,18-35";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::optional<std::size_t> FrameNumber(std::string_view text) {
  text = Trimmed(text);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number >= kMostFrames)
    return std::nullopt;
  return number;
}

tl::unexpected<Error> RefuseFrames(const std::string& why) {
  return InputError("--frames: " + why + ", " + kAllowedFrames);
}

// One word, "5" or "3-7", behind what is there already.
Status AddFrames(std::string_view word, std::vector<std::size_t>& frames) {
  const std::size_t dash = word.find('-');
  const auto first = FrameNumber(word.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : FrameNumber(word.substr(dash + 1));
  const std::string shown = "\"" + std::string(Trimmed(word)) + "\"";
  if (!first || !last) return RefuseFrames(shown + " is neither a frame's number nor a range");
  if (*last < *first) return RefuseFrames(shown + " goes backwards");
  for (std::size_t frame = *first; frame <= *last; ++frame)
    if (std::binary_search(frames.begin(), frames.end(), frame))
      return RefuseFrames("frame " + std::to_string(frame) + " is named twice");
  if (!frames.empty() && *first < frames.back())
    return RefuseFrames(shown + " comes after frame " + std::to_string(frames.back()));
  for (std::size_t frame = *first; frame <= *last; ++frame) frames.push_back(frame);
  return {};
}

}  // namespace

Result<std::vector<std::size_t>> ParseFrames(const std::string& text) {
  std::vector<std::size_t> frames;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    if (const Status added = AddFrames(rest.substr(0, comma), frames); !added)
      return Forward(added);
    if (comma == std::string_view::npos) return frames;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace turnlight::app
