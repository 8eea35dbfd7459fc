#include "src/comparison/occluders/set_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/comparison/picture_scenes.h"

namespace sightline::comparison {
namespace {

using namespace picture_scenes;
using Members = std::vector<std::uint32_t>;

std::set<std::uint32_t> asSet(std::span<const std::uint32_t> numbers) {
  return {numbers.begin(), numbers.end()};
}

std::set<std::uint32_t> hiddenBy(const SetPool& pool, const Members& members) {
  for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
    if (std::ranges::equal(pool.members(s), members)) {
      return asSet(pool.occludees(s));
    }
  }
  ADD_FAILURE() << "no such set";
  return {};
}

TEST(SetPool, GroupsEqualSetsAndCountsAnOccludeeOnce) {
  SetPool pool;
  pool.add(Members{1, 4}, 7);
  pool.add(Members{2}, 7);
  pool.add(Members{1, 4}, 3);
  pool.add(Members{1, 4}, 7);
  pool.finish(5, 8);
  ASSERT_EQ(pool.setCount(), 2u);
  EXPECT_EQ(hiddenBy(pool, {1, 4}), (std::set<std::uint32_t>{3, 7}));
  EXPECT_EQ(hiddenBy(pool, {2}), (std::set<std::uint32_t>{7}));
  EXPECT_EQ(pool.gain(0), 2u);
}

TEST(SetPool, ASupersetInheritsTheGainOfItsSubsets) {
  SetPool pool;
  pool.add(Members{0}, 0);
  pool.add(Members{0, 2}, 1);
  pool.add(Members{0, 1, 2}, 2);
  pool.add(Members{1, 2}, 0);  // as {0} does: counts once for {0, 1, 2}
  pool.add(Members{2, 3}, 3);
  pool.finish(4, 4);
  EXPECT_EQ(hiddenBy(pool, {0}), (std::set<std::uint32_t>{0}));
  EXPECT_EQ(hiddenBy(pool, {0, 2}), (std::set<std::uint32_t>{0, 1}));
  EXPECT_EQ(hiddenBy(pool, {0, 1, 2}), (std::set<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(hiddenBy(pool, {1, 2}), (std::set<std::uint32_t>{0}));
  EXPECT_EQ(hiddenBy(pool, {2, 3}), (std::set<std::uint32_t>{3}));
}

TEST(SetPool, InheritsWhatTryingAllPairsFinds) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<std::pair<Members, std::uint32_t>> added;
    SetPool pool;
    for (std::uint32_t i = 0; i < 60; ++i) {
      std::set<std::uint32_t> members;
      for (std::uint32_t m = 0; m < 1 + random.below(4); ++m) {
        members.insert(random.below(9));
      }
      added.push_back({Members(members.begin(), members.end()), random.below(20)});
      pool.add(added.back().first, added.back().second);
    }
    pool.finish(9, 20);
    std::set<Members> different;
    for (const auto& [members, occludee] : added) {
      different.insert(members);
      std::set<std::uint32_t> expected;
      for (const auto& [other, hidden] : added) {
        if (std::includes(members.begin(), members.end(), other.begin(), other.end())) {
          expected.insert(hidden);
        }
      }
      ASSERT_EQ(hiddenBy(pool, members), expected);
    }
    EXPECT_EQ(pool.setCount(), different.size());
  }
}

constexpr PictureShape kSeenShape{64, 90.0, 0.1};

// A picture with all occluders of a model, seen from the origin along -z.
struct Seen {
  Model model;
  OccluderPicture picture;
  std::vector<Occludee> occludees;

  explicit Seen(Model m) : model(std::move(m)) {
    model.finish();
    std::vector<NearOccluder> candidates;
    OccluderFilter(model.set).find({0, 0, 0}, 0.0, candidates);
    picture.draw(model.set, candidates, {0, 0, 0}, {0, 0, -1}, kSeenShape, 0.0);
    occludeesInPicture(model.hierarchy, findOccludees(model.hierarchy, 0, 1), picture.view(),
                       kSeenShape.resolution, occludees);
  }
  // The occluder whose middle is there: its number in the picture.
  std::uint32_t at(double x, double z) const {
    for (std::uint32_t o = 0; o < picture.occluders().size(); ++o) {
      const Vec3f& c = model.set[picture.occluders()[o].id].centroid;
      if (std::abs(c.x - x) < 1e-3 && std::abs(c.z - z) < 1e-3) {
        return o;
      }
    }
    ADD_FAILURE() << "no occluder at " << x << ", " << z;
    return 0;
  }
  // The occludee whose middle is there.
  std::uint32_t boxAt(double x, double z) const {
    for (std::uint32_t o = 0; o < occludees.size(); ++o) {
      const Vec3d c = center(model.hierarchy.nodes[occludees[o].node.value].bounds);
      if (std::abs(c.x - x) < 1e-3 && std::abs(c.z - z) < 1e-3) {
        return o;
      }
    }
    ADD_FAILURE() << "no box at " << x << ", " << z;
    return 0;
  }
  SetPool poolOf(const std::vector<std::pair<Members, std::uint32_t>>& sets) const {
    SetPool pool;
    for (const auto& [members, occludee] : sets) {
      Members ascending = members;
      std::sort(ascending.begin(), ascending.end());
      pool.add(ascending, occludee);
    }
    pool.finish(static_cast<std::uint32_t>(picture.occluders().size()),
                static_cast<std::uint32_t>(occludees.size()));
    return pool;
  }
  std::set<std::uint32_t> hiddenBy(std::span<const std::uint32_t> occluders) const {
    IdBuffer buffer;
    buffer.clear(picture);
    for (const std::uint32_t occluder : occluders) {
      buffer.draw(picture, occluder);
    }
    std::set<std::uint32_t> hidden;
    for (std::uint32_t o = 0; o < occludees.size(); ++o) {
      std::uint32_t pixel = occludees[o].rect.low * kSeenShape.resolution + occludees[o].rect.left;
      if (hides(buffer, kSeenShape.resolution, occludees[o], pixel)) {
        hidden.insert(o);
      }
    }
    return hidden;
  }
};

Members select(const Seen& seen, const SetPool& pool, std::uint32_t limit,
               const MinimumSetWeights& weights = {}) {
  SetSelection selection;
  const auto list = selection.select(seen.picture, pool, seen.occludees, weights, limit);
  return {list.begin(), list.end()};
}

// One wall before four boxes; behind it a pair of walls before one more box on the right.
Seen wallAndPair() {
  Model model;
  model.addRectangle(-9.0, 3.0, -5.0, 5.0, -10.0);
  model.addRectangle(4.0, 6.5, -5.0, 5.0, -11.0);
  model.addRectangle(6.2, 9.0, -5.0, 5.0, -12.0);
  for (const float x : {-8.0f, -6.0f, -4.0f, -2.0f}) {
    model.addBox({x, -1, -21}, {x + 1, 1, -20});
  }
  model.addBox({10.5f, -1, -21}, {12.5f, 1, -20});
  return Seen(std::move(model));
}

TEST(SetSelection, TakesTheSetWithTheLargestGainForItsCostFirst) {
  const Seen seen = wallAndPair();
  const std::uint32_t wall = seen.at(-3.0, -10), left = seen.at(5.25, -11), right = seen.at(7.6, -12);
  std::vector<std::pair<Members, std::uint32_t>> sets = {{{left, right}, seen.boxAt(11.5, -20.5)}};
  for (const double x : {-7.5, -5.5, -3.5, -1.5}) {
    sets.push_back({{wall}, seen.boxAt(x, -20.5)});
  }
  const SetPool pool = seen.poolOf(sets);
  const Members list = select(seen, pool, 10);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0], wall);
  EXPECT_EQ(asSet(list), (std::set<std::uint32_t>{wall, left, right}));
  EXPECT_EQ(select(seen, pool, 1), Members{wall});
  EXPECT_TRUE(select(seen, pool, 0).empty());
}

TEST(SetSelection, WhatIsHiddenAlreadyIsNoGain) {
  // Beside the first wall, which hides four boxes, the second hides one box more, the third two.
  Model model;
  model.addRectangle(-9.0, -1.0, -5.0, 5.0, -10.0);
  model.addRectangle(-6.6, 3.0, -5.0, 5.0, -12.0);
  model.addRectangle(3.0, 9.5, -5.0, 5.0, -10.0);
  for (const float x : {-17.0f, -13.0f, -9.0f, -5.0f, 0.5f, 8.0f, 14.0f}) {
    model.addBox({x, -1, -21}, {x + 1, 1, -20});
  }
  const Seen seen(std::move(model));
  const std::uint32_t first = seen.at(-5.0, -10), second = seen.at(-1.8, -12), third = seen.at(6.25, -10);
  std::vector<std::pair<Members, std::uint32_t>> sets;
  const auto hides = [&](std::uint32_t wall, std::initializer_list<double> middles) {
    for (const double x : middles) {
      sets.push_back({{wall}, seen.boxAt(x, -20.5)});
    }
  };
  hides(first, {-16.5, -12.5, -8.5, -4.5});
  hides(second, {-8.5, -4.5, 1.0});
  hides(third, {8.5, 14.5});
  EXPECT_EQ(select(seen, seen.poolOf(sets), 2), (Members{first, third}));
}

TEST(SetSelection, FollowsTheUsersPreference) {
  // A large wall that hides two boxes, or two small ones that hide one of them.
  Model model;
  model.addRectangle(-9.0, 9.0, -9.0, 9.0, -10.0);
  model.addRectangle(-1.2, 0.1, -1.0, 1.0, -5.0);
  model.addRectangle(-0.1, 1.2, -1.0, 1.0, -5.5);
  model.addBox({-2, -1, -21}, {2, 1, -20});
  model.addBox({4, -1, -21}, {6, 1, -20});
  const Seen seen(std::move(model));
  const std::uint32_t wall = seen.at(0.0, -10), left = seen.at(-0.55, -5), right = seen.at(0.55, -5.5);
  const SetPool pool = seen.poolOf({{{wall}, seen.boxAt(0, -20.5)},
                                    {{wall}, seen.boxAt(5, -20.5)},
                                    {{left, right}, seen.boxAt(0, -20.5)}});
  // The wall fills 0.81 of the picture, the others about 0.11 of it.
  EXPECT_EQ(select(seen, pool, 1, {1.0, 1.0, 0.0}), Members{wall});
  EXPECT_NE(select(seen, pool, 1, {1.0, 0.0, 1.0}), Members{wall});
  EXPECT_EQ(select(seen, pool, 1, {5.0, 0.0, 1.0}), Members{wall});
}

TEST(SetSelection, DropsASetThatABetterOneHides) {
  Model model;
  model.addRectangle(-5.0, 5.0, -5.0, 5.0, -8.0);
  model.addRectangle(-4.0, 4.0, -4.0, 4.0, -10.0);  // behind it
  model.addBox({-2, -1, -21}, {-1, 1, -20});
  model.addBox({1, -1, -21}, {2, 1, -20});
  const Seen seen(std::move(model));
  const std::uint32_t before = seen.at(0, -8), behind = seen.at(0, -10);
  const SetPool pool = seen.poolOf({{{before}, seen.boxAt(-1.5, -20.5)},
                                    {{before}, seen.boxAt(1.5, -20.5)},
                                    {{behind}, seen.boxAt(1.5, -20.5)}});
  EXPECT_EQ(select(seen, pool, 10), Members{before});
}

TEST(SetSelection, GivesThePlaceOfAnOccluderThatIsHiddenToThoseThatHideIt) {
  // The one behind is taken first, for its two boxes; those before it together hide all of it.
  Model model;
  model.addRectangle(-4.0, 4.0, -4.0, 4.0, -10.0);
  model.addRectangle(-5.0, 0.5, -5.0, 5.0, -8.0);
  model.addRectangle(-0.5, 5.0, -5.0, 5.0, -7.0);
  model.addRectangle(6.5, 8.5, -5.0, 5.0, -9.0);
  model.addBox({-2, -1, -21}, {-1, 1, -20});
  model.addBox({1, -1, -21}, {2, 1, -20});
  model.addBox({-9, -1, -21}, {9, 1, -20});
  model.addBox({16, -1, -21}, {17, 1, -20});
  const Seen seen(std::move(model));
  const std::uint32_t behind = seen.at(0, -10), left = seen.at(-2.25, -8), right = seen.at(2.25, -7),
                      other = seen.at(7.5, -9);
  const std::uint32_t wide = seen.boxAt(0, -20.5);
  const SetPool pool = seen.poolOf({{{behind}, seen.boxAt(-1.5, -20.5)},
                                    {{behind}, seen.boxAt(1.5, -20.5)},
                                    {{other}, seen.boxAt(16.5, -20.5)},
                                    {{left, right}, wide}});
  const Members list = select(seen, pool, 10);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(asSet(std::span(list).first(2)), (std::set<std::uint32_t>{left, right}));
  EXPECT_EQ(list[2], other);
}

// Sets as a search makes them, of random scenes.
TEST(SetSelection, HidesAllThatItsSetsHideWithFewOccluders) {
  std::size_t occluders = 0, listed = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Seen seen(randomModel(random, 60, 80, 4.0));
    IdBuffer nearest;
    nearest.clear(seen.picture);
    std::vector<double> costs;
    for (std::uint32_t o = 0; o < seen.picture.occluders().size(); ++o) {
      nearest.draw(seen.picture, o);
      costs.push_back(costOf(seen.picture.occluders()[o], seen.picture.pixelCount(), {}));
    }
    OccluderStack stack;
    stack.build(seen.picture, nearest, seen.occludees);
    MinimumSetSearch search;
    SetPool pool;
    for (const std::uint32_t occludee : stack.hidden()) {
      CombinationTable table;
      stack.tableOf(seen.occludees[occludee], table);
      const auto sets = search.find(table, costs, {4, 4096});
      ASSERT_FALSE(sets.empty());
      for (const MinimumSet& set : sets) {
        EXPECT_TRUE(seen.hiddenBy(set.members).contains(occludee));
        for (std::size_t m = 0; m < set.members.size(); ++m) {
          Members others = set.members;
          others.erase(others.begin() + static_cast<std::ptrdiff_t>(m));
          EXPECT_FALSE(seen.hiddenBy(others).contains(occludee)) << "a redundant member";
        }
        pool.add(set.members, occludee);
      }
    }
    pool.finish(static_cast<std::uint32_t>(costs.size()), static_cast<std::uint32_t>(seen.occludees.size()));
    const Members list = select(seen, pool, 1000);
    EXPECT_EQ(asSet(list).size(), list.size()) << "an occluder twice";
    const auto hidden = seen.hiddenBy(list);
    EXPECT_EQ(hidden, asSet(stack.hidden()));
    occluders += costs.size();
    listed += list.size();
    for (const std::uint32_t limit : {1u, 3u, 8u}) {
      EXPECT_LE(select(seen, pool, limit).size(), limit);
    }
  }
  EXPECT_LT(2 * listed, occluders);
}

}  // namespace
}  // namespace sightline::comparison
