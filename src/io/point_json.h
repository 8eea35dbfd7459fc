#pragma once

// A point or a direction as JSON: a list of three numbers.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "sightline/math/vec3.h"

namespace sightline::io {

inline nlohmann::ordered_json pointJson(const Vec3d& point) {
  return nlohmann::ordered_json::array({point.x, point.y, point.z});
}

// Nothing if the JSON is not a list of three finite numbers.
template <typename Json>
std::optional<Vec3d> pointOf(const Json& json) {
  if (!json.is_array() || json.size() != 3 ||
      !std::all_of(json.begin(), json.end(), [](const Json& number) { return number.is_number(); })) {
    return std::nullopt;
  }
  const Vec3d point(json[0].template get<double>(), json[1].template get<double>(),
                    json[2].template get<double>());
  return isFinite(point) ? std::optional(point) : std::nullopt;
}

}  // namespace sightline::io
