#pragma once

// Supporting and separating planes: whether occluders hide a box, from planes through their edges. Nothing is
// built for a frame but a few planes an occluder.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// Which planes a box is compared with. A plane through the eye and an edge of the occluder leaves all of the
// box on the occluder's side exactly where the eye satisfies the supporting plane of edge and box.
enum class PlaneForm : std::uint8_t {
  kThroughEye,  // a few planes an occluder and frame, nothing for a box: the fastest
  kThroughBox,  // the supporting and separating planes of each box, which can be kept (Coorg and Teller 1997)
};

// How the two vertices of a box are found that planes through a line touch; for kThroughBox.
enum class TangentSearch : std::uint8_t {
  kTables,       // two table look-ups (Coorg and Teller 1997, 3.3); exact
  kAllVertices,  // all eight vertices are compared, to measure against; where rounding leaves no tangent, as
                 // for edges parallel to the box's, nothing is hidden
};

struct SupportingPlanesSettings {
  bool joint_occlusion = true;  // occluders that share edges hide together what none of them hides alone
  PlaneForm form = PlaneForm::kThroughEye;
  bool keep_relations = true;  // of classify() with an item; for kThroughBox
  // Of kept relations, at most; the least recently used go first. 4 bytes an item come on top.
  std::size_t relation_bytes = 16u << 20;
  TangentSearch tangent_search = TangentSearch::kTables;
};

// Counts since build(), that is of one frame; `kept` and `bytes` are of all that is kept.
struct RelationStats {
  std::uint32_t reused = 0;     // looked at again with the planes of an earlier frame
  std::uint32_t unchanged = 0;  // of these: the eye had not come far enough for a sign to change
  std::uint32_t rebuilt = 0;    // planes were made
  std::uint32_t evicted = 0;    // for want of room
  std::uint32_t dropped = 0;    // an ancestor became hidden or visible
  std::uint32_t kept = 0;       // now
  std::size_t bytes = 0;        // of the store, now
};

struct SupportingPlanesStats {
  std::uint32_t occluders = 0;  // of all sets, that can be used from this view
  std::uint32_t unusable = 0;   // chosen, but seen from behind, edge-on, or wholly before the near plane
  RelationStats relations{};
};

// Occluders that may still hide what lies below a node; valid until the next build().
struct OccluderList {
  std::uint32_t first = 0, count = 0;
};

// Usable alone: build() from any occluders, then classify() any box at any time. Answers are conservative:
// kHidden only where no point of the box can be seen from the view's eye; kVisible where no occluder comes
// between the eye and any part of the box. Not safe to share between threads; allocates nothing once its
// storage has grown to what a few frames need.
class SupportingPlanes {
 public:
  // What has kept relations: a node, an object, anything with a box that does not change. The caller's
  // numbers, from 0, dense.
  using Item = std::uint32_t;

  explicit SupportingPlanes(const SupportingPlanesSettings& settings = {});
  ~SupportingPlanes();
  SupportingPlanes(SupportingPlanes&&) noexcept;
  SupportingPlanes& operator=(SupportingPlanes&&) noexcept;

  // The chosen occluders for the view. The set must outlive the use of this; kept relations belong to it.
  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen);
  // The same of several sets, at least one. Relations are kept of the first set alone: the others may move,
  // and must outlive the use of this until the next build().
  void build(const View& view, std::span<const ChosenOccluders> sets);
  // Further occluders of the first set for the same view, to be asked with. Best first is best.
  OccluderList add(std::span<const OccluderId> more);

  // Of a box in scene space, as seen from the eye of the last build(), against all occluders of build().
  // Boxes that are not well formed are kVisible. Keeps nothing.
  Visibility classify(const Box& box);

  // The hierarchical form: against the occluders of `among` only. touching: those that hide some of the box,
  // for what lies within it. Relations of the item are kept.
  OccluderList all() const;
  Visibility classify(const Box& box, Item item, OccluderList among, OccluderList& touching);
  // Drops the item's relations. Returns whether there were any.
  bool forget(Item item);
  // Drops all relations (after a change of boxes or of the occluder set).
  void forgetAll();

  SupportingPlanesStats stats() const;
  // Those of the first set's chosen ones that can be used from this view.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
