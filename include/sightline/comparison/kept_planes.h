#pragma once

// Supporting and separating planes of each box, kept from frame to frame: the method of Coorg and Teller 1997
// as published, to compare SupportingPlanes with.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sightline/occlusion/supporting_planes.h"

namespace sightline {

// How the two vertices of a box are found that planes through a line touch.
enum class TangentSearch : std::uint8_t {
  kTables,       // two table look-ups (Coorg and Teller 1997, section 3.3); exact
  kAllVertices,  // all eight vertices are compared. Where rounding leaves no tangent, as for edges parallel
                 // to the box's, nothing is hidden
};

struct KeptPlanesSettings {
  bool joint_occlusion = true;  // occluders that share edges hide together what none of them hides alone
  bool keep_relations = true;   // of boxes that are classified with an item
  // Memory of kept relations, at most; the least recently used go first. 4 bytes an item come on top.
  std::size_t relation_bytes = 16u << 20;
  TangentSearch tangent_search = TangentSearch::kTables;
};

// Counts of relations, each the planes of one occluder and one box, since the last build(); `kept` and
// `bytes` are of all that the store holds now.
struct RelationStats {
  std::uint32_t compared =
      0;                     // pairs of an occluder and a box that were compared, with or without a relation
  std::uint32_t reused = 0;  // relations of an earlier frame that were used again
  std::uint32_t unchanged = 0;  // of these: the eye had not moved far enough for a sign to change
  std::uint32_t rebuilt = 0;    // relations whose planes were made
  std::uint32_t evicted = 0;    // relations dropped, or not kept, for want of room
  std::uint32_t dropped = 0;    // relations that forget() dropped
  std::uint32_t kept = 0;       // relations in the store
  std::size_t bytes = 0;        // memory of the store
};

struct KeptPlanesStats {
  std::uint32_t occluders = 0;  // occluders of all sets that can be used from this view
  std::uint32_t unusable = 0;   // chosen, but seen from behind, edge-on, or wholly before the near plane
  RelationStats relations{};
};

// Answers as SupportingPlanes does, with the same interface and the same promise, from planes through each
// occluder's edges and the box instead of the eye. Such planes do not depend on the eye, so the relations of
// boxes that have an item are kept and used again in later frames; answers do not depend on what is kept.
// Use by one thread at a time; nothing is allocated once the storage has grown to what a few frames need.
// Source: Coorg, Teller 1997, sections 3 and 4.
class KeptPlanes {
 public:
  // The caller's number of a node, an object, or anything else with a box that does not change. Numbers start
  // at 0 and are dense.
  using Item = SupportingPlanes::Item;

  explicit KeptPlanes(const KeptPlanesSettings& settings = {});
  ~KeptPlanes();
  KeptPlanes(KeptPlanes&&) noexcept;
  KeptPlanes& operator=(KeptPlanes&&) noexcept;

  // Takes the chosen occluders for a view. The set must stay as it is as long as this is used: kept relations
  // belong to it.
  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen);
  // Takes the chosen occluders of at least one set. Relations are kept of the first set alone: the others may
  // move, and must stay as they are until the next build().
  void build(const View& view, std::span<const ChosenOccluders> sets);
  // Adds occluders of the first set for the same view and returns the list of them, as
  // SupportingPlanes::add().
  OccluderList add(std::span<const OccluderId> more);

  // Classifies a box in scene space against all occluders of build(), and keeps nothing. Boxes that are not
  // well formed are kVisible.
  Visibility classify(const Box& box);

  // The list of all occluders of build().
  OccluderList all() const;
  // Classifies a box against the occluders of `among` only, and keeps the item's relations. `touching`
  // becomes the list of those that hide some of the box.
  Visibility classify(const Box& box, Item item, OccluderList among, OccluderList& touching);
  // Drops the item's relations. Returns whether there were any.
  bool forget(Item item);
  // Drops all relations, as is necessary after a change of boxes or of the occluder set.
  void forgetAll();

  KeptPlanesStats stats() const;
  std::uint32_t compared() const;  // RelationStats::compared, so far
  // The chosen occluders of the first set that can be used from this view.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
