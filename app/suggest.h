// The word that was probably meant.
#pragma once

#include <string>
#include <vector>

namespace turnlight::app {

// The nearest of the words by insertions, deletions, exchanges and swaps of neighbours, if it is
// near enough to be a slip of the finger (a third of the length); else "".
std::string Nearest(const std::string& word, const std::vector<std::string>& words);

}  // namespace turnlight::app
