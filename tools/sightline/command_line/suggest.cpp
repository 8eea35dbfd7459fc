#include "tools/sightline/command_line/suggest.h"

#include <algorithm>
#include <cctype>

namespace sightline::tool {
namespace {

bool sameLetter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

// The number of letters that must be added, removed, changed or swapped with their neighbour to turn one word
// into the other. Row i of the table holds the distances between a's first i letters and each prefix of b.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = sameLetter(a[i - 1], b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && sameLetter(a[i - 1], b[j - 2]) && sameLetter(a[i - 2], b[j - 1])) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

std::string didYouMean(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t kLettersAnError = 3;
  const std::string* nearest = nullptr;
  std::size_t smallest_distance = 0;
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(word, candidate);
    const bool near = distance * kLettersAnError <= std::max(word.size(), candidate.size());
    if (near && (nearest == nullptr || distance < smallest_distance)) {
      nearest = &candidate;
      smallest_distance = distance;
    }
  }
  return nearest == nullptr ? std::string() : "; did you mean '" + *nearest + "'?";
}

}  // namespace sightline::tool
