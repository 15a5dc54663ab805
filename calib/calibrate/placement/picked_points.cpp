#include "calib/calibrate/placement/picked_points.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>

#include "base/file.h"

namespace turnlight::calib::calibrate::placement {
namespace {

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr std::size_t kMostPicked = 10000;

std::optional<double> NumberOf(const std::string& word) {
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string> WordsOf(std::string line) {
  for (char& c : line)
    if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

Result<PickedPoint> ParsePoint(const std::vector<std::string>& words, const std::string& where,
                               std::size_t frames) {
  std::array<double, 6> numbers{};
  if (words.size() != numbers.size())
    return InputError(where + ": " + std::to_string(words.size()) +
                      " values, allowed are six: frame, x, y, X, Y, Z");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = NumberOf(words[i]);
    if (!number) return InputError(where + ": \"" + words[i] + "\", allowed is a number");
    numbers[i] = *number;
  }
  if (numbers[0] < 0.0 || numbers[0] != std::floor(numbers[0]) ||
      numbers[0] >= static_cast<double>(frames))
    return InputError(where + ": frame " + words[0] + ", allowed is a whole number from 0 to " +
                      std::to_string(frames - 1));
  return PickedPoint{static_cast<std::size_t>(numbers[0]),
                     {numbers[1], numbers[2]},
                     {numbers[3], numbers[4], numbers[5]},
                     where};
}

}  // namespace

Result<std::vector<PickedPoint>> ReadPickedPoints(const std::filesystem::path& path,
                                                  std::size_t frames) {
  const auto text = ReadFile(path, kMostBytes);
  if (!text) return Forward(text);
  std::istringstream stream(*text);
  std::vector<PickedPoint> points;
  std::size_t number = 0;
  bool first = true;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::vector<std::string> words = WordsOf(line);
    if (words.empty() || words[0][0] == '#') continue;
    const bool title = first && !NumberOf(words[0]);
    first = false;
    if (title) continue;
    auto point = ParsePoint(words, path.string() + ":" + std::to_string(number), frames);
    if (!point) return Forward(point);
    points.push_back(std::move(*point));
    if (points.size() > kMostPicked)
      return InputError(path.string() + ": more than " + std::to_string(kMostPicked) + " points");
  }
  if (points.empty()) return InputError(path.string() + ": no points, allowed is at least one");
  return points;
}

}  // namespace turnlight::calib::calibrate::placement
