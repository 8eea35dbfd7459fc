#pragma once

#include <vector>

#include "src/occlusion/tree/occlusion_volume.h"
#include "src/occlusion/tree/polygon_split.h"

namespace sightline::occlusion {

// A part of an occluder, with its corners on the stack of the tree's builder.
struct Fragment {
  Piece piece;
  std::uint32_t volume = 0;
  // The edges that bound the shadow of each of its parts, also of those that a cut has separated from the
  // edge: those of the fragment before anything but the ends of open edges cut it, and those of its occluder
  // that it lacked then.
  Piece outline{};
};

// Cuts a fragment by a plane. Both parts get the same shadow plane for the cut. False: the cut would be badly
// conditioned, or one part would be empty; the fragment stays whole.
bool cutFragment(const Fragment& fragment, const Plane& plane, VolumeBuilder& volumes, PolygonStack& stack,
                 Fragment& front, Fragment& back);

// Orders occluders front to back as seen from the eye, by a small BSP tree of their own planes (Fuchs, Kedem
// and Naylor, SIGGRAPH 1980). All occluders face the eye, so the eye is in front of every plane: first what
// is in front of a splitter, then the splitter, then what is behind it. Occluders that cross a splitter's
// plane are cut; the cut gets a shadow plane that both parts share.
//
// Any order keeps the occlusion tree conservative; a wrong one costs tightness only. So where a cut would be
// badly conditioned the occluder stays whole.
class FrontToBack {
 public:
  // fragments: one for each volume on entry, the ordered ones on return.
  void order(VolumeBuilder& volumes, PolygonStack& stack, std::vector<Fragment>& fragments);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  // Ranges at a greater depth keep their order, for each level takes time in proportion to its occluders.
  static constexpr std::uint32_t kMaxDepth = 400;

  // The fragments work_[begin, end), which are to be ordered.
  struct Range {
    std::size_t begin = 0, end = 0;
    std::uint32_t depth = 0;
    std::uint32_t splitter = kNone;  // comes before them in the order
    std::size_t work_needed = 0;     // the first so many entries of work_ are still in use
  };

  void visit(const Range& range);
  std::uint32_t chooseSplitter(std::size_t begin, std::size_t end) const;
  Side sideOf(std::uint32_t fragment, std::uint32_t splitter) const;

  VolumeBuilder* volumes_ = nullptr;
  PolygonStack* stack_ = nullptr;
  std::vector<Fragment> all_;
  std::vector<std::uint32_t> work_;  // fragments of all ranges that are still to be visited
  std::vector<std::uint32_t> ordered_;
  std::vector<Range> ranges_;  // still to be visited, the next one last
};

}  // namespace sightline::occlusion
