#pragma once

// The names of the library's values on the command line and in JSON, for parsing, help and output.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/layers/compositing.h"

namespace sightline::tool {

template <typename T>
struct Name {
  std::string_view text;
  T value;
};

inline constexpr std::array<Name<CompositingForm>, 3> kCompositingForms{{
    {"sum-of-outs", CompositingForm::kSumOfOuts},
    {"over-atop", CompositingForm::kOverAtop},
    {"cheapest", CompositingForm::kCheapest},
}};
inline constexpr std::array<Name<bool>, 2> kSwitch{{{"on", true}, {"off", false}}};

template <typename T, std::size_t N>
std::string nameOf(const std::array<Name<T>, N>& names, T value) {
  for (const Name<T>& name : names) {
    if (name.value == value) {
      return std::string(name.text);
    }
  }
  return "?";
}

// The value of a name. Precondition: text is one of the names.
template <typename T, std::size_t N>
T valueOf(const std::array<Name<T>, N>& names, std::string_view text) {
  for (const Name<T>& name : names) {
    if (name.text == text) {
      return name.value;
    }
  }
  return names[0].value;
}

template <typename T, std::size_t N>
std::vector<std::string> textsOf(const std::array<Name<T>, N>& names) {
  std::vector<std::string> texts;
  for (const Name<T>& name : names) {
    texts.emplace_back(name.text);
  }
  return texts;
}

// "a, b, c"
template <typename T, std::size_t N>
std::string listNames(const std::array<Name<T>, N>& names) {
  std::string list;
  for (const Name<T>& name : names) {
    list += (list.empty() ? "" : ", ") + std::string(name.text);
  }
  return list;
}

}  // namespace sightline::tool
