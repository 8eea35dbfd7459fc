#include "src/io/obj/obj_lines.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

namespace sightline::io {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

}  // namespace

ObjStatements::ObjStatements(std::string_view bytes, Backslash backslash)
    : text_(bytes), backslash_(backslash) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text_.starts_with(kByteOrderMark)) {
    text_.remove_prefix(kByteOrderMark.size());
  }
  feed_ = std::min(text_.find('\n'), text_.size());
}

// Returns the text up to a line feed, a carriage return, or both, and moves behind them.
std::string_view ObjStatements::nextLine() {
  ++next_line_;
  if (feed_ < at_) {
    feed_ = std::min(text_.find('\n', at_), text_.size());
  }
  std::string_view line = text_.substr(at_, feed_ - at_);
  line = line.substr(0, line.find('\r'));
  at_ += line.size();
  if (at_ < feed_) {
    ++at_;  // the carriage return
  }
  if (at_ == feed_) {
    at_ = std::min(at_ + 1, text_.size());
  }
  return line;
}

bool ObjStatements::next() {
  while (!atEnd()) {
    line_ = next_line_;
    std::string_view text = nextLine();
    const bool comment = trimmed(text).starts_with('#');
    if (text.ends_with('\\') && !comment && backslash_ == Backslash::kContinues) {
      joined_.clear();
      while (text.ends_with('\\')) {
        joined_ += text.substr(0, text.size() - 1);
        joined_ += ' ';
        text = atEnd() ? std::string_view() : nextLine();
      }
      joined_ += text;
      text = joined_;
    }
    text = trimmed(text);
    if (text.empty() || text.front() == '#') {
      continue;
    }
    keyword_ = takeWord(text);
    value_ = trimmed(text);
    return true;
  }
  return false;
}

std::string_view withoutComment(std::string_view value) {
  return value.substr(0, value.find('#'));
}

std::string_view nameWithoutComment(std::string_view value) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] == '#' && (i == 0 || isBlank(value[i - 1]))) {
      return trimmed(value.substr(0, i));
    }
  }
  return value;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && isBlank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

std::string_view takeWord(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && isBlank(text[begin])) {
    ++begin;
  }
  std::size_t end = begin;
  while (end < text.size() && !isBlank(text[end])) {
    ++end;
  }
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::optional<double> numberOf(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) {
    word.remove_prefix(1);
  }
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) {
    return std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    // Too small where the exponent is negative, or where there is none and the number begins with 0.
    const std::size_t exponent = word.find_first_of("eE");
    const bool small = exponent != std::string_view::npos ? word.substr(exponent + 1).starts_with('-')
                                                          : word.find_first_not_of("-0") == word.find('.');
    return small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return number;
}

bool isKeyword(std::string_view keyword, std::string_view lower) {
  return std::equal(keyword.begin(), keyword.end(), lower.begin(), lower.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

std::string_view excerpt(std::string_view text) {
  constexpr std::size_t kMost = 40;
  return text.substr(0, kMost);
}

}  // namespace sightline::io
