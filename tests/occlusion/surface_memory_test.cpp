// Sets of surfaces that are drawn in turn, more of them than are remembered.

#include "src/occlusion/surfaces/surface_memory.h"

#include <gtest/gtest.h>

#include <array>

namespace sightline::occlusion {
namespace {

// Draws a set in a view, and returns whether anything is known of it from earlier ones.
bool isKnown(SurfaceMemories& memories, const SurfaceSet& set, std::uint64_t view) {
  SurfaceMemory& memory = memories.of(set, view);
  memory.beginView(set, Vec3d(), ViewStep::kNext);
  memory.buffer_view = view;
  return memory.first_of_set < memory.view_number;
}

TEST(SurfaceMemories, OfMoreSetsThanThereArePlacesTheFirstKeepTheirs) {
  const std::array<SurfaceSet, 4> sets{};
  SurfaceMemories memories(2);
  for (std::uint64_t view = 1; view < 6; ++view) {
    for (std::size_t i = 0; i < sets.size(); ++i) {
      EXPECT_EQ(isKnown(memories, sets[i], view), i < 2 && view > 1) << "set " << i << ", view " << view;
    }
  }
}

TEST(SurfaceMemories, ASetThatIsDrawnNoMoreLosesItsPlace) {
  const std::array<SurfaceSet, 4> sets{};
  SurfaceMemories memories(2);
  for (std::uint64_t view = 1; view < 4; ++view) {
    for (const SurfaceSet& set : sets) {
      isKnown(memories, set, view);
    }
  }
  EXPECT_FALSE(isKnown(memories, sets[2], 4)) << "the others were drawn in the view before";
  EXPECT_TRUE(isKnown(memories, sets[1], 4));
  EXPECT_FALSE(isKnown(memories, sets[2], 5));
  EXPECT_TRUE(isKnown(memories, sets[2], 6)) << "it has the place of the first set";
  EXPECT_TRUE(isKnown(memories, sets[1], 6));
  EXPECT_FALSE(isKnown(memories, sets[0], 6));
}

}  // namespace
}  // namespace sightline::occlusion
