#pragma once

// The statements of .obj and .mtl files: lines of a keyword and what follows it.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sightline::io {

// Goes through the statements of a text, which must outlive it. Lines may end in any way; empty ones, and
// those that begin with '#', are left out.
class ObjStatements {
 public:
  // In an .obj file, a backslash at the end of a line that is no comment continues it. In an .mtl file it may
  // be the end of a folder's name.
  enum class Backslash : std::uint8_t { kContinues, kIsText };
  explicit ObjStatements(std::string_view bytes, Backslash backslash = Backslash::kContinues);

  // Moves to the next statement; false at the end.
  bool next();

  // All three are valid until the next call.
  std::string_view keyword() const { return keyword_; }
  std::string_view value() const { return value_; }  // without blanks at its ends; a comment may follow in it
  std::uint32_t line() const { return line_; }       // where the statement begins, counted from 1

 private:
  bool atEnd() const { return at_ >= text_.size(); }
  std::string_view nextLine();

  std::string_view text_;
  Backslash backslash_;
  std::size_t at_ = 0, feed_ = 0;  // where the next line begins; the first line feed from there on
  std::string_view keyword_, value_;
  std::string joined_;  // the lines of a statement that is continued
  std::uint32_t line_ = 0, next_line_ = 1;
};

// Up to a '#'. Of names, which may contain one, up to one after a blank.
std::string_view withoutComment(std::string_view value);
std::string_view nameWithoutComment(std::string_view value);

std::string_view trimmed(std::string_view text);

// Takes the next word off the front; empty if there is none.
std::string_view takeWord(std::string_view& text);

// The number that a whole word is: infinite if it is too large, 0 if it is too small.
std::optional<double> numberOf(std::string_view word);

// Whether two keywords are the same but for the case of their letters. `lower` has small letters alone.
bool isKeyword(std::string_view keyword, std::string_view lower);

// The beginning of a text, for an error.
std::string_view excerpt(std::string_view text);

}  // namespace sightline::io
