#pragma once

// Scenes of a few parts with small whole coordinates, their exact occlusions, and the answer of a sorter.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sightline/layers/layer_sorter.h"
#include "tests/layers/sorter_choices.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/strong_components.h"
#include "tests/support/translation.h"

namespace sightline::made {

using shapes::Points;
using shapes::Random;
using test::translation;
using Pair = std::pair<std::uint32_t, std::uint32_t>;  // two parts: front and back
using Group = std::vector<std::uint32_t>;              // parts of a group, ascending

struct MadePart {
  std::vector<Points> hulls;  // in the part's space
  Mat4 world_from_part;
  PartSettings settings;
  bool enabled = true;
};

// A part of one hull that is not moved.
inline MadePart solid(const Points& points, const PartSettings& settings = {}) {
  return {.hulls = {points}, .world_from_part = {}, .settings = settings, .enabled = true};
}

struct MadeScene {
  std::vector<MadePart> parts;
  View view;
};

inline std::vector<Points> placed(const MadePart& part) {
  std::vector<Points> hulls = part.hulls;
  for (Points& points : hulls) {
    for (Vec3d& p : points) {
      p = transformPoint(part.world_from_part, p);
    }
  }
  return hulls;
}

// Returns the hull of some points. Hulls are kept, since a scene's parts are added to many sorters.
inline ConvexHull builtOf(const Points& points) {
  constexpr std::size_t kMaxKept = 1000;
  static std::map<std::vector<std::array<double, 3>>, ConvexHull> kept;
  std::vector<std::array<double, 3>> key;
  for (const Vec3d& p : points) {
    key.push_back({p.x, p.y, p.z});
  }
  const auto found = kept.find(key);
  if (found != kept.end()) {
    return found->second;
  }
  if (kept.size() == kMaxKept) {
    kept.clear();
  }
  return kept.emplace(std::move(key), buildHull(points).value()).first->second;
}

inline PartId addMade(LayerSorter& sorter, const MadePart& part) {
  std::vector<HullId> hulls;
  for (const Points& points : part.hulls) {
    hulls.push_back(sorter.addHull(builtOf(points)));
  }
  const PartId id = sorter.addPart(hulls, part.settings);
  EXPECT_TRUE(sorter.setTransform(id, part.world_from_part));
  sorter.setEnabled(id, part.enabled);
  return id;
}

inline LayerSorter sorterOf(const MadeScene& scene, const LayerSettings& settings) {
  LayerSorter sorter(settings);
  for (const MadePart& part : scene.parts) {
    addMade(sorter, part);
  }
  return sorter;
}

// The answer of a sorter in a form that can be compared and printed.
struct Answer {
  std::vector<Group> in_order;
  std::set<Group> groups;
  std::vector<Pair> arcs, collisions;

  explicit Answer(const LayerOrder& order) {
    for (std::size_t i = 0; i < order.groups(); ++i) {
      Group group;
      for (const PartId part : order.group(i)) {
        group.push_back(part.value);
      }
      std::sort(group.begin(), group.end());
      groups.insert(group);
      in_order.push_back(std::move(group));
    }
    for (const LayerArc& arc : order.arcs) {
      arcs.emplace_back(arc.front.value, arc.back.value);
    }
    for (const LayerArc& arc : order.collisions) {
      collisions.emplace_back(arc.front.value, arc.back.value);
    }
  }
  std::size_t groupOf(std::uint32_t part) const {
    for (std::size_t i = 0; i < in_order.size(); ++i) {
      if (std::binary_search(in_order[i].begin(), in_order[i].end(), part)) {
        return i;
      }
    }
    ADD_FAILURE() << "part " << part << " is not in the order";
    return 0;
  }
  bool hasArc(std::uint32_t front, std::uint32_t back) const {
    return std::binary_search(arcs.begin(), arcs.end(), Pair(front, back));
  }
};

inline void expectSame(const Answer& a, const Answer& b) {
  EXPECT_EQ(a.groups, b.groups);
  EXPECT_EQ(a.arcs, b.arcs);
  EXPECT_EQ(a.collisions, b.collisions);
}

// The exact arcs, collisions and groups of the enabled parts that are sorted.
struct Truth {
  std::vector<Pair> arcs, collisions;  // ascending
  std::set<Group> groups;              // strongly connected components

  bool together(std::uint32_t a, std::uint32_t b) const {
    return std::any_of(groups.begin(), groups.end(), [&](const Group& group) {
      return std::binary_search(group.begin(), group.end(), a) &&
             std::binary_search(group.begin(), group.end(), b);
    });
  }
};

inline std::set<Group> strongComponents(const std::vector<std::uint32_t>& parts,
                                        const std::vector<Pair>& arcs) {
  const std::vector<std::uint32_t> component =
      test::strongComponents(parts.empty() ? 0 : parts.back() + 1, arcs);
  std::vector<Group> groups(component.size());
  for (const std::uint32_t part : parts) {
    groups[component[part]].push_back(part);
  }
  std::erase_if(groups, [](const Group& group) { return group.empty(); });
  return {groups.begin(), groups.end()};
}

template <typename Test>
bool anyHulls(const std::vector<Points>& a, const std::vector<Points>& b, const Test& test) {
  for (const Points& p : a) {
    for (const Points& q : b) {
      if (test(p, q)) {
        return true;
      }
    }
  }
  return false;
}

inline Truth truthOf(const MadeScene& scene) {
  const View& view = scene.view;
  const auto occludes = [&view](const Points& front, const Points& back) {
    return view.orthographic ? test::occludesExactlyTowards(front, back, -view.forward)
                             : test::occludesExactly(front, back, view.eye);
  };
  Truth truth;
  std::vector<std::uint32_t> parts;
  std::vector<std::vector<Points>> hulls;
  for (std::uint32_t i = 0; i < scene.parts.size(); ++i) {
    hulls.push_back(placed(scene.parts[i]));
    if (scene.parts[i].enabled && scene.parts[i].settings.place == PartSettings::Place::kSorted) {
      parts.push_back(i);
    }
  }
  for (const std::uint32_t a : parts) {
    for (const std::uint32_t b : parts) {
      if (a >= b) {
        continue;
      }
      const bool intersect = anyHulls(hulls[a], hulls[b], test::convexHullsIntersect);
      if (intersect) {
        truth.collisions.emplace_back(a, b);
      }
      if (intersect || anyHulls(hulls[a], hulls[b], occludes)) {
        truth.arcs.emplace_back(a, b);
      }
      if (intersect || anyHulls(hulls[b], hulls[a], occludes)) {
        truth.arcs.emplace_back(b, a);
      }
    }
  }
  std::sort(truth.arcs.begin(), truth.arcs.end());
  truth.groups = strongComponents(parts, truth.arcs);
  return truth;
}

inline void expectOrdered(const Answer& answer, const std::vector<Pair>& arcs) {
  for (const Pair& arc : arcs) {
    EXPECT_LE(answer.groupOf(arc.first), answer.groupOf(arc.second))
        << arc.first << " occludes " << arc.second << " and is behind it";
  }
}

// Expects exactly the truth, with or without arcs between groups.
inline void expectTrue(const Answer& answer, const Truth& truth, bool all_arcs) {
  EXPECT_EQ(answer.groups, truth.groups);
  EXPECT_EQ(answer.collisions, truth.collisions);
  std::vector<Pair> arcs = truth.arcs;
  if (!all_arcs) {
    std::erase_if(arcs, [&](const Pair& arc) { return !truth.together(arc.first, arc.second); });
  }
  EXPECT_EQ(answer.arcs, arcs);
  expectOrdered(answer, truth.arcs);
}

// Expects that nothing of the truth is missing; the answer must have all arcs.
inline void expectNothingMissing(const Answer& answer, const Truth& truth) {
  expectOrdered(answer, truth.arcs);
  EXPECT_TRUE(std::includes(answer.arcs.begin(), answer.arcs.end(), truth.arcs.begin(), truth.arcs.end()));
  EXPECT_TRUE(std::includes(answer.collisions.begin(), answer.collisions.end(), truth.collisions.begin(),
                            truth.collisions.end()));
}

// Settings of a sorter with a name to print.
struct Way {
  std::string name;
  LayerSettings settings;
};

// Both sorts with both searches and several extents.
inline std::vector<Way> allWays(bool all_arcs, const ExtentTreeSettings& tree = {.min_gain = 1}) {
  std::vector<ExtentAxis> mixed = worldExtents();
  const std::vector<ExtentAxis> camera = cameraExtents();
  mixed.insert(mixed.end(), camera.begin(), camera.end());
  mixed.push_back({ExtentAxis::Kind::kAngular, ExtentAxis::Frame::kWorld, {1, 2, 0}, {0, 0, 3}});
  mixed.push_back({ExtentAxis::Kind::kSpatial, ExtentAxis::Frame::kCamera, {1, 1, 0}, {}});
  std::vector<Way> ways;
  for (const SortChoice sort : kSortChoices) {
    for (const SearchChoice search : kSearchChoices) {
      for (int extents = 0; extents < 4; ++extents) {
        LayerSettings settings;
        settings.sort = sortOf(sort);
        settings.search = searchOf(search, tree);
        settings.arcs = all_arcs ? LayerArcs::kAll : LayerArcs::kWithinGroups;
        settings.extents = extents == 0   ? camera
                           : extents == 1 ? worldExtents()
                           : extents == 2 ? mixed
                                          : std::vector<ExtentAxis>{};
        settings.conditioning = extents != 0 || sort != SortChoice::kIncremental;
        settings.conditioning_axis = 2;
        ways.push_back(
            {std::string(nameOf(sort)) + ", " + nameOf(search) + ", extents " + std::to_string(extents),
             settings});
      }
    }
  }
  return ways;
}

inline Points randomHull(Random& random) {
  switch (random.below(9)) {
    case 0:
      return shapes::randomFlatGrid(random, 1, 2, 0);
    case 1:
      return shapes::randomFlatGrid(random, 2, 1, 1);
    case 2:
      return shapes::randomFlatGrid(random, 4, 1, 2);
    case 3:
      return shapes::cube({}, random.whole(1, 2));
    case 4:  // long parts make cycles
      return shapes::randomGrid(random, 2 + random.below(3), 7);
    case 5: {
      Vec3d half{0.5, 0.5, 0.5};
      half[static_cast<int>(random.below(3))] = 7.0;
      return shapes::box(-half, half);
    }
    default:
      return shapes::randomGrid(random, 4 + random.below(4), 1 + static_cast<int>(random.below(2)));
  }
}

// Returns a translation by whole numbers; one in three also turns, stretches or shears by whole numbers.
inline Mat4 randomWholeTransform(Random& random, int reach) {
  Mat4 m;
  if (random.below(3) == 0) {
    constexpr int kKinds[5][9] = {{0, 1, 0, 0, 0, 1, 1, 0, 0},
                                  {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                  {-1, 0, 0, 0, 1, 0, 0, 0, 1},
                                  {2, 0, 0, 0, 1, 0, 0, 0, 1},
                                  {1, 1, 0, 0, 1, 0, 0, 0, 1}};
    const int* kind = kKinds[random.below(5)];
    for (int i = 0; i < 9; ++i) {
      m(i / 3, i % 3) = kind[i];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 3) = random.whole(-reach, reach);
  }
  return m;
}

inline MadePart randomPart(Random& random, int reach) {
  MadePart part;
  const std::uint32_t hulls = random.below(3) == 0 ? 1 + random.below(3) : 1;
  for (std::uint32_t i = 0; i < hulls; ++i) {
    part.hulls.push_back(randomHull(random));
  }
  part.world_from_part = randomWholeTransform(random, reach);
  return part;
}

inline View viewFrom(const Vec3d& eye, const Vec3d& forward = {0, 0, -1}) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, {0, 1, 0});
  return view;
}

// Returns a view from a whole position, a vertex, or halfway between two vertices, in any direction. One in
// four is orthographic along an axis.
inline View randomView(Random& random, const MadeScene& scene, int reach) {
  if (random.below(4) == 0) {
    Vec3d forward;
    forward[static_cast<int>(random.below(3))] = random.below(2) == 0 ? 1.0 : -1.0;
    View view = viewFrom(shapes::randomGrid(random, 1, reach)[0], forward);
    view.orthographic = true;
    EXPECT_EQ(view.forward, forward);
    return view;
  }
  Vec3d eye = shapes::randomGrid(random, 1, reach)[0];
  if (!scene.parts.empty() && random.below(4) == 0) {
    const std::size_t part = random.below(static_cast<std::uint32_t>(scene.parts.size()));
    const Points points = placed(scene.parts[part])[0];
    const auto count = static_cast<std::uint32_t>(points.size());
    eye = (points[random.below(count)] + points[random.below(count)]) / 2.0;
  }
  return viewFrom(eye, random.direction());
}

inline MadeScene randomScene(Random& random, std::uint32_t parts, int reach) {
  MadeScene scene;
  for (std::uint32_t i = 0; i < parts; ++i) {
    scene.parts.push_back(randomPart(random, reach));
  }
  scene.view = randomView(random, scene, reach + 2);
  return scene;
}

// Returns crossing bars in a layer, seen from above, of which few intersect but many form cycles.
inline MadeScene randomBars(Random& random, std::uint32_t count) {
  MadeScene scene;
  for (std::uint32_t i = 0; i < count; ++i) {
    Points bar = shapes::randomGrid(random, 2, 12);
    for (Vec3d& end : bar) {
      end.z = random.whole(-30, 30);
    }
    if (random.below(2) == 0) {
      bar.push_back(bar[0] + Vec3d{1, 0, 0});
      bar.push_back(bar[1] + Vec3d{0, 1, 0});
    }
    scene.parts.push_back({.hulls = {bar}, .world_from_part = {}, .settings = {}, .enabled = true});
  }
  scene.view = viewFrom({0.0, 0.0, 1.0 * random.whole(31, 99)});
  scene.view.orthographic = random.below(2) == 0;
  return scene;
}

}  // namespace sightline::made
