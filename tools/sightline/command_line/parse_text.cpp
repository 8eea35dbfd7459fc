#include "tools/sightline/command_line/parse_text.h"

#include <charconv>
#include <cmath>

namespace sightline::tool {
namespace {

template <typename T>
std::optional<T> parse(const std::string& text) {
  T value = 0;
  const char* end_of_text = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), end_of_text, value);
  return error == std::errc() && end == end_of_text ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1) {
    parts.push_back(text.substr(begin, end - begin));
  }
  parts.push_back(text.substr(begin));
  return parts;
}

std::optional<std::uint32_t> parseWhole(const std::string& text) {
  return parse<std::uint32_t>(text);
}

std::optional<double> parseDecimal(const std::string& text) {
  const std::optional<double> value = parse<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::vector<double> parseDecimals(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& word : splitAt(text, ',')) {
    if (const std::optional<double> number = parseDecimal(word)) {
      numbers.push_back(*number);
    } else {
      return {};
    }
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

std::optional<Vec3d> parsePoint(const std::string& text) {
  const std::vector<double> numbers = parseDecimals(text, 3);
  return numbers.empty() ? std::nullopt : std::optional(Vec3d(numbers[0], numbers[1], numbers[2]));
}

}  // namespace sightline::tool
