#pragma once

// A hall of glass: what an order of see-through things is shown with.

#include <cstdint>

#include "sightline/scene/scene.h"

namespace sightline {

struct GlassOptions {
  std::uint32_t panes = 18;    // that stand about in the grove
  std::uint32_t bottles = 12;  // there too
  std::uint32_t seed = 1;
};
// From west to east: a ring of long panes, each before the next all the way round, which nothing can order;
// things that reach through each other or stand in each other; a long pane slantwise with bottles on both
// sides, of which an order by distances of centres gets some wrong; and a grove of panes, films, bottles and
// opaque columns behind a balustrade of glass. Every thing is an object of its own; most are closed, films
// are flat and double-sided. Walk: "along" (240 frames past all of it).
Scene makeGlass(const GlassOptions& options);

}  // namespace sightline
