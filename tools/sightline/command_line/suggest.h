#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::tool {

// "; did you mean 'method'?" if `word` differs from a known word by few letters (missing, added, changed or
// swapped; at most one in three), otherwise an empty text. Of several nearest words the first is taken.
std::string didYouMean(std::string_view word, std::span<const std::string> known);

}  // namespace sightline::tool
