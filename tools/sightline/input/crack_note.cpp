#include "tools/sightline/input/crack_note.h"

#include <fmt/format.h>

namespace sightline::tool {

std::string crackText(const CrackNote& note) {
  return note.width > 0.0 ? fmt::format(" --crack-width {}", note.width) : "";
}

void addCracks(Json& scene, const CrackNote& note) {
  if (note.width > 0.0) {
    scene["crack_width"] = note.width;
    scene["crack_slack"] = note.slack;
  }
}

CrackNote cracksOf(const BakeRecord& record) {
  const Json settings = Json::parse(record.settings, nullptr, false);
  const auto numberIn = [&](const char* key) {
    return settings.is_object() && settings.contains(key) && settings[key].is_number()
               ? settings[key].get<double>()
               : 0.0;
  };
  return {numberIn("crack_width"), numberIn("crack_slack")};
}

}  // namespace sightline::tool
