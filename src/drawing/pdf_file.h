#pragma once

// Writes the structure of a PDF file: numbered objects and the table of their offsets.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::drawing {

// A text as a PDF string object: in parentheses if it is ASCII, else UTF-16 in hexadecimal digits.
std::string pdfString(std::string_view utf8);

class PdfFile {
 public:
  PdfFile();

  // Returns the number (from 1) of an object that is added later.
  std::size_t reserve();
  // Adds an object. Each reserved number is added exactly once, in any order.
  void add(std::size_t number, std::string_view body);
  // Adds a compressed stream, whose dictionary has its length and its filter.
  void addStream(std::size_t number, std::string_view bytes);
  // Returns the whole file. Called once, at the end.
  std::string finish(std::size_t catalogue, std::size_t info);

 private:
  std::string bytes_;
  std::vector<std::size_t> offsets_;  // in bytes, of the objects 1, 2, ...
};

}  // namespace sightline::drawing
