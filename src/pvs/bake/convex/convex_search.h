#pragma once

// What single convex occluders hide from a region or a point, found by lines of sight: an occluder that hides
// a box from all of the region meets each line from there to the box. So a few lines leave few occluders, and
// the time follows what is seen, not how many occluders there are.
//
// Such a line ends in the corner of the box on the same side as the corner of the region where it begins. Few
// occluders meet several of these, for they lie on the hull of both.
//
// The box tree is searched from the root down. A node that an occluder hides ends its branch. To what is
// below others, occluders are passed on that lie in the cones from some corners of the region to where such
// lines end. What one occluder hides is often next to what it hid before, so the last ones are asked first.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/convex/cell_candidates.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/segment.h"

namespace sightline::pvs {

// The occluders that count for a region: those in the search box that are useful to cells of a level, without
// those in the smaller box that was searched before.
struct OccluderChoice {
  CellBox search{};
  std::optional<CellBox> known{};
  std::uint32_t level = 0;
};

// Use by one thread at a time.
class ConvexSearch {
 public:
  // scene must outlive this.
  explicit ConvexSearch(const BakeScene& scene);

  // Objects that an occluder hides.
  struct Found {
    std::uint32_t occluder = 0;
    ObjectRun objects{};
  };
  // All that is hidden from the region with these corners, at most kMaxCorners of them, without what `known`
  // holds. Occluders of objects that are known to be hidden do not count: something else hides what they
  // hide. They come in no particular order, and are valid until the next call.
  std::span<const Found> hiddenFrom(std::span<const Vec3d> corners, const OccluderChoice& choice,
                                    const ObjectMask& known);
  // Leaves out what is known to be seen, too, and asks by lists of a cell that holds the region. What is
  // hidden from all of that cell must be known.
  std::span<const Found> hiddenFrom(std::span<const Vec3d> corners, const OccluderChoice& choice,
                                    const ObjectMask& known, const ObjectMask& seen,
                                    const CellCandidates& lists);
  // Bounds of the triangles that a point sees: both are below `enough`, or neither is.
  struct Bounds {
    std::uint64_t least = 0, most = 0;
  };
  Bounds trianglesSeenFrom(const Vec3d& eye, const OccluderChoice& choice, double enough);

  // Whether an occluder hides the object at this place of BoxTree::objects from the region.
  bool hides(std::span<const Vec3d> corners, const OccluderChoice& choice, const ObjectMask& known,
             std::uint32_t position);

  // Pairs of an occluder and a viewpoint that were asked about.
  std::uint64_t shadowCount() const { return shadow_count_; }

  static constexpr std::size_t kMaxCorners = 16;

 private:
  // The shadows of an occluder from all corners.
  struct Shadows {
    std::uint32_t occluder = 0;
    std::vector<Shadow> of_corner{};
  };
  // Occluders by their boxes: whatever hides something below the current node is among them.
  struct Candidates {
    LanesRange list{};     // without boxes: all that are useful to cells of the level
    bool counted = false;  // those that do not count are left out

    bool listed() const { return list.boxes != nullptr; }
  };
  // False if nothing can be asked: without objects or corners, or with too many corners.
  bool start(std::span<const Vec3d> corners, const OccluderChoice& choice, const ObjectMask& known);
  // Visits nodes of the shadow tree that are the children of one, and what is below them. depth: of these
  // nodes. False once done() holds.
  bool visit(std::uint32_t first, std::uint32_t count, Candidates candidates, std::size_t depth);
  bool visitGroup(std::uint32_t first, std::uint32_t count, Candidates candidates, std::size_t depth);
  bool visitBelow(std::uint32_t node, Candidates candidates, std::size_t depth);
  // Bits of the nodes of a group that an occluder hides, out of those that are left.
  std::uint32_t hideGroup(std::uint32_t first, std::uint32_t count, std::uint32_t left,
                          Candidates candidates);
  // Bits of the nodes of a group that a recent occluder hides, out of those that are left.
  std::uint32_t hideByRecent(std::uint32_t first, std::uint32_t count, std::uint32_t left);
  // Looks for an occluder that hides the node, and returns bits of what it hides of the group; 0 if there is
  // none.
  std::uint32_t hideByAny(std::uint32_t node, Candidates candidates, std::uint32_t first, std::uint32_t count,
                          std::uint32_t left);
  // Sets met_ to the candidates that some lines from the corners to the node may meet.
  void findMet(std::uint32_t node, Candidates candidates);
  // Returns those of the candidates that may hide something below a node. They are kept by its depth. Returns
  // no list if they are too many.
  Candidates candidatesBelow(std::uint32_t node, Candidates above, std::size_t depth);
  // Cones from some corners. box_of(i): the box where lines end that begin on the same side as corner i of a
  // box does.
  template <typename BoxOf>
  std::array<Cone, 4> conesTo(const BoxOf& box_of) const;
  // Whether the occluder is one of the choice, and not known to be superfluous.
  bool counts(std::uint32_t occluder, const Box& bounds) const;
  // Whether the occluder is separated from the corners.
  bool isSeparated(std::uint32_t occluder);
  // Sets lines_ to lines from each corner to two opposite corners of the node's box.
  void findLines(std::uint32_t node);
  // Whether all of these lines meet the occluder's box.
  bool meetsLines(std::uint32_t occluder) const;
  // Fills the shadows, as long as each hides the node; false if one does not.
  bool makeShadows(std::uint32_t occluder, std::uint32_t node, Shadows& shadows);
  // Reports these nodes of a group as hidden.
  void report(std::uint32_t occluder, std::uint32_t first, std::uint32_t nodes);
  bool done() const;

  const BakeScene& scene_;
  // The current question.
  std::uint64_t question_ = 0;  // its number
  std::span<const Vec3d> corners_;
  std::vector<std::uint32_t> side_of_;  // by corner: the corner of a box on the same side of the region
  const OccluderChoice* choice_ = nullptr;
  const ObjectMask* known_ = nullptr;
  std::optional<double> enough_;  // triangles; none: all that is hidden is to be found
  std::uint64_t hidden_triangles_ = 0, seen_triangles_ = 0;
  std::vector<Found> found_;
  // Scratch.
  static constexpr std::size_t kRecent = 2;
  std::array<Shadows, kRecent + 1> shadows_;  // recent occluders, the last used one first; then one to fill
  std::size_t recent_ = 0;
  std::deque<BoxLanes> candidates_;  // by depth: of the nodes there that are open
  std::vector<std::uint32_t> met_, places_;
  std::vector<SegmentTest> lines_;
  std::vector<std::uint64_t> separated_;  // by occluder: twice the last question about it, plus the answer
  ObjectMask nothing_;
  std::uint64_t shadow_count_ = 0;
};

}  // namespace sightline::pvs
