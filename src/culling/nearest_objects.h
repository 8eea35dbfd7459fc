#pragma once

// The objects in a view frustum that are nearest to a point, without a look at all others.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/math/frustum.h"
#include "src/culling/object_bits.h"
#include "src/culling/set_filter.h"

namespace sightline::culling {

class NearestObjects {
 public:
  NearestObjects(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy), object_bounds_(object_bounds), found_(object_bounds.size()) {}

  // Appends objects in the frustum to out, in ascending order, leaf by leaf from the nearest one on, until
  // there are `most` or a few more. Returns whether these are all. filter: objects that are not in its set
  // are left out, it needs SetFilter::Marks::kAll; null: no filter.
  bool find(const Frustum& frustum, const Vec3d& eye, const SetFilter* filter, std::size_t most,
            std::vector<ObjectId>& out);

 private:
  // A node whose children or objects have not been looked at.
  struct Waiting {
    double distance = 0.0;  // of its box from the eye, squared
    std::uint32_t node = 0;
    std::uint8_t planes = 0;  // bit i is set if the frustum's plane i may cut the node
  };
  static bool comesLater(const Waiting& a, const Waiting& b);
  void add(std::uint32_t node, std::uint8_t planes, const Frustum& frustum, const Vec3d& eye,
           const SetFilter* filter);
  Waiting takeNearest();

  const Hierarchy& hierarchy_;
  std::span<const Box> object_bounds_;
  ObjectBits found_;
  std::vector<Waiting> waiting_;  // a heap, the nearest one first
};

}  // namespace sightline::culling
