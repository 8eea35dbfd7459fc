#pragma once

// Supporting planes: whether occluders hide a box, from planes through the eye and the occluders' edges.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

struct SupportingPlanesSettings {
  bool joint_occlusion = true;  // occluders that share edges hide together what none of them hides alone
};

struct SupportingPlanesStats {
  std::uint32_t occluders = 0;  // occluders of all sets that can be used from this view
  std::uint32_t unusable = 0;   // chosen, but seen from behind, edge-on, or wholly before the near plane
};

// A list of occluders that may hide what lies below a node. It is valid until the next build().
struct OccluderList {
  std::uint32_t first = 0, count = 0;
};

// Tells for any box whether the chosen occluders hide it from the view's eye. It can be used alone: build()
// from any occluders, then classify() boxes at any time.
//
// Answers are conservative: kHidden only where no point of the box can be seen from the eye. kVisible means
// that no occluder comes between the eye and any part of the box. Before the first build(), nothing is
// hidden. Use by one thread at a time; nothing is allocated once the storage has grown to what a few frames
// need. Source: Coorg, Teller 1997, sections 3 and 4; docs/algorithms/supporting-planes.md has the
// differences.
class SupportingPlanes {
 public:
  // The caller's number of a box. Answers do not depend on it; KeptPlanes, which has the same interface,
  // keeps planes by it.
  using Item = std::uint32_t;

  explicit SupportingPlanes(const SupportingPlanesSettings& settings = {});
  ~SupportingPlanes();
  SupportingPlanes(SupportingPlanes&&) noexcept;
  SupportingPlanes& operator=(SupportingPlanes&&) noexcept;

  // Takes the chosen occluders for a view. The set must stay as it is until the next build().
  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen);
  // Takes the chosen occluders of at least one set, such as those of the scene and those that move.
  void build(const View& view, std::span<const ChosenOccluders> sets);
  // Adds occluders of the first set for the same view and returns the list of them.
  OccluderList add(std::span<const OccluderId> more);

  // Classifies a box in scene space against all occluders of build(). Boxes that are not well formed are
  // kVisible.
  Visibility classify(const Box& box);

  // The list of all occluders of build().
  OccluderList all() const;
  // Classifies a box against the occluders of `among` only. `touching` becomes the list of those that hide
  // some of the box: no other one of `among` can hide anything within it.
  Visibility classify(const Box& box, Item item, OccluderList among, OccluderList& touching);

  SupportingPlanesStats stats() const;
  // The chosen occluders of the first set that can be used from this view.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
