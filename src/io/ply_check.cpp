#include "src/io/ply_check.h"

#include <algorithm>
#include <cstdint>
#include <sstream>

#include "src/io/failure.h"

namespace sightline::io {
namespace {

struct Header {
  bool ascii = true;
  double elements = 0.0;   // of all kinds together
  double min_bytes = 0.0;  // of all elements in binary form; lists taken as empty
  std::size_t size = 0;    // bytes of the header itself; 0: not understood
  bool has_strips = false;
  bool faces_have_alpha = false;
};

double sizeOf(const std::string& type) {
  if (type == "double" || type == "float64") {
    return 8.0;
  }
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") {
    return 1.0;
  }
  return type == "short" || type == "ushort" || type == "int16" || type == "uint16" ? 2.0 : 4.0;
}

// What is not understood is left to Assimp to refuse.
Header readHeader(std::string_view bytes) {
  constexpr std::string_view kEnd = "end_header";
  Header header;
  const std::size_t end = bytes.find(kEnd);
  const std::size_t line_end = end == std::string_view::npos ? end : bytes.find('\n', end);
  if (line_end == std::string_view::npos) {
    return header;
  }
  header.size = line_end + 1;
  std::istringstream lines{std::string(bytes.substr(0, end))};
  std::string element;
  double count = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, type, name;
    words >> key >> type;
    if (key == "format") {
      header.ascii = type == "ascii";
    } else if (key == "element" && words >> count && count > 0.0) {
      element = type;
      header.elements += count;
      header.has_strips = header.has_strips || element == "tristrips";
    } else if (key == "property") {
      const bool list = type == "list";
      if (list) {
        words >> type >> name;  // of the length, and of what is listed
      }
      header.min_bytes += count * sizeOf(type);
      words >> name;
      header.faces_have_alpha = header.faces_have_alpha || (element == "face" && !list && name == "alpha");
    }
  }
  return header;
}

}  // namespace

bool plyFacesHaveAlpha(std::string_view bytes) {
  return readHeader(bytes).faces_have_alpha;
}

Status checkPly(std::string_view bytes, const std::string& name) {
  const Header header = readHeader(bytes);
  if (header.size == 0) {
    return failure("{}: its header has no end: it is not a whole .ply file", name);
  }
  if (header.has_strips) {
    return failure("{}: has triangle strips (element tristrips), which are not read; write it with faces",
                   name);
  }
  const std::string_view body = bytes.substr(header.size);
  if (!header.ascii) {
    return static_cast<double>(body.size()) >= header.min_bytes
               ? Status(Success{})
               : failure("{}: is cut off: its elements need at least {:.0f} bytes, but {} are there", name,
                         header.min_bytes, body.size());
  }
  // One line an element; the last may lack its end.
  const bool open_end = !body.empty() && body.back() != '\n';
  const auto lines = std::count(body.begin(), body.end(), '\n') + (open_end ? 1 : 0);
  if (static_cast<double>(lines) < header.elements) {
    return failure("{}: is cut off: its header announces {:.0f} elements, but {} lines follow", name,
                   header.elements, lines);
  }
  return Success{};
}

}  // namespace sightline::io
