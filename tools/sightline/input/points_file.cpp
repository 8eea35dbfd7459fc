#include "tools/sightline/input/points_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "src/io/point_json.h"
#include "tools/sightline/input/camera_path_file.h"

namespace sightline::tool {

using Json = nlohmann::ordered_json;

Result<std::vector<Vec3d>> parsePointsFile(std::string_view text, const std::string& name) {
  const Json json = Json::parse(text, nullptr, false);
  std::vector<Vec3d> points;
  if (json.is_object() && json.contains("frames")) {
    const Result<CameraPath> path = parseCameraPathFile(text, name);
    if (!path) {
      return path.error();
    }
    for (const CameraFrame& frame : path->frames) {
      points.push_back(frame.eye);
    }
    return points;
  }
  const std::string form = R"(give {"points":[[x,y,z],...]} in metres, or a camera path)";
  if (!json.is_object() || !json.contains("points") || !json["points"].is_array()) {
    return Error{fmt::format("{}: has no points; {}", name, form)};
  }
  for (const Json& item : json["points"]) {
    const std::optional<Vec3d> point = io::pointOf(item);
    if (!point) {
      return Error{fmt::format("{}: point {} is not three finite numbers; {}", name, points.size(), form)};
    }
    points.push_back(*point);
  }
  return points;
}

}  // namespace sightline::tool
