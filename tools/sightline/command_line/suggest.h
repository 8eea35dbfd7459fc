#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::tool {

// "; did you mean 'method'?" where `word` differs from one of the known words by few letters (missing, added,
// changed or swapped; at most one in three), and nothing where it does not. Ties: the first known word.
std::string didYouMean(std::string_view word, std::span<const std::string> known);

}  // namespace sightline::tool
