#pragma once

// A hall of glass, which demonstrates the ordering of see-through objects.

#include <cstdint>

#include "sightline/scene/scene.h"

namespace sightline {

struct GlassOptions {
  std::uint32_t panes = 18;    // number of panes in the grove
  std::uint32_t bottles = 12;  // number of bottles in the grove
  std::uint32_t seed = 1;
};
// From west to east: a ring of long panes, each in front of the next all the way round, which has no order;
// objects that intersect or stand in each other; a long oblique pane with bottles on both sides, some of
// which a sort by distances of centres gets wrong; and a grove of panes, films, bottles and opaque columns
// behind a balustrade of glass. Each is a separate object. Most are closed; films are flat and double-sided.
// Camera path: "along" (240 frames past all of it).
Scene makeGlass(const GlassOptions& options);

}  // namespace sightline
