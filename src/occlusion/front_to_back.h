#pragma once

#include <vector>

#include "src/occlusion/occlusion_volume.h"
#include "src/occlusion/polygon_split.h"

namespace sightline::occlusion {

// A part of an occluder; corners on the stack of the tree's builder.
struct Fragment {
  Piece piece;
  std::uint32_t volume = 0;
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
  // fragments: one a volume on entry, the ordered ones on return.
  void order(VolumeBuilder& volumes, PolygonStack& stack, std::vector<Fragment>& fragments);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  // Deeper, the order stays as it is: a level costs as much as there are occluders in it.
  static constexpr std::uint32_t kMaxDepth = 400;

  // Fragments to be ordered: work_[begin, end).
  struct Range {
    std::size_t begin = 0, end = 0;
    std::uint32_t depth = 0;
    std::uint32_t splitter = kNone;  // comes before them
    std::size_t work_needed = 0;     // of work_, from its beginning on
  };

  void visit(const Range& range);
  std::uint32_t chooseSplitter(std::size_t begin, std::size_t end) const;
  Side sideOf(std::uint32_t fragment, std::uint32_t splitter) const;

  VolumeBuilder* volumes_ = nullptr;
  PolygonStack* stack_ = nullptr;
  std::vector<Fragment> all_;
  std::vector<std::uint32_t> work_;  // fragments waiting, a stack of ranges
  std::vector<std::uint32_t> ordered_;
  std::vector<Range> ranges_;  // still to be visited, the next one last
};

}  // namespace sightline::occlusion
