#pragma once

// Names in XML.

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace sightline::drawing {

// For attributes and text; characters that XML does not have become U+FFFD.
std::string escapeXml(std::string_view text);

// Ids that are valid in XML and CSS and unique: ASCII letters, digits, '.', '-' and '_' of a name, the others
// replaced by '_'; a number behind it where it is taken.
class XmlIds {
 public:
  std::string make(std::string_view name);

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, std::uint32_t> last_;  // number given to a name
};

}  // namespace sightline::drawing
