#include "tools/sightline/reproduce/tree_section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "tests/occlusion/small_scenes.h"
#include "tools/sightline/reproduce/bittner.h"
#include "tools/sightline/reproduce/tree_diagram.h"

namespace sightline::tool {
namespace {

using namespace test;

double areaOf(const SectionPolygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const SvgPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  return 0.5 * std::abs(twice);
}

const SectionPolygon kSquare{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

TEST(TreeSection, APolygonIsCutIntoThePartsOnBothSidesOfALine) {
  const SectionLine line{1.0, 0.0, -0.5};  // x = 0.5
  EXPECT_DOUBLE_EQ(areaOf(partBehind(kSquare, line)), 3.0);
  EXPECT_DOUBLE_EQ(areaOf(partBehind(kSquare, line.flipped())), 1.0);
  EXPECT_TRUE(partBehind(kSquare, {0.0, 0.0, 1.0}).empty()) << "all of it is in front";
  EXPECT_DOUBLE_EQ(areaOf(partBehind(kSquare, {1.0, 0.0, -1.0})), 4.0) << "touched only";
}

// Three walls, two of them partly behind the first, as tall as the view.
const std::vector<OraclePolygon> kWalls{wall(-3, 1, -50, 50, -4), wall(0, 4, -50, 50, -7),
                                        wall(-8, -6, -50, 50, -9)};

TEST(TreeSection, TheRegionsOfLeavesTileTheViewInPlan) {
  const OccluderSet set = setOf(kWalls);
  for (const bool modified : {false, true}) {
    const TreeShape tree = shapeOfTree(kLookingBack, set, all(set), modified);
    const TreeSection section = sectionOf(tree, planSection(), {{-20, -20}, {20, -20}, {20, 5}, {-20, 5}});
    double sum = 0.0;
    for (const LeafRegion& leaf : section.leaves) {
      sum += areaOf(leaf.region);
    }
    // A right angle of view: x from z to -z, up to 20 m away.
    EXPECT_NEAR(areaOf(section.view), 400.0, 1e-6);
    EXPECT_NEAR(sum, areaOf(section.view), 1e-6);
  }
}

TEST(TreeSection, WhatIsInShadowInPlanIsWhatRaysDoNotReach) {
  const OccluderSet set = setOf(kWalls);
  const TreeShape tree = shapeOfTree(kLookingBack, set, all(set), true);
  const TreeSection section = sectionOf(tree, planSection(), {{-20, -20}, {20, -20}, {20, 5}, {-20, 5}});
  const auto inside = [](const SectionPolygon& polygon, const SvgPoint& p) {
    int sign = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const SvgPoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double side = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
      if (sign * side < 0.0) {
        return false;
      }
      sign = side > 0.0 ? 1 : -1;
    }
    return !polygon.empty();
  };
  Random random(5);
  int hidden = 0, seen = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d point(random.in(-20, 20), 0.0, random.in(-20, 0));
    const RayAnswer answer = castAtAll(kWalls, kLookingBack, point);
    if (answer == RayAnswer::kUndecided || !insideView(kLookingBack, point)) {
      continue;
    }
    bool in_shadow = false;
    for (const LeafRegion& leaf : section.leaves) {
      in_shadow = in_shadow || inside(leaf.shadow, {point.x, point.z});
    }
    EXPECT_EQ(in_shadow, answer == RayAnswer::kBlocked) << point.x << " " << point.z;
    (in_shadow ? hidden : seen) += 1;
  }
  EXPECT_GT(hidden, 50);
  EXPECT_GT(seen, 50);
}

TEST(TreeDiagram, TreesWithAndWithoutRepeatedNodesHaveTheSameLetters) {
  const OccluderSet set = setOf(kWalls);
  const TreeShape standard = shapeOfTree(kLookingBack, set, all(set), false);
  const TreeShape modified = shapeOfTree(kLookingBack, set, all(set), true);
  std::vector<std::string> with = lettersOf(standard), without = lettersOf(modified);
  std::erase_if(with, [](const std::string& letter) { return letter.empty() || letter.ends_with('\''); });
  std::erase_if(without, [](const std::string& letter) { return letter.empty(); });
  std::sort(with.begin(), with.end());
  std::sort(without.begin(), without.end());
  EXPECT_EQ(with, without);
  EXPECT_EQ(without, (std::vector<std::string>{"a", "b", "c", "d"}))
      << "two edges of the first wall, one of each other";
}

TEST(TreeDiagram, HasANodeForEachNodeAndLeaf) {
  const OccluderSet set = setOf(kWalls);
  const TreeShape tree = shapeOfTree(kLookingBack, set, all(set), true);
  const std::vector<DiagramNode> nodes = diagramOf(tree, lettersOf(tree));
  std::size_t inner = 0;
  for (const DiagramNode& node : nodes) {
    inner += node.children[0] != kNoChild ? 1 : 0;
    EXPECT_EQ(node.square, node.children[0] == kNoChild);
  }
  EXPECT_EQ(inner, tree.nodes.size() - tree.frustum_nodes);
  EXPECT_EQ(nodes.size(), 2 * inner + 1);
}

TEST(BittnerFigures, Figure8ShowsABoxThatIsHiddenAndThatPlanesAloneMiss) {
  const bittner::Figure8 made = bittner::figure8();
  EXPECT_EQ(made.by_the_paper, Visibility::kPartial);
  EXPECT_EQ(made.here, Visibility::kHidden);
  std::vector<OraclePolygon> polygons;
  for (const Occluder& occluder : made.occluders.occluders) {
    const auto corners = made.occluders.verticesOf(occluder);
    polygons.push_back({{corners.begin(), corners.end()}, true});
  }
  std::mt19937_64 random(1);
  const Sight sight = lookAt(made.box, made.view, polygons, 20000, random);
  EXPECT_FALSE(sight.seen);
  EXPECT_TRUE(sight.blocked) << "so that the answer of the paper's test is the wrong one";
}

TEST(BittnerFigures, NoTextIsCutOffByThePicturesLowerBorder) {
  const std::regex height_of("viewBox=\"0 0 \\d+ (\\d+)\""), text_of("<text x=\"[^\"]*\" y=\"([^\"]*)\"");
  constexpr double kBelowBaseline = 4.0;  // of letters such as p, in the pictures' units
  for (const ReportFile& file : bittner::treeFigures().files) {
    std::smatch height;
    ASSERT_TRUE(std::regex_search(file.text, height, height_of)) << file.name;
    for (std::sregex_iterator text(file.text.begin(), file.text.end(), text_of), end; text != end; ++text) {
      EXPECT_LE(std::stod((*text)[1]) + kBelowBaseline, std::stod(height[1]))
          << file.name << ": " << text->str();
    }
  }
}

TEST(BittnerFigures, EveryPictureHasItsFile) {
  const bittner::Figures figures = bittner::treeFigures();
  ASSERT_EQ(figures.pictures.size(), 4u);
  std::vector<std::uint32_t> numbers;
  for (std::size_t i = 0; i < figures.pictures.size(); ++i) {
    EXPECT_EQ(figures.pictures[i].file, figures.files[i].name);
    EXPECT_NE(figures.files[i].text.find("<svg"), std::string::npos);
    numbers.push_back(figures.pictures[i].frame);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{1, 2, 7, 8}));
}

}  // namespace
}  // namespace sightline::tool
