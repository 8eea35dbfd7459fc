#include "src/pvs/format/structure.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "tests/support/made_visibility.h"

namespace sightline::pvs {
namespace {

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();
constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

// A root with an inner node of two leaves, and a leaf: nodes 0, 1 (2, 3), 4.
BoxTree smallTree() {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  BoxTree tree;
  tree.nodes = {
      {box, 5, 0, 3, 3}, {box, 4, 0, 2, 2}, {box, 3, 0, 1, 1}, {box, 4, 1, 1, 1}, {box, 5, 2, 1, 1}};
  tree.objects = {ObjectId(2u), ObjectId(0u), ObjectId(1u)};
  return tree;
}

// A root with eight cells, the third of which has eight children.
VisibilityOctree smallOctree() {
  VisibilityOctree octree;
  octree.min = {0, 0, 0};
  octree.max = {1, 2, 3};
  octree.nodes.assign(17, kOctreeLeaf);
  octree.nodes[0] = 1;
  octree.nodes[3] = 9;
  for (std::uint32_t i = 0, leaf = 0; i < 17; ++i) {
    if (i != 0 && i != 3) {
      octree.nodes[i] = kOctreeLeaf | leaf++;
      octree.depths.push_back(i < 9 ? 1 : 2);
      octree.leaves.push_back({leaf % 4});
      octree.reasons.push_back(static_cast<std::uint8_t>(leaf % kStopReasons));
    }
  }
  octree.planes = {{{0, 1, 0}, 1.0, 0.5}};
  octree.leaves[5] = {0, 0, 1, 3};
  return octree;
}

template <typename T>
struct Damage {
  const char* what;
  std::function<void(T&)> apply;
};

TEST(BoxTreeCheck, TakesSoundTrees) {
  EXPECT_TRUE(checkBoxTree(smallTree().view()));
  for (std::uint32_t objects = 1; objects < 200; ++objects) {
    made::Random random(objects);
    const Status sound = checkBoxTree(made::boxTree(objects, random).view());
    EXPECT_TRUE(sound) << objects << " objects: " << sound.error().message;
  }
}

TEST(BoxTreeCheck, TakesInfiniteBoxesBelowAnInfiniteRoot) {
  BoxTree tree = smallTree();
  const Box infinite{{-kFloatInfinity, -kFloatInfinity, -kFloatInfinity},
                     {kFloatInfinity, kFloatInfinity, kFloatInfinity}};
  tree.nodes[0].bounds = tree.nodes[4].bounds = infinite;
  EXPECT_TRUE(checkBoxTree(tree.view()));
}

TEST(BoxTreeCheck, RefusesEveryDamage) {
  const std::vector<Damage<BoxTree>> damages{
      {"nothing", [](BoxTree& t) { t = {}; }},
      {"no objects", [](BoxTree& t) { t.objects.clear(); }},
      {"root ends early", [](BoxTree& t) { t.nodes[0].end = 4; }},
      {"root ends late", [](BoxTree& t) { t.nodes[0].end = 6; }},
      {"child beyond its parent", [](BoxTree& t) { t.nodes[3].end = 5; }},
      {"node that ends at itself", [](BoxTree& t) { t.nodes[2].end = 2; }},
      {"node that ends before itself", [](BoxTree& t) { t.nodes[4].end = 1; }},
      {"node that ends at 0", [](BoxTree& t) { t.nodes[1].end = 0; }},
      {"node that ends far away", [](BoxTree& t) { t.nodes[1].end = 0xffffffffu; }},
      {"root without an object", [](BoxTree& t) { t.nodes[0].object_count = 2; }},
      {"root that begins late", [](BoxTree& t) { t.nodes[0].first_object = 1; }},
      {"leaf without objects", [](BoxTree& t) { t.nodes[4].object_count = 0; }},
      {"gap between children", [](BoxTree& t) { t.nodes[3].first_object = 2; }},
      {"children that overlap", [](BoxTree& t) { t.nodes[3].first_object = 0; }},
      {"children with too few objects", [](BoxTree& t) { t.nodes[1].object_count = 1; }},
      {"children with too many objects", [](BoxTree& t) { t.nodes[1].object_count = 3; }},
      {"counts that overflow", [](BoxTree& t) { t.nodes[1].object_count = 0xffffffffu; }},
      {"last child with too few", [](BoxTree& t) { t.nodes.pop_back(), t.nodes[0].end = 4; }},
      {"object twice", [](BoxTree& t) { t.objects[1] = t.objects[0]; }},
      {"object that is not there", [](BoxTree& t) { t.objects[1] = ObjectId(3u); }},
      {"object without number", [](BoxTree& t) { t.objects[1] = ObjectId(); }},
      {"box beyond its parent's", [](BoxTree& t) { t.nodes[2].bounds.max.y = 1.5f; }},
      {"empty box", [](BoxTree& t) { t.nodes[2].bounds = {}; }},
      {"empty root box", [](BoxTree& t) { t.nodes[0].bounds = {}; }},
      {"box that is not a number", [](BoxTree& t) { t.nodes[2].bounds.min.z = kFloatNan; }},
      {"root box that is not a number", [](BoxTree& t) { t.nodes[0].bounds.max.x = kFloatNan; }}};
  for (const auto& [what, apply] : damages) {
    BoxTree tree = smallTree();
    apply(tree);
    EXPECT_FALSE(checkBoxTree(tree.view())) << what;
  }
}

// A chain as deep as it is long must not need recursion.
TEST(BoxTreeCheck, TakesAVeryDeepTree) {
  constexpr std::uint32_t kDepth = 300'000;
  BoxTree tree;
  tree.objects = {ObjectId(0u)};
  tree.nodes.assign(kDepth, {{{0, 0, 0}, {1, 1, 1}}, kDepth, 0, 1, 1});
  EXPECT_TRUE(checkBoxTree(tree.view()));
}

TEST(OctreeCheck, TakesSoundOctrees) {
  const Status small = checkOctree(smallOctree().view(), 4);
  EXPECT_TRUE(small) << small.error().message;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    made::Random random(seed);
    const made::Visibility settings{.leaves = 1 + seed * 20, .depth = seed % 7};
    EXPECT_TRUE(checkOctree(made::octree(settings, random).view(), settings.sets)) << "seed " << seed;
  }
}

TEST(OctreeCheck, RefusesEveryDamage) {
  using Octree = VisibilityOctree;
  const double infinity = std::numeric_limits<double>::infinity();
  const double most = std::numeric_limits<double>::max();
  const std::vector<Damage<Octree>> damages{
      {"nothing", [](Octree& o) { o = {}; }},
      {"node that is its own child", [](Octree& o) { o.nodes[0] = 0; }},
      {"child before its parent", [](Octree& o) { o.nodes[9] = 1; }},
      {"children shared by two", [](Octree& o) { o.nodes[4] = 9; }},
      {"children that overlap", [](Octree& o) { o.nodes[3] = 8; }},
      {"children beyond the end", [](Octree& o) { o.nodes[3] = 10; }},
      {"children far beyond the end", [](Octree& o) { o.nodes[3] = 0x7fffffffu; }},
      {"nodes without parent", [](Octree& o) { o.nodes[3] = o.nodes[9]; }},
      {"node without parent at the end", [](Octree& o) { o.nodes.push_back(kOctreeLeaf); }},
      {"leaf that is not there", [](Octree& o) { o.nodes[5] = kOctreeLeaf | 15; }},
      {"leaf far away", [](Octree& o) { o.nodes[5] = 0xffffffffu; }},
      {"leaf in two nodes", [](Octree& o) { o.nodes[5] = o.nodes[4]; }},
      {"leaf in no node",
       [](Octree& o) { o.leaves.emplace_back(), o.depths.push_back(1), o.reasons.push_back(0); }},
      {"wrong depth", [](Octree& o) { o.depths[0] = 2; }},
      {"missing depth", [](Octree& o) { o.depths.pop_back(); }},
      {"missing reason", [](Octree& o) { o.reasons.pop_back(); }},
      {"unknown reason", [](Octree& o) { o.reasons[3] = kStopReasons; }},
      {"set that is not there", [](Octree& o) { o.leaves[2].set = 4; }},
      {"front set that is not there", [](Octree& o) { o.leaves[5].front_set = 4; }},
      {"back set that is not there", [](Octree& o) { o.leaves[5].back_set = 0xffffffffu; }},
      {"plane that is not there", [](Octree& o) { o.leaves[5].plane = 1; }},
      {"plane without direction", [](Octree& o) { o.planes[0].normal = {}; }},
      {"plane's normal is no number", [&](Octree& o) { o.planes[0].normal.x = -infinity + infinity; }},
      {"plane's front is infinite", [&](Octree& o) { o.planes[0].front = infinity; }},
      {"plane's back is infinite", [&](Octree& o) { o.planes[0].back = -infinity; }},
      {"plane's front behind its back", [](Octree& o) { o.planes[0].front = 0.25; }},
      {"viewers of too few cells", [](Octree& o) { o.viewers.resize(o.leaves.size() - 1); }},
      {"viewers of too many cells", [](Octree& o) { o.viewers.resize(o.leaves.size() + 1); }},
      {"viewers that end before they begin",
       [](Octree& o) {
         o.viewers.resize(o.leaves.size());
         o.viewers[3].first[1] = 9, o.viewers[3].last[1] = 8;
       }},
      {"flat box", [](Octree& o) { o.max.x = o.min.x; }},
      {"box turned round", [](Octree& o) { std::swap(o.min.z, o.max.z); }},
      {"infinite box", [&](Octree& o) { o.max.y = infinity; }},
      {"box that is no number", [&](Octree& o) { o.min.y = infinity - infinity; }},
      {"box of infinite extent", [&](Octree& o) { o.min.y = -most, o.max.y = most; }}};
  for (const auto& [what, apply] : damages) {
    Octree octree = smallOctree();
    apply(octree);
    EXPECT_FALSE(checkOctree(octree.view(), 4)) << what;
  }
}

// One cell in eight is divided, down to a depth.
VisibilityOctree chain(std::uint32_t depth) {
  VisibilityOctree octree;
  octree.max = {1, 1, 1};
  octree.nodes = {kOctreeLeaf};
  for (std::uint32_t i = 0; i < depth; ++i) {
    octree.nodes[octree.nodes.size() - (i == 0 ? 1 : 8)] = static_cast<std::uint32_t>(octree.nodes.size());
    octree.nodes.resize(octree.nodes.size() + 8, kOctreeLeaf);
  }
  made::numberLeaves(octree, 0, 0);
  return octree;
}

TEST(OctreeCheck, RefusesCellsThatAreTooDeep) {
  EXPECT_TRUE(checkOctree(chain(kMaxOctreeDepth).view(), 1));
  EXPECT_FALSE(checkOctree(chain(kMaxOctreeDepth + 1).view(), 1));
}

}  // namespace
}  // namespace sightline::pvs
