#pragma once

// Drawings made by hand, for tests of the writers.

#include <string>
#include <utility>
#include <vector>

#include "sightline/drawing/drawing.h"

namespace sightline::test {

// An object with a square at ten times its number: the outline, the borders, and a line within.
inline DrawingObject object(std::uint32_t id, const std::string& name) {
  const double x = 10.0 * id;
  return {.object = ObjectId(id),
          .name = name,
          .outline = {{{x, 0}, {x + 8, 0}, {x + 8, 8}, {x, 8}}},
          .strokes = {{{x, 0}, {x + 8, 0}, {x + 8, 8}, {x, 8}, {x, 0}}, {{x + 1, 1}, {x + 3.25, 2.5}}}};
}

inline Drawing drawingOf(std::vector<DrawingGroup> groups) {
  return {.width = 640.0, .height = 360.0, .groups = std::move(groups)};
}

}  // namespace sightline::test
