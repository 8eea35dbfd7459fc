#pragma once

// Text and ids in XML.

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace sightline::drawing {

// Escapes text for XML attributes and content. Characters that XML does not allow become U+FFFD.
std::string escapeXml(std::string_view text);

// Makes unique ids that are valid in XML and CSS: ASCII letters, digits, '.', '-' and '_' of a name stay,
// other characters become '_', and a number is appended if the id is taken.
class XmlIds {
 public:
  std::string make(std::string_view name);

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, std::uint32_t> last_;  // the last number appended to each name
};

}  // namespace sightline::drawing
