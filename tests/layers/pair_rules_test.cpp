#include "src/layers/pairs/pair_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

PairPlane planeAt(double offset) {
  return {{{0, 1, 0}, offset}};
}

TEST(PairRules, AreFoundInBothOrdersAndKeepWhoIsFirst) {
  PairRules rules;
  EXPECT_EQ(rules.find(0, 1), PairRules::kNone);
  rules.set(7, 2, planeAt(3));
  const std::uint32_t number = rules.find(2, 7);
  ASSERT_NE(number, PairRules::kNone);
  EXPECT_EQ(rules.find(7, 2), number);
  EXPECT_EQ(rules.rule(number).first, 7u);
  EXPECT_EQ(rules.rule(number).second, 2u);
  EXPECT_EQ(rules.find(7, 3), PairRules::kNone);
  EXPECT_EQ(rules.find(1000, 2), PairRules::kNone);
}

TEST(PairRules, TheLastOneHoldsForBothOrders) {
  PairRules rules;
  rules.set(1, 2, planeAt(3));
  rules.set(2, 1, SphereCylinderJoint{});
  const PairRule& rule = rules.rule(rules.find(1, 2));
  EXPECT_EQ(rule.first, 2u);
  EXPECT_TRUE(std::holds_alternative<SphereCylinderJoint>(rule.what));
  rules.clear(1, 2);
  EXPECT_EQ(rules.find(1, 2), PairRules::kNone);
  rules.clear(1, 2);
  rules.set(1, 2, planeAt(4));
  EXPECT_NE(rules.find(2, 1), PairRules::kNone);
}

TEST(PairRules, OfAPartWithItselfAreLeftOut) {
  PairRules rules;
  rules.set(1, 1, planeAt(3));
  rules.setContainer(2, 2);
  EXPECT_EQ(rules.find(1, 1), PairRules::kNone);
  EXPECT_EQ(rules.containerOf(2).other, PairRules::kNone);
}

TEST(PairRules, ACopyHasThoseWithOtherPartsButNoContainer) {
  PairRules rules;
  rules.set(1, 2, planeAt(3));
  rules.set(4, 1, planeAt(5));
  rules.set(1, 5, planeAt(6));
  rules.clear(1, 5);
  rules.setContainer(1, 6);
  rules.set(2, 4, planeAt(7));
  rules.copy(1, 9);
  ASSERT_NE(rules.find(9, 2), PairRules::kNone);
  const PairRule& first = rules.rule(rules.find(9, 2));
  EXPECT_EQ(first.first, 9u);
  EXPECT_EQ(std::get<PairPlane>(first.what).plane.offset, 3.0);
  ASSERT_NE(rules.find(9, 4), PairRules::kNone);
  EXPECT_EQ(rules.rule(rules.find(9, 4)).second, 9u);
  for (const std::uint32_t other : {1u, 5u, 6u}) {
    EXPECT_EQ(rules.find(9, other), PairRules::kNone) << other;
  }
  EXPECT_EQ(rules.rule(rules.find(1, 2)).first, 1u);
  rules.copy(9, 9);
  EXPECT_EQ(rules.find(9, 9), PairRules::kNone);
}

TEST(PairRules, ContainersAreKnownByBothParts) {
  PairRules rules;
  rules.setContainer(4, 1);
  EXPECT_EQ(rules.containerOf(4).other, 1u);
  EXPECT_TRUE(rules.containerOf(4).is_front);
  EXPECT_EQ(rules.containerOf(1).other, 4u);
  EXPECT_FALSE(rules.containerOf(1).is_front);
  EXPECT_EQ(rules.containerOf(2).other, PairRules::kNone);
  EXPECT_EQ(rules.containerOf(99).other, PairRules::kNone);
  EXPECT_TRUE(std::holds_alternative<ContainerRule>(rules.rule(rules.find(1, 4)).what));
}

TEST(PairRules, AnotherRuleForItsPartsEndsAContainer) {
  PairRules rules;
  rules.setContainer(4, 1);
  rules.set(1, 4, planeAt(0));
  EXPECT_EQ(rules.containerOf(4).other, PairRules::kNone);
  EXPECT_EQ(rules.containerOf(1).other, PairRules::kNone);
  rules.setContainer(4, 1);
  rules.clear(1, 4);
  EXPECT_EQ(rules.containerOf(4).other, PairRules::kNone);
}

TEST(PairRules, APartIsOfTheLastContainerOnly) {
  PairRules rules;
  rules.setContainer(0, 1);
  rules.setContainer(2, 3);
  rules.setContainer(1, 2);
  EXPECT_EQ(rules.containerOf(0).other, PairRules::kNone);
  EXPECT_EQ(rules.containerOf(3).other, PairRules::kNone);
  EXPECT_EQ(rules.containerOf(1).other, 2u);
  EXPECT_TRUE(rules.containerOf(1).is_front);
  EXPECT_EQ(rules.find(0, 1), PairRules::kNone);
  EXPECT_EQ(rules.find(2, 3), PairRules::kNone);
  rules.setContainer(2, 1);
  EXPECT_TRUE(rules.containerOf(2).is_front);
  EXPECT_FALSE(rules.containerOf(1).is_front);
}

TEST(PairRules, BehaveAsAMapUnderRandomUse) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    shapes::Random random(seed);
    PairRules rules;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::uint32_t, double>> model;
    for (int step = 0; step < 3000; ++step) {
      const std::uint32_t a = random.below(20u), b = random.below(20u);
      const auto key = std::minmax(a, b);
      if (random.below(3u) == 0) {
        rules.clear(a, b);
        model.erase(key);
      } else if (a != b) {
        rules.set(a, b, planeAt(step));
        model[key] = {a, step};
      }
      const std::uint32_t c = random.below(25u), d = random.below(25u);
      const std::uint32_t number = rules.find(c, d);
      const auto expected = model.find(std::minmax(c, d));
      ASSERT_EQ(number != PairRules::kNone, expected != model.end());
      if (expected != model.end()) {
        ASSERT_EQ(rules.rule(number).first, expected->second.first);
        ASSERT_EQ(std::get<PairPlane>(rules.rule(number).what).plane.offset, expected->second.second);
      }
    }
    EXPECT_LE(rules.numbers(), 190u);  // at most one per pair, however often a rule is set
  }
}

}  // namespace
}  // namespace sightline::layers
