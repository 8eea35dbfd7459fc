#pragma once

// Parts of a few points, placed by whole numbers, so that their occlusions are known exactly.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "src/layers/extents/extent_table.h"
#include "src/layers/pairs/pair_rules.h"
#include "src/layers/pairs/part_occlusion.h"
#include "src/layers/pairs/part_store.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers {

inline View viewFrom(const Vec3d& eye) {
  View view;
  view.eye = eye;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  return view;
}

// towards_eye: any length; it is not normalized, so that it is exact.
inline View viewFromAfar(const Vec3d& towards_eye) {
  View view = viewFrom({0, 0, 0});
  view.orthographic = true;
  view.forward = -towards_eye;
  return view;
}

struct PartWorld {
  PartStore store;
  ExtentTable extents;
  PairRules rules;
  PartOcclusion occlusion;
  View view = viewFrom({0, 0, 0});
  std::vector<std::vector<shapes::Points>> placed;  // points of each part's hulls in world space

  std::uint32_t addHull(const shapes::Points& points) {
    auto hull = buildHull(points);
    EXPECT_TRUE(hull.has_value());
    store.hulls.push_back(std::move(*hull));
    return static_cast<std::uint32_t>(store.hulls.size() - 1);
  }
  std::uint32_t addPart(const std::vector<std::uint32_t>& hulls, const Placement& placement = {}) {
    store.part_hulls.insert(store.part_hulls.end(), hulls.begin(), hulls.end());
    store.first_hull.push_back(static_cast<std::uint32_t>(store.part_hulls.size()));
    store.placements.push_back(placement);
    store.finite.push_back(1);
    placed.emplace_back();
    const auto part = static_cast<std::uint32_t>(placed.size() - 1);
    place(part, placement);
    return part;
  }
  std::uint32_t addPart(const std::vector<shapes::Points>& hulls, const Placement& placement = {}) {
    std::vector<std::uint32_t> numbers;
    for (const shapes::Points& points : hulls) {
      numbers.push_back(addHull(points));
    }
    return addPart(numbers, placement);
  }
  void place(std::uint32_t part, const Placement& placement) {
    store.placements[part] = placement;
    placed[part].clear();
    for (const std::uint32_t hull : store.hullsOf(part)) {
      placed[part].emplace_back();
      for (const Vec3d& p : store.hulls[hull].vertices) {
        placed[part].back().push_back(placement.point(p));
      }
    }
  }

  // Spatial extents along x, y and z, and angles that overlap nothing, since angles must not be used.
  void measure() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    extents.kinds.assign(3, ExtentAxis::Kind::kSpatial);
    extents.kinds.push_back(ExtentAxis::Kind::kAngular);
    extents.parts = placed.size();
    extents.lows.assign(4, std::vector<float>(placed.size(), 1.0f));
    extents.highs.assign(4, std::vector<float>(placed.size(), -1.0f));
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t part = 0; part < placed.size(); ++part) {
        Interval interval{kInfinity, -kInfinity};
        for (const shapes::Points& points : placed[part]) {
          for (const Vec3d& p : points) {
            const auto value = static_cast<float>(p[axis]);
            interval = unite(interval, {std::nextafter(value, -kInfinity), std::nextafter(value, kInfinity)});
          }
        }
        extents.lows[static_cast<std::size_t>(axis)][part] = interval.low;
        extents.highs[static_cast<std::size_t>(axis)][part] = interval.high;
      }
    }
  }
  void beginFrame(std::uint32_t expiry = 1) { occlusion.beginFrame(view, store, extents, rules, expiry); }

  // Returns the exact answer.
  bool occludesExactly(std::uint32_t front, std::uint32_t back) const {
    return anyPair(front, back, [&](const shapes::Points& f, const shapes::Points& b) {
      return view.orthographic ? test::occludesExactlyTowards(f, b, -view.forward)
                               : test::occludesExactly(f, b, view.eye);
    });
  }
  bool meetExactly(std::uint32_t a, std::uint32_t b) const {
    return anyPair(a, b, test::convexHullsIntersect);
  }

 private:
  template <typename Test>
  bool anyPair(std::uint32_t first, std::uint32_t second, const Test& test) const {
    for (const shapes::Points& a : placed[first]) {
      for (const shapes::Points& b : placed[second]) {
        if (test(a, b)) {
          return true;
        }
      }
    }
    return false;
  }
};

}  // namespace sightline::layers
