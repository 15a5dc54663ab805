// "Did you mean": the known word nearest to a mistyped one, for messages about unknown names.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace turnlight {

// The number of slips between two words: insertions, deletions and exchanges of one character,
// swaps of neighbours ("optimal string alignment").
inline std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t exchanged = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, exchanged});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

// The nearest of the names if it is near enough for slips of the finger, a third of the word's
// length; else "". The first of equally near names wins.
template <typename Names>
std::string Nearest(std::string_view word, const Names& names) {
  constexpr std::size_t kLongestWord = 64;  // nobody mistypes a longer one
  if (word.empty() || word.size() > kLongestWord) return "";
  std::string_view nearest;
  std::size_t best = std::max<std::size_t>(1, (word.size() + 1) / 3) + 1;
  for (const auto& name : names) {
    const std::size_t distance = EditDistance(word, name);
    if (distance < best && distance < std::string_view(name).size()) {
      best = distance;
      nearest = name;
    }
  }
  return std::string(nearest);
}

// " (did you mean "camera"?)" of the nearest name, if there is one.
template <typename Names>
std::string DidYouMean(std::string_view word, const Names& names) {
  const std::string nearest = Nearest(word, names);
  return nearest.empty() ? nearest : " (did you mean \"" + nearest + "\"?)";
}

}  // namespace turnlight
