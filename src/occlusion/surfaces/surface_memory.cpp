#include "src/occlusion/surfaces/surface_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline::occlusion {
namespace {

constexpr std::uint32_t kLastView = 0xffffffffu;  // number of a view; after it they begin again

}  // namespace

void SurfaceMemory::reserve(const SurfaceSet& set) {
  facings.require(set.patches.size());
  patch_rests.require(set.patches.size());
  part_rests.require(set.parts.size());
  place_in_useful.require(set.parts.size());
}

// What is kept of a set that was drawn before counts for nothing: all numbers of views that are written down
// are smaller than those to come.
void SurfaceMemory::beginView(const SurfaceSet& set, const Vec3d& eye_of_view, ViewStep step) {
  reserve(set);
  const double moved = length(eye_of_view - eye);
  const bool anew = set_number != set.number || view_number == kLastView || !std::isfinite(travel + moved);
  if (view_number == kLastView) {
    patch_rests.clear();
    part_rests.clear();
    facings.clear();
    view_number = 0;
  }
  if (step != ViewStep::kSame || anew) {
    ++view_number;
    for (const UsefulPart& part : useful) {
      place_in_useful[part.part] = 0;
    }
    useful_before.swap(useful);
    useful.clear();
  }
  if (anew) {
    useful_before.clear();
    first_of_set = view_number;
    travel = 0.0;
  } else if (moved > 0.0) {
    // Rounded up: however short the steps are, none is lost.
    travel = std::nextafter(travel + moved, std::numeric_limits<double>::infinity());
  }
  first_view = step == ViewStep::kJump || anew ? view_number : first_view;
  set_number = set.number;
  eye = eye_of_view;
}

SurfaceMemory& SurfaceMemories::of(const SurfaceSet& set, std::uint64_t buffer_view) {
  auto found = std::find_if(sets_.begin(), sets_.end(),
                            [&](const Known& known) { return known.number == set.number; });
  if (found == sets_.end() && sets_.size() < most_) {
    sets_.push_back({set.number, std::make_unique<SurfaceMemory>()});
    found = sets_.end() - 1;
  } else if (found == sets_.end()) {
    found = std::min_element(sets_.begin(), sets_.end(), [](const Known& a, const Known& b) {
      return a.memory->buffer_view < b.memory->buffer_view;
    });
    if (found->memory->buffer_view + 1 >= buffer_view) {
      return shared_;
    }
    found->number = set.number;
  }
  return *found->memory;
}

}  // namespace sightline::occlusion
