#pragma once

#include <cstdint>
#include <vector>

#include "sightline/occlusion/visibility.h"
#include "src/occlusion/eye_box.h"
#include "src/occlusion/tree/box_image.h"
#include "src/occlusion/tree/tree_data.h"

namespace sightline::occlusion {

// The states of Visibility, and kNothing for parts outside the frustum, which do not count.
enum class State : std::uint8_t { kHidden, kPartial, kVisible, kNothing };

constexpr State combine(State a, State b) {
  return a == State::kNothing ? b : b == State::kNothing || a == b ? a : State::kPartial;
}

// The work of queries since the counts were last reset.
struct QueryCounts {
  std::uint64_t plane_tests = 0;  // boxes, faces or parts of faces compared with a plane of the tree
  std::uint64_t cuts = 0;         // faces or parts of faces that were split, images that were cut
};

// A box that is to be classified.
struct BoxQuestion {
  EyeBox box;
  // How the box is compared with the occluder of a leaf in shadow. True: by fragments of faces and the
  // occluder's plane (standard algorithm), or by what crosses that plane and the fragment's pyramid
  // (modified). False: by the whole box and the plane.
  bool exact = true;
  // Bit i is set where the box may reach beyond the frustum's plane i.
  std::uint8_t frustum_planes = 0xff;

  bool mayCross(std::size_t frustum_plane) const { return (frustum_planes >> frustum_plane & 1) != 0; }
};

// The standard algorithm (sections 5.1, 5.2): the faces of the box that face the eye are split by the tree's
// planes.
class SplittingQuery {
 public:
  State classify(const TreeData& tree, const BoxQuestion& question);

  QueryCounts counts;

 private:
  // The parts of a piece in front of a plane and behind it; a part may be empty.
  struct Parts {
    Piece front, back;
  };
  // A piece on its way down the tree.
  struct Waiting {
    Link link;
    Piece piece;
    std::size_t corners_needed = 0;  // the lowest so many corners of the stack are still in use
  };

  State face(Piece piece);
  State polygon(Link link, Piece piece);
  Parts partsOf(const TreeNode& node, Piece piece);
  SplitResult split(const TreeNode& node, Piece piece, double shift);
  State leaf(Link link, Piece piece) const;

  const TreeData* tree_ = nullptr;
  const BoxQuestion* question_ = nullptr;
  double reach_ = 0.0;           // l1Norm() of the box's farthest corner, metres
  double on_plane_scale_ = 0.0;  // see PolygonStack::split; that of the tree is added
  // The parts overlap at every plane, not at those of shared edges alone. It is so where the rounding of far
  // corners may exceed the inset of a near edge, and for orthographic eyes.
  bool overlapping_ = false;
  PolygonStack stack_;
  std::vector<Waiting> waiting_;
};

// The modified algorithm (section 6.2): the box is only found to be before or behind the tree's planes. A box
// on both sides of several planes need not reach a leaf behind them: where a leaf would change the answer,
// the box's image is cut to find out whether it reaches the leaf.
class PlaneQuery {
 public:
  State classify(const TreeData& tree, const BoxQuestion& question);

  QueryCounts counts;

 private:
  // A plane on the path that the box crosses, and the side on which the path goes on.
  struct Crossing {
    std::uint32_t node = 0;
    bool front = false;
  };
  // The side of a crossed plane that is still to be visited.
  struct Waiting {
    Link link;
    std::uint32_t crossings = 0;  // number of crossings on the path to it; the last is of that plane
  };

  Side sideOf(const TreeNode& node);
  State traverse(Link link);
  Link descend(Link link);
  State leaf(Link link, State so_far);
  bool imageReaches();

  const TreeData* tree_ = nullptr;
  const BoxQuestion* question_ = nullptr;
  Vec3d center_, half_;
  double reach_ = 0.0;
  std::vector<Waiting> waiting_;
  std::vector<Crossing> path_;
  bool has_image_ = false;  // image_ is that of the current box
  BoxImage image_;          // cut by the first cutCount() planes of path_
};

// Compares a whole box with the plane of a leaf's occluder: hidden only when all of it lies behind.
State boxBehindSupport(const OcclusionVolume& volume, const EyeBox& box);

// Whether the box has no point in the pyramid from the eye to the fragment (orthographic: the prism from the
// camera's plane). True is certain; ties are false.
bool disjointFromPyramid(const TreeData& tree, const ShadowLeaf& leaf, const EyeBox& box);

}  // namespace sightline::occlusion
