#include "src/culling/wide_traversal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "src/hierarchy/wide_hierarchy.h"
#include "tests/culling/demo_frames.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline::culling {
namespace {

using demo_frames::nameOf;

struct Answer {
  std::vector<ObjectId> kept;
  CullStats stats;
};

Answer traversed(WideTraversal& traversal, const DepthPyramid& pyramid,
                 const TraversalOptions& options = {.temporal_coherence = false}) {
  Answer answer;
  traversal.run(pyramid, options, answer.stats, answer.kept);
  return answer;
}

// Returns the objects that the pyramid does not hide, tested box by box.
std::vector<ObjectId> notHidden(const DepthPyramid& pyramid, std::span<const Box> boxes) {
  std::vector<ObjectId> kept;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (pyramid.classify(boxes[i]) != Visibility::kHidden) {
      kept.push_back(ObjectId(i));
    }
  }
  return kept;
}

// The same, less what lies in boxes of the hierarchy that are hidden.
std::vector<ObjectId> notHidden(const DepthPyramid& pyramid, std::span<const Box> boxes,
                                const Hierarchy& bvh) {
  const hierarchy::WideHierarchy wide = hierarchy::collapse(bvh, boxes);
  std::vector<ObjectId> hidden;
  for (const hierarchy::WideNode& node : wide.nodes) {
    for (std::uint32_t i = 0; i < node.node_count; ++i) {
      if (pyramid.classify(wide.boxes[node.first_child + i]) == Visibility::kHidden) {
        const hierarchy::WideNode& child = wide.nodes[node.first_node + i];
        const auto objects = std::span(bvh.objects).first(child.object_end).subspan(child.first_object);
        hidden.insert(hidden.end(), objects.begin(), objects.end());
      }
    }
  }
  std::vector<ObjectId> kept = notHidden(pyramid, boxes);
  std::erase_if(kept, [&](ObjectId object) { return std::ranges::find(hidden, object) != hidden.end(); });
  return kept;
}

std::vector<ObjectId> inView(const DepthPyramid& pyramid, std::span<const Box> boxes) {
  std::vector<BoxAnswer> answers(boxes.size());
  pyramid.classifyInView(boxes, answers);
  std::vector<ObjectId> kept;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (answers[i].visibility != Visibility::kHidden) {
      kept.push_back(ObjectId(i));
    }
  }
  return kept;
}

struct Bed {
  explicit Bed(const test::Family& family, std::uint64_t seed, std::size_t count) : scene(family, seed) {
    for (std::size_t i = 0; i < count; ++i) {
      boxes.push_back(scene.randomBox());
    }
    const OccluderSet set = test::setOf(scene.polygons);
    pyramid.build(scene.view, set, test::all(set));
  }

  test::RandomScene scene;
  std::vector<Box> boxes;
  DepthPyramid pyramid{{.raster = {.width = 160, .height = 120}}};
};

TEST(WideTraversal, KeepsWhatAskingBoxByBoxKeeps) {
  std::size_t kept = 0, hidden = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
      const Bed bed(family, seed, 20 + 15 * seed);
      const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
      const std::vector<ObjectId> expected = notHidden(bed.pyramid, bed.boxes, bvh);
      WideTraversal traversal(bvh, bed.boxes);
      EXPECT_EQ(traversed(traversal, bed.pyramid).kept, expected) << family.name << ", seed " << seed;
      EXPECT_EQ(traversed(traversal, bed.pyramid).kept, expected)
          << "again: " << family.name << ", seed " << seed;
      kept += expected.size();
      hidden += inView(bed.pyramid, bed.boxes).size() - expected.size();
    }
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_GT(hidden, 100u) << "by the map";
}

TEST(WideTraversal, NothingThatARayReachesIsCulledWhateverTheHierarchy) {
  int judged = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Bed bed(family, seed, 80);
      const std::vector<ObjectId> in_view = inView(bed.pyramid, bed.boxes);
      const std::vector<ObjectId> alone = notHidden(bed.pyramid, bed.boxes);
      for (const HierarchyKind kind : demo_frames::kKinds) {
        const Hierarchy hierarchy = buildHierarchy(bed.boxes, {}, {.kind = kind});
        WideTraversal traversal(hierarchy, bed.boxes);
        const std::vector<ObjectId> kept = traversed(traversal, bed.pyramid).kept;
        EXPECT_TRUE(std::ranges::is_sorted(kept));
        EXPECT_TRUE(std::ranges::includes(alone, kept)) << family.name << ", seed " << seed;
        for (const ObjectId object : in_view) {
          if (std::ranges::binary_search(kept, object)) {
            continue;
          }
          ++judged;
          const test::Sight sight = test::lookAt(bed.boxes[object.value], bed.scene.view, bed.scene.polygons,
                                                 200, bed.scene.random.engine());
          EXPECT_FALSE(sight.seen) << nameOf(kind) << ", " << family.name << ", seed " << seed << ", object "
                                   << object.value;
        }
      }
    }
  }
  EXPECT_GT(judged, 200);
}

// The points at which boxes were seen in earlier views change no answer.
TEST(WideTraversal, KeepsInEachViewOfAWalkWhatItKeepsInThatViewAlone) {
  std::size_t kept = 0, changed = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 1; seed <= 15; ++seed) {
      Bed bed(family, seed, 300);
      const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
      WideTraversal traversal(bvh, bed.boxes);
      const OccluderSet set = test::setOf(bed.scene.polygons);
      const Vec3d step = bed.scene.random.point(0.3) * bed.scene.scale;
      std::vector<ObjectId> before;
      for (int view = 0; view < 12; ++view) {
        bed.scene.view.eye += step;
        bed.pyramid.build(bed.scene.view, set, test::all(set));
        WideTraversal alone(bvh, bed.boxes);
        const Answer expected = traversed(alone, bed.pyramid), answer = traversed(traversal, bed.pyramid);
        EXPECT_EQ(answer.kept, expected.kept) << family.name << ", seed " << seed << ", view " << view;
        EXPECT_EQ(answer.stats.objects_tested, expected.stats.objects_tested);
        EXPECT_EQ(answer.stats.nodes_tested, expected.stats.nodes_tested);
        kept += answer.kept.size();
        changed += answer.kept != before ? 1 : 0;
        before = answer.kept;
      }
    }
  }
  EXPECT_GT(kept, 10000u);
  EXPECT_GT(changed, 100u);
}

// Cuts ranges into pieces and goes through them backwards. Before each piece there is an empty range, which
// begins where another piece does or at the end.
void forPiecesBackwards(std::uint32_t count, const RangeBody& body) {
  body(count, count);
  for (std::uint32_t end = count; end > 0;) {
    const std::uint32_t begin = end > 3 ? end - 3 : 0;
    body(begin, end);
    body(begin, begin);
    end = begin;
  }
}

TEST(WideTraversal, TellsWhatTheBufferHid) {
  std::size_t culled = 0, told = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Bed bed(family, seed, 500);
      const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
      WideTraversal traversal(bvh, bed.boxes), cut(bvh, bed.boxes);
      const std::vector<ObjectId> kept = traversed(traversal, bed.pyramid).kept;
      std::vector<Box> hidden, in_pieces, some;
      traversal.appendHidden(10000, 3, hidden);
      for (const Box& box : hidden) {
        EXPECT_EQ(bed.pyramid.classify(box), Visibility::kHidden);
      }
      const auto isTold = [&](const Box& object) {
        return std::ranges::any_of(hidden, [&](const Box& box) { return contains(box, object); });
      };
      for (const ObjectId object : inView(bed.pyramid, bed.boxes)) {
        const bool kept_too = std::ranges::binary_search(kept, object);
        culled += kept_too ? 0 : 1;
        told += !kept_too && isTold(bed.boxes[object.value]) ? 1 : 0;
      }
      Answer answer;
      cut.run(bed.pyramid, {.temporal_coherence = false}, answer.stats, answer.kept, forPiecesBackwards);
      cut.appendHidden(10000, 3, in_pieces);
      EXPECT_EQ(in_pieces, hidden) << "threads change it";
      traversal.appendHidden(5, 0, some);
      EXPECT_EQ(some.size(), std::min<std::size_t>(hidden.size(), 5));
    }
  }
  EXPECT_GT(culled, 200u);
  // The traversal tells nothing of boxes that reach the near plane.
  EXPECT_GT(told, culled * 9 / 10);
}

TEST(WideTraversal, RemovesWhatIsHiddenOnceMoreIsDrawn) {
  std::size_t before = 0, after = 0, told = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Bed bed(family, seed, 700);
      const OccluderSet set = test::setOf(bed.scene.polygons);
      const std::vector<OccluderId> all = test::all(set);
      bed.pyramid.build(bed.scene.view, set, std::span(all).first(all.size() / 2));
      const HierarchyKind kind = demo_frames::kKinds[seed % std::size(demo_frames::kKinds)];
      const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = kind});
      WideTraversal traversal(bvh, bed.boxes), cut(bvh, bed.boxes);
      Answer answer = traversed(traversal, bed.pyramid), in_pieces = traversed(cut, bed.pyramid);
      std::vector<Box> hidden_at_first, hidden, hidden_in_pieces;
      traversal.appendHidden(10000, 0, hidden_at_first);
      std::vector<ObjectId> expected = answer.kept;
      const std::uint32_t asked = answer.stats.objects_tested + static_cast<std::uint32_t>(expected.size());
      before += expected.size();
      bed.pyramid.draw(set, std::span(all).subspan(all.size() / 2));
      bed.pyramid.finish();
      std::erase_if(expected, [&](ObjectId object) {
        return bed.pyramid.classify(bed.boxes[object.value]) == Visibility::kHidden;
      });
      after += expected.size();
      const TraversalOptions options{.temporal_coherence = false};
      traversal.testAgain(bed.pyramid, options, answer.stats, answer.kept);
      EXPECT_EQ(answer.kept, expected) << family.name << ", seed " << seed;
      EXPECT_EQ(answer.stats.objects_tested, asked);
      cut.testAgain(bed.pyramid, options, in_pieces.stats, in_pieces.kept, forPiecesBackwards);
      EXPECT_EQ(in_pieces.kept, expected) << "threads change it";
      traversal.appendHidden(10000, 0, hidden);
      for (const Box& box : hidden) {
        EXPECT_EQ(bed.pyramid.classify(box), Visibility::kHidden);
      }
      told += hidden.size() - hidden_at_first.size();
      cut.appendHidden(10000, 0, hidden_in_pieces);
      EXPECT_EQ(hidden_in_pieces, hidden) << "threads change it";
      WideTraversal alone(bvh, bed.boxes);
      EXPECT_EQ(traversed(traversal, bed.pyramid).kept, traversed(alone, bed.pyramid).kept);
      std::vector<Box> hidden_then, hidden_alone;
      traversal.appendHidden(10000, 0, hidden_then);
      alone.appendHidden(10000, 0, hidden_alone);
      EXPECT_EQ(hidden_then, hidden_alone) << "it is told in one view";
    }
  }
  EXPECT_GT(told, 100u);
  EXPECT_GT(after, 1000u);
  EXPECT_GT(before - after, 100u);
}

TEST(WideTraversal, WithoutObjectsARangeMayBeEmpty) {
  const Bed bed(test::kFamilies[0], 1, 0);
  const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
  WideTraversal traversal(bvh, bed.boxes);
  Answer answer;
  traversal.run(bed.pyramid, {}, answer.stats, answer.kept, forPiecesBackwards);
  traversal.testAgain(bed.pyramid, {.temporal_coherence = false}, answer.stats, answer.kept,
                      forPiecesBackwards);
  EXPECT_TRUE(answer.kept.empty());
}

TEST(WideTraversal, ThreadsChangeNoAnswerAndNoCount) {
  std::size_t kept = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    // Enough objects for more nodes than the first levels have.
    const Bed bed(test::kFamilies[0], seed, 6000);
    const Hierarchy bvh = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
    for (const bool temporal_coherence : {false, true}) {
      const TraversalOptions options{.temporal_coherence = temporal_coherence};
      WideTraversal traversal(bvh, bed.boxes), cut(bvh, bed.boxes);
      for (int view = 0; view < 3; ++view) {
        const Answer answer = traversed(traversal, bed.pyramid, options);
        Answer in_ranges;
        cut.run(bed.pyramid, options, in_ranges.stats, in_ranges.kept, forPiecesBackwards);
        EXPECT_EQ(in_ranges.kept, answer.kept) << "seed " << seed;
        EXPECT_EQ(in_ranges.stats.nodes_tested, answer.stats.nodes_tested) << "seed " << seed;
        EXPECT_EQ(in_ranges.stats.objects_tested, answer.stats.objects_tested) << "seed " << seed;
        kept += answer.kept.size();
      }
    }
  }
  EXPECT_GT(kept, 1000u);
}

// Objects that were kept are not tested again for a few views: they are kept while they are in the view.
TEST(WideTraversal, CoherenceKeepsALittleMoreForAWhile) {
  std::size_t lingering = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bed bed(test::kFamilies[0], seed, 300);
    const Hierarchy hierarchy = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
    WideTraversal traversal(hierarchy, bed.boxes);
    const OccluderSet set = test::setOf(bed.scene.polygons);
    bed.pyramid.build(bed.scene.view, set, {});
    EXPECT_EQ(traversed(traversal, bed.pyramid, {}).kept, inView(bed.pyramid, bed.boxes)) << "seed " << seed;
    bed.pyramid.build(bed.scene.view, set, test::all(set));
    const std::vector<ObjectId> expected = notHidden(bed.pyramid, bed.boxes, hierarchy);
    for (int frame = 0; frame < 60; ++frame) {
      const std::vector<ObjectId> kept = traversed(traversal, bed.pyramid, {}).kept;
      EXPECT_TRUE(std::ranges::includes(kept, expected)) << "seed " << seed;
      EXPECT_TRUE(std::ranges::includes(inView(bed.pyramid, bed.boxes), kept)) << "seed " << seed;
      lingering += frame < 2 ? kept.size() - expected.size() : 0;
    }
    EXPECT_LE(traversed(traversal, bed.pyramid, {}).kept.size(), expected.size() + 3) << "seed " << seed;
    bed.pyramid.build(bed.scene.view, set, {});
    traversed(traversal, bed.pyramid, {});
    bed.pyramid.build(bed.scene.view, set, test::all(set));
    traversal.forget();
    EXPECT_EQ(traversed(traversal, bed.pyramid, {}).kept, expected) << "seed " << seed;
  }
  EXPECT_GT(lingering, 0u);
}

// Boxes that are known by points rest as long as those that are tested.
TEST(WideTraversal, CoherentAnswersDependOnNothingThatWasForgotten) {
  std::size_t rested = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bed bed(test::kFamilies[0], seed, 600);
    const Hierarchy hierarchy = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
    WideTraversal walked(hierarchy, bed.boxes);
    const OccluderSet set = test::setOf(bed.scene.polygons);
    const Vec3d step = bed.scene.random.point(0.3) * bed.scene.scale;
    const auto walk = [&](const auto& look) {
      for (int view = 0; view < 6; ++view) {
        bed.scene.view.eye += step;
        bed.pyramid.build(bed.scene.view, set, test::all(set));
        look();
      }
    };
    walk([&] { traversed(walked, bed.pyramid, {}); });
    walked.forget();
    WideTraversal fresh(hierarchy, bed.boxes);
    walk([&] {
      const Answer answer = traversed(walked, bed.pyramid, {}), expected = traversed(fresh, bed.pyramid, {});
      EXPECT_EQ(answer.kept, expected.kept) << "seed " << seed;
      EXPECT_EQ(answer.stats.objects_tested, expected.stats.objects_tested) << "seed " << seed;
      rested += answer.kept.size() - notHidden(bed.pyramid, bed.boxes, hierarchy).size();
    });
  }
  EXPECT_GT(rested, 0u);
}

TEST(WideTraversal, OptionsKeepMoreAndNeverMoreThanTheView) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Bed bed(test::kFamilies[0], seed, 600);
    const Hierarchy hierarchy = buildHierarchy(bed.boxes, {}, {.kind = HierarchyKind::kBvh});
    WideTraversal traversal(hierarchy, bed.boxes);
    const Answer plain = traversed(traversal, bed.pyramid);
    const std::vector<ObjectId> in_view = inView(bed.pyramid, bed.boxes);
    for (const std::uint32_t cost : {0u, 20u, 100u, 100000u}) {
      for (const bool test_objects : {false, true}) {
        const Answer some =
            traversed(traversal, bed.pyramid,
                      {.min_node_cost = cost, .temporal_coherence = false, .test_objects = test_objects});
        EXPECT_TRUE(std::ranges::includes(some.kept, plain.kept)) << "seed " << seed;
        EXPECT_TRUE(std::ranges::includes(in_view, some.kept)) << "seed " << seed;
        EXPECT_LE(some.stats.nodes_tested, plain.stats.nodes_tested) << "seed " << seed;
        EXPECT_LE(some.stats.nodes_tested, some.stats.nodes_visited);
        if (!test_objects) {
          EXPECT_EQ(some.stats.objects_tested, 0u);
        }
        if (cost == 100000u) {
          EXPECT_EQ(some.stats.nodes_tested + some.stats.objects_tested, 0u);
          EXPECT_EQ(some.kept, in_view) << "seed " << seed;
        }
      }
    }
  }
}

TEST(WideTraversal, KeepsObjectsWhoseBoxesAreNotWellFormed) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  // A wall hides all boxes.
  const OccluderSet set = test::setOf(std::vector<test::OraclePolygon>{test::wall(-90, 90, -90, 90, -2)});
  DepthPyramid pyramid;
  pyramid.build(test::kLookingBack, set, test::all(set));
  std::vector<Box> boxes(200, Box{{-1, -1, -9}, {1, 1, -8}});
  boxes[3] = Box{};
  boxes[77] = {{nan, 0, -9}, {1, 1, -8}};
  boxes[150] = {{0, 0, -9}, {1, inf, -8}};
  for (const HierarchyKind kind : demo_frames::kKinds) {
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind});
    WideTraversal traversal(hierarchy, boxes);
    EXPECT_EQ(traversed(traversal, pyramid).kept, (std::vector{ObjectId(3u), ObjectId(77u), ObjectId(150u)}))
        << nameOf(kind);
  }
}

TEST(WideTraversal, OfNothingKeepsNothing) {
  const Hierarchy hierarchy = buildHierarchy({}, {});
  WideTraversal traversal(hierarchy, {});
  EXPECT_TRUE(traversed(traversal, DepthPyramid()).kept.empty());
}

// Uses occluders of the demo scene, chosen as in a culler.
TEST(WideTraversal, OfDemoScenesKeepsWhatAskingBoxByBoxKeeps) {
  std::size_t hidden = 0, asked = 0, objects = 0;
  for (const demo_frames::DemoScene* demo : {&demo_frames::smallCity(), &demo_frames::smallBuilding()}) {
    WideTraversal traversal(demo->bvh, demo->bounds);
    DepthPyramid pyramid;
    std::vector<OccluderId> occluders(demo->occluders.occluders.size());
    for (std::size_t i = 0; i < occluders.size(); ++i) {
      occluders[i] = OccluderId(i);
    }
    for (const CameraPath& path : demo->scene.paths) {
      for (std::size_t frame = 0; frame < path.frames.size(); frame += path.frames.size() / 5 + 1) {
        const View view = path.view(frame, demo->scene.origin);
        pyramid.build(view, demo->occluders, occluders);
        const Answer answer = traversed(traversal, pyramid);
        EXPECT_EQ(answer.kept, notHidden(pyramid, demo->bounds)) << path.name << " frame " << frame;
        asked += answer.stats.nodes_tested + answer.stats.objects_tested;
        objects += demo->bounds.size();
        hidden += inView(pyramid, demo->bounds).size() - answer.kept.size();
      }
    }
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_LT(asked, objects / 2);
}

}  // namespace
}  // namespace sightline::culling
