#include "src/comparison/occluders/occluder_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/comparison/picture_scenes.h"

namespace sightline::comparison {
namespace {

using namespace picture_scenes;

constexpr PictureShape kShape{32, 90.0, 0.1};

struct Pictured {
  OccluderPicture picture;
  IdBuffer nearest;
  std::vector<Occludee> occludees;
  OccluderStack stack;

  Pictured(const Model& model, const Vec3d& eye, const Vec3d& forward, double min_area = 0.0) {
    std::vector<NearOccluder> candidates;
    OccluderFilter(model.set).find(eye, 0.0, candidates);
    picture.draw(model.set, candidates, eye, forward, kShape, min_area);
    nearest.clear(picture);
    for (std::uint32_t o = 0; o < picture.occluders().size(); ++o) {
      nearest.draw(picture, o);
    }
    occludeesInPicture(model.hierarchy, findOccludees(model.hierarchy, 0, 1), picture.view(),
                       kShape.resolution, occludees);
    stack.build(picture, nearest, occludees);
  }
};

// The depth at which a ray through a pixel's centre hits the polygon; 0: not at all. Sets `unsure` near an
// edge. In space, by point in polygon; only the ray comes from the picture.
double depthAlong(const OccluderSet& set, const Occluder& occluder, const Vec3d& eye, const Vec3d& ray,
                  bool& unsure) {
  const double height = occluder.plane.evaluate(eye);
  if (height < 0.0 && !occluder.double_sided) {
    return 0.0;
  }
  const double depth = -height / dot(occluder.plane.normal, ray);
  if (!(depth > 0.0)) {
    return 0.0;
  }
  const Vec3d hit = eye + ray * depth;
  double inside = 1e300;
  const auto vertices = set.verticesOf(occluder);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d a(vertices[i]), b(vertices[(i + 1) % vertices.size()]);
    inside = std::min(inside, dot(normalized(cross(occluder.plane.normal, b - a)), hit - a));
  }
  unsure |= std::abs(inside) < 1e-5 * (1.0 + depth) || std::abs(depth - kShape.near) < 1e-5;
  return inside > 0.0 && depth > kShape.near ? depth : 0.0;
}

// A ray with a depth of 1 along forward, for the pixel (x, y) counted from the lower left corner.
Vec3d rayThrough(const scene::PixelView& view, std::uint32_t pixel) {
  const double t = std::tan(kShape.view_angle_deg * std::numbers::pi / 360.0);
  const double u = (2.0 * (pixel % kShape.resolution + 0.5) / kShape.resolution - 1.0) * t;
  const double v = (2.0 * (pixel / kShape.resolution + 0.5) / kShape.resolution - 1.0) * t;
  return view.forward + view.right * u + view.up * v;
}

double nearestDepth(const Box& box, const scene::PixelView& view) {
  double nearest = 1e300;
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                       i & 4 ? box.max.z : box.min.z);
    nearest = std::min(nearest, dot(view.forward, corner - view.eye));
  }
  return nearest;
}

// Who is in front of the depth in a pixel.
std::set<std::uint32_t> frontOf(const Model& model, const scene::PixelView& view, std::uint32_t pixel,
                                double depth, bool& unsure) {
  std::set<std::uint32_t> front;
  for (std::uint32_t o = 0; o < model.set.occluders.size(); ++o) {
    const double at =
        depthAlong(model.set, model.set.occluders[o], view.eye, rayThrough(view, pixel), unsure);
    unsure |= at > 0.0 && std::abs(at - depth) < 1e-4 * depth;
    if (at > 0.0 && at < depth) {
      front.insert(o);
    }
  }
  return front;
}

TEST(OccluderPicture, CoversThePixelsWhoseRaysHitThePolygonAtItsDepth) {
  std::size_t covered = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Model model = randomModel(random, 12, 2);
    const Vec3d eye = random.point(3.0), forward = normalized(random.point(1.0));
    const Pictured pictured(model, eye, forward);
    std::vector<std::vector<double>> depth(model.set.occluders.size(),
                                           std::vector<double>(pictured.picture.pixelCount(), 0.0));
    for (std::uint32_t o = 0; o < pictured.picture.occluders().size(); ++o) {
      pictured.picture.forEachPixel(o, [&](std::uint32_t pixel, float reciprocal_depth) {
        depth[pictured.picture.occluders()[o].id.value][pixel] = 1.0 / reciprocal_depth;
      });
    }
    for (std::uint32_t o = 0; o < model.set.occluders.size(); ++o) {
      for (std::uint32_t pixel = 0; pixel < pictured.picture.pixelCount(); ++pixel) {
        bool unsure = false;
        const double expected = depthAlong(model.set, model.set.occluders[o], eye,
                                           rayThrough(pictured.picture.view(), pixel), unsure);
        if (!unsure) {
          ASSERT_NEAR(depth[o][pixel], expected, 1e-4 * (1.0 + expected)) << o << " in pixel " << pixel;
          covered += expected > 0.0;
        }
      }
    }
  }
  EXPECT_GT(covered, 10000u);
}

TEST(OccluderStack, HasTheOccludersThatRaysHitBeforeTheOccludee) {
  std::size_t hidden = 0, seen = 0, slots = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Model model = randomModel(random, 40, 30, 4.0);
    const Vec3d eye = random.point(1.0), forward = normalized(random.point(1.0));
    Pictured pictured(model, eye, forward);
    for (std::uint32_t i = 0; i < pictured.occludees.size(); ++i) {
      const Occludee& occludee = pictured.occludees[i];
      const double depth =
          nearestDepth(model.hierarchy.nodes[occludee.node.value].bounds, pictured.picture.view());
      bool unsure = false, covered = true;
      CombinationTable expected;
      for (std::uint32_t y = occludee.rect.low; y < occludee.rect.high; ++y) {
        for (std::uint32_t x = occludee.rect.left; x < occludee.rect.right; ++x) {
          const auto front =
              frontOf(model, pictured.picture.view(), y * kShape.resolution + x, depth, unsure);
          covered &= !front.empty();
          expected.add(std::vector<std::uint32_t>(front.begin(), front.end()));
        }
      }
      if (unsure) {
        continue;
      }
      const auto found = pictured.stack.hidden();
      ASSERT_EQ(std::binary_search(found.begin(), found.end(), i), covered) << "occludee " << i;
      seen += !covered;
      hidden += covered;
      if (!covered) {
        continue;
      }
      expected.finish();
      CombinationTable table;
      pictured.stack.tableOf(occludee, table);
      // By id in both.
      CombinationTable by_id;
      for (std::uint32_t s = 0; s < table.slotCount(); ++s) {
        std::vector<std::uint32_t> ids;
        for (const std::uint32_t member : table.slot(s)) {
          ids.push_back(pictured.picture.occluders()[member].id.value);
        }
        by_id.add(ids);
      }
      by_id.finish();
      ASSERT_EQ(by_id.slotCount(), expected.slotCount()) << "occludee " << i;
      slots += expected.slotCount();
      for (std::uint32_t s = 0; s < expected.slotCount(); ++s) {
        EXPECT_TRUE(std::ranges::equal(by_id.slot(s), expected.slot(s))) << "occludee " << i << " slot " << s;
      }
    }
  }
  EXPECT_GT(seen, 100u);
  EXPECT_GT(hidden, 100u);
  EXPECT_GT(slots, hidden + 100);  // many have several
}

TEST(OccluderStack, HasARectangleAroundTheImageThatEndsAtThePicturesBorder) {
  std::size_t cut = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Model model = randomModel(random, 1, 20);
    const Vec3d eye = random.point(1.0), forward = normalized(random.point(1.0));
    const Pictured pictured(model, eye, forward);
    const scene::PixelView& view = pictured.picture.view();
    std::set<std::uint32_t> in_picture;
    for (const Occludee& occludee : pictured.occludees) {
      in_picture.insert(occludee.node.value);
      const PixelRect& rect = occludee.rect;
      ASSERT_LT(rect.left, rect.right);
      ASSERT_LT(rect.low, rect.high);
      ASSERT_LE(std::max(rect.right, rect.high), kShape.resolution);
      cut += rect.left == 0 || rect.low == 0;
    }
    // A point of a box that is in the picture lies in the box's rectangle.
    for (const NodeIndex node : findOccludees(model.hierarchy, 0, 1)) {
      const Box& box = model.hierarchy.nodes[node.value].bounds;
      for (int i = 0; i < 20 && nearestDepth(box, view) > kShape.near; ++i) {
        Vec3d point;
        for (int axis = 0; axis < 3; ++axis) {
          point[axis] = random.in(box.min[axis], box.max[axis]);
        }
        const Vec3d c = view.toCamera(point - eye);
        const double x = view.pixelX(c), y = view.pixelY(c);
        if (std::min(x, y) < 0.0 || std::max(x, y) >= kShape.resolution) {
          continue;
        }
        ASSERT_TRUE(in_picture.contains(node.value));
        const auto at = std::find_if(pictured.occludees.begin(), pictured.occludees.end(),
                                     [node](const Occludee& o) { return o.node == node; });
        EXPECT_TRUE(x >= at->rect.left && x <= at->rect.right && y >= at->rect.low && y <= at->rect.high);
      }
    }
  }
  EXPECT_GT(cut, 20u);
}

// Four occluders in front of one box, the two in the middle at the same place in the picture: Figure 2.
TEST(OccluderStack, GivesTheTableOfFigureTwo) {
  Model model;
  model.addRectangle(-3.0, -0.5, -2.0, 2.0, -5.0);  // A, left
  model.addRectangle(-0.7, 0.7, -2.0, 2.0, -6.0);   // B, middle
  model.addRectangle(0.5, 3.0, -2.0, 2.0, -5.0);    // C, right
  model.addRectangle(-0.5, 0.5, -2.0, 2.0, -4.0);   // D, middle
  model.addBox({-1.5f, -1.0f, -9.0f}, {1.5f, 1.0f, -8.0f});
  model.finish();
  Pictured pictured(model, {0, 0, 0}, {0, 0, -1});
  ASSERT_EQ(pictured.stack.hidden().size(), 1u);
  CombinationTable table;
  pictured.stack.tableOf(pictured.occludees[pictured.stack.hidden()[0]], table);
  MinimumSetSearch search;
  std::set<std::set<double>> sets;  // occluders by the depth and the place of their middle
  for (const MinimumSet& set : search.find(table, std::vector<double>(4, 1.0), {8, 1000})) {
    std::set<double> members;
    for (const std::uint32_t m : set.members) {
      const Occluder& o = model.set[pictured.picture.occluders()[m].id];
      members.insert(o.centroid.x == 0.0f ? -static_cast<double>(o.centroid.z) : 100.0 * o.centroid.x);
    }
    sets.insert(members);
  }
  const double a = -175.0, b = 6.0, c = 175.0, d = 4.0;
  EXPECT_EQ(sets, (std::set<std::set<double>>{{a, b, c}, {a, c, d}}));
}

TEST(Occludees, AreTheFirstSmallEnoughNodesOnTheWayDown) {
  Random random(3);
  std::vector<Box> boxes;
  std::vector<std::uint32_t> costs;
  for (int i = 0; i < 200; ++i) {
    const Vec3d at = random.point(50.0);
    boxes.push_back({Vec3f(at), Vec3f(at + Vec3d(1, 1, 1))});
    costs.push_back(i % 40 == 0 ? 500 : 1 + random.below(60));
  }
  const Hierarchy hierarchy = buildHierarchy(boxes, costs);
  const auto found = findOccludees(hierarchy, 20, 256);
  // Straight from the definition, with each node's parent.
  std::vector<std::uint32_t> parent(hierarchy.nodes.size(), 0);
  for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
    if (!hierarchy.nodes[n].leaf()) {
      parent[hierarchy.left(NodeIndex(n)).value] = n;
      parent[hierarchy.right(NodeIndex(n)).value] = n;
    }
  }
  std::vector<NodeIndex> expected;
  for (std::uint32_t n = 1; n < hierarchy.nodes.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.cost > 20 && (node.cost <= 256 || node.leaf()) && hierarchy.nodes[parent[n]].cost > 256) {
      expected.emplace_back(n);
    }
  }
  EXPECT_GT(expected.size(), 10u);
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace sightline::comparison
