#include "src/drawing/pdf_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <iterator>

#include "src/base/utf8.h"

namespace sightline::drawing {
namespace {

bool isPlain(char32_t code) {
  return code >= 0x20 && code < 0x7f;
}

std::string inParentheses(const std::u32string& text) {
  std::string string = "(";
  for (const char32_t code : text) {
    const char c = static_cast<char>(code);
    string += c == '(' || c == ')' || c == '\\' ? "\\" : "";
    string += c;
  }
  return string + ")";
}

// UTF-16 in hexadecimal digits, with the byte order mark by which readers recognise it.
std::string inUtf16(const std::u32string& text) {
  std::string string = "<FEFF";
  const auto put = [&](char32_t unit) {
    fmt::format_to(std::back_inserter(string), "{:04X}", static_cast<std::uint32_t>(unit));
  };
  for (const char32_t code : text) {
    if (code < 0x10000) {
      put(code);
    } else {
      put(0xd800 + ((code - 0x10000) >> 10));
      put(0xdc00 + ((code - 0x10000) & 0x3ff));
    }
  }
  return string + ">";
}

// The bytes compressed by zlib; empty if zlib had no memory.
std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int result =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  out.resize(result == Z_OK ? size : 0);
  return out;
}

}  // namespace

std::string pdfString(std::string_view utf8) {
  const std::u32string text = base::decodeUtf8(utf8);
  return std::all_of(text.begin(), text.end(), isPlain) ? inParentheses(text) : inUtf16(text);
}

// The bytes above 127 in the second line tell programs that the file is not text.
PdfFile::PdfFile() : bytes_("%PDF-1.5\n%\xe2\xe3\xcf\xd3\n") {}

std::size_t PdfFile::reserve() {
  offsets_.push_back(0);
  return offsets_.size();
}

void PdfFile::add(std::size_t number, std::string_view body) {
  offsets_[number - 1] = bytes_.size();
  fmt::format_to(std::back_inserter(bytes_), "{} 0 obj\n{}\nendobj\n", number, body);
}

void PdfFile::addStream(std::size_t number, std::string_view bytes) {
  const std::string packed = deflated(bytes);
  const std::string_view stored = packed.empty() ? bytes : packed;
  const std::string_view filter = packed.empty() ? "" : " /Filter /FlateDecode";
  offsets_[number - 1] = bytes_.size();
  fmt::format_to(std::back_inserter(bytes_), "{} 0 obj\n<< /Length {}{} >>\nstream\n", number, stored.size(),
                 filter);
  bytes_ += stored;
  bytes_ += "\nendstream\nendobj\n";
}

// Each line of the table has 20 bytes, its end included.
std::string PdfFile::finish(std::size_t catalogue, std::size_t info) {
  const std::size_t table = bytes_.size();
  const auto out = std::back_inserter(bytes_);
  fmt::format_to(out, "xref\n0 {}\n0000000000 65535 f \n", offsets_.size() + 1);
  for (const std::size_t offset : offsets_) {
    fmt::format_to(out, "{:010} 00000 n \n", offset);
  }
  fmt::format_to(out, "trailer\n<< /Size {} /Root {} 0 R /Info {} 0 R >>\nstartxref\n{}\n%%EOF\n",
                 offsets_.size() + 1, catalogue, info, table);
  return std::move(bytes_);
}

}  // namespace sightline::drawing
