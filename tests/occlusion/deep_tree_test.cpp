// Builds and queries trees of the maximum depth on a thread with a small stack.

#include <gtest/gtest.h>
#include <pthread.h>

#include <functional>
#include <iterator>
#include <span>
#include <utility>

#include "sightline/occlusion/occlusion_tree.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace test;

constexpr std::uint32_t kDepthLimit = 1500;  // as OcclusionTreeStats::depth promises

void onASmallStack(std::function<void()> work) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, 256 * 1024), 0);
  pthread_t thread;
  const auto run = [](void* argument) -> void* {
    (*static_cast<std::function<void()>*>(argument))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, run, &work), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
}

// A fence: boards side by side with gaps between them. Each is beyond an edge of every board before it.
std::vector<OraclePolygon> fence(int boards) {
  std::vector<OraclePolygon> all;
  for (int i = 0; i < boards; ++i) {
    const auto x = static_cast<float>(i - boards / 2) * 0.01f;
    all.push_back(wall(x, x + 0.008f, -4, 4, -5));
  }
  return all;
}

View viewOf(bool orthographic) {
  View view = kLookingBack;
  view.tan_half_fovy = 4.0;
  view.orthographic = orthographic;
  view.ortho_height = 40.0;
  return view;
}

TEST(DeepTree, IsBuiltAndAskedOnASmallStack) {
  const OccluderSet set = setOf(fence(740));
  for (const bool orthographic : {false, true}) {
    for (const auto variant : kTreeVariants) {
      onASmallStack([&] {
        OcclusionTree tree({.variant = variant});
        const View view = viewOf(orthographic);
        tree.build(view, set, all(set));
        EXPECT_EQ(tree.stats().dropped, 0u);
        EXPECT_GT(tree.stats().depth, 700u);
        EXPECT_LE(tree.stats().depth, kDepthLimit);
        EXPECT_EQ(tree.classify({{-3, -1, -12}, {3, 1, -10}}), Visibility::kPartial);
        EXPECT_EQ(tree.classify({{-3, -1, -4}, {3, 1, -3}}), Visibility::kVisible);
        for (int board = 0; board < 740; board += 37) {
          const float x = static_cast<float>(board - 370) * 0.01f;
          const float s = orthographic ? 1.0f : 1.2f;
          EXPECT_EQ(tree.classify({{s * (x + 0.003f), -1, -6}, {s * (x + 0.005f), 1, -6}}),
                    Visibility::kHidden)
              << "behind board " << board;
          EXPECT_EQ(tree.classify({{s * (x + 0.0085f), -1, -6}, {s * (x + 0.0095f), 1, -6}}),
                    Visibility::kVisible)
              << "in the gap beside board " << board;
        }
      });
    }
  }
}

// Each variant here has a twin that builds the same tree and asks it in another way. The boards are so many
// that each tree would be a little deeper than the limit, which does not depend on the projection.
TEST(DeepTree, IsNeverDeeperThanItsLimit) {
  struct Deep {
    OcclusionTreeVariant variant;
    int boards;
    bool orthographic;
  };
  constexpr Deep kDeep[] = {{OcclusionTreeVariant::kFSE, 1350, false},
                            {OcclusionTreeVariant::kFME, 1520, true}};
  for (const Deep& deep : std::span(kDeep).first(rounds(std::size(kDeep)))) {
    const OccluderSet set = setOf(fence(deep.boards));
    onASmallStack([&] {
      OcclusionTree tree({.variant = deep.variant, .max_nodes = 1 << 20});
      tree.build(viewOf(deep.orthographic), set, all(set));
      EXPECT_GT(tree.stats().dropped, 0u);
      EXPECT_GT(tree.stats().occluders, 0u);
      EXPECT_LE(tree.stats().depth, kDepthLimit);
      EXPECT_EQ(tree.classify({{-3, -1, -4}, {3, 1, -3}}), Visibility::kVisible);
      EXPECT_NE(tree.classify({{-3, -1, -12}, {3, 1, -10}}), Visibility::kHidden);
    });
  }
}

}  // namespace
}  // namespace sightline
