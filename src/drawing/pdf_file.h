#pragma once

// The frame of a PDF file: numbered objects, and the table that says where they begin.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::drawing {

// A text as a PDF string object: in parentheses where it is ASCII, else UTF-16 in hexadecimal digits.
std::string pdfString(std::string_view utf8);

class PdfFile {
 public:
  PdfFile();

  // A number for an object that is added later, from 1.
  std::size_t reserve();
  // Each reserved object exactly once, in any order.
  void add(std::size_t number, std::string_view body);
  // Compressed; `entries` go into its dictionary beside its length and its filter.
  void addStream(std::size_t number, std::string_view bytes, std::string_view entries = "");
  // The whole file. Call it last, once.
  std::string finish(std::size_t catalogue, std::size_t info);

 private:
  std::string bytes_;
  std::vector<std::size_t> offsets_;  // of object 1, 2, ...
};

}  // namespace sightline::drawing
