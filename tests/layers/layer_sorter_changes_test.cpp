// Parts that come, go and change their shape, and parts outside the view.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sightline/math/frustum.h"
#include "tests/layers/made_parts.h"
#include "tests/layers/sorter_choices.h"

namespace sightline {
namespace {

using namespace made;

MadePart partAt(const Points& points, const Vec3d& centre) {
  return {.hulls = {points}, .world_from_part = translation(centre), .settings = {}, .enabled = true};
}

// Points with small whole coordinates, of which several are corners of their hull.
Points somePoints(Random& random) {
  Points points = shapes::cube();
  const int more = random.whole(0, 40);
  for (int i = 0; i < more; ++i) {
    const int x = random.whole(-3, 3), y = random.whole(-3, 3), z = random.whole(-3, 3);
    points.emplace_back(x, y, z);
  }
  return points;
}

Vec3d somePlace(Random& random) {
  const int x = random.whole(-12, 12), y = random.whole(-4, 4), z = random.whole(-12, 12);
  return Vec3d(x, y, z);
}

// A sorter that changes, beside what its parts are.
class Changing {
 public:
  Changing(const LayerSettings& settings, Random& random) : sorter_(settings), random_(random) {}

  void add() {
    const MadePart part = partAt(somePoints(random_), somePlace(random_));
    const HullId hull = sorter_.addHull(builtOf(part.hulls[0]));
    const PartId id = sorter_.addPart(std::span(&hull, 1));
    EXPECT_FALSE(parts_.contains(id.value));
    EXPECT_TRUE(sorter_.setTransform(id, part.world_from_part));
    parts_[id.value] = {part, hull};
  }
  void remove() {
    const std::uint32_t part = any();
    sorter_.removePart(PartId(part));
    parts_.erase(part);
  }
  void reshape() {
    Own& own = parts_.at(any());
    own.part.hulls[0] = somePoints(random_);
    EXPECT_TRUE(sorter_.setHull(own.hull, builtOf(own.part.hulls[0])));
  }
  void move() {
    const std::uint32_t part = any();
    parts_.at(part).part.world_from_part = translation(somePlace(random_));
    sorter_.setTransform(PartId(part), parts_.at(part).part.world_from_part);
  }

  // A sorter made of the same parts gives the same answer, up to the numbers of the parts.
  void check(const View& view, const LayerSettings& settings) {
    LayerSorter fresh(settings);
    std::vector<std::uint32_t> numbers;  // in sorter_, by number in fresh
    for (const auto& [number, own] : parts_) {
      addMade(fresh, own.part);
      numbers.push_back(number);
    }
    Answer expected(fresh.update(view));
    const auto renumber = [&](std::uint32_t& part) { part = numbers[part]; };
    std::set<Group> groups;
    for (Group group : expected.groups) {
      std::for_each(group.begin(), group.end(), renumber);
      groups.insert(group);
    }
    expected.groups = groups;
    for (std::vector<Pair>* const pairs : {&expected.arcs, &expected.collisions}) {
      for (Pair& pair : *pairs) {
        renumber(pair.first);
        renumber(pair.second);
      }
    }
    expectSame(Answer(sorter_.update(view)), expected);
  }

  std::size_t numbers() const { return sorter_.parts(); }
  std::size_t size() const { return parts_.size(); }

 private:
  struct Own {
    MadePart part;
    HullId hull;
  };
  std::uint32_t any() {
    auto it = parts_.begin();
    std::advance(it, random_.below(static_cast<std::uint32_t>(parts_.size())));
    return it->first;
  }

  LayerSorter sorter_;
  Random& random_;
  std::map<std::uint32_t, Own> parts_;
};

TEST(LayerSorterChanges, PartsThatComeGoAndChangeShapeAreSortedAsIfTheyHadAlwaysBeenSo) {
  for (const SortChoice sort : kSortChoices) {
    for (const SearchChoice search : kSearchChoices) {
      for (const bool world : {false, true}) {
        SCOPED_TRACE(std::string(nameOf(sort)) + ", " + nameOf(search) + (world ? ", world" : ", camera"));
        LayerSettings settings;
        settings.sort = sortOf(sort);
        settings.search = searchOf(search);
        settings.conditioning = false;
        if (world) {
          settings.extents = worldExtents();
        }
        Random random(world ? 5 : 6);
        Changing changing(settings, random);
        for (int i = 0; i < 12; ++i) {
          changing.add();
        }
        for (int frame = 0; frame < 60; ++frame) {
          for (int changes = random.whole(0, 4); changes > 0; --changes) {
            switch (random.below(4)) {
              case 0:
                changing.add();
                break;
              case 1:
                if (changing.size() > 3) {
                  changing.remove();
                }
                break;
              case 2:
                changing.reshape();
                break;
              default:
                changing.move();
            }
          }
          changing.check(viewFrom({0.25, 0.5, 20.0 - 0.125 * frame}), settings);
        }
      }
    }
  }
}

TEST(LayerSorterChanges, NumbersOfRemovedPartsAreUsedAgain) {
  Random random(7);
  Changing changing({}, random);
  for (int i = 0; i < 10; ++i) {
    changing.add();
  }
  for (int i = 0; i < 30; ++i) {
    changing.remove();
    changing.add();
  }
  EXPECT_EQ(changing.numbers(), 10u);
}

TEST(LayerSorterChanges, ARemovedPartTakesItsRulesAlongAndCallsWithItDoNothing) {
  LayerSettings settings;
  settings.arcs = LayerArcs::kAll;
  LayerSorter sorter(settings);
  const PartId front = addMade(sorter, partAt(shapes::cube(), {0, 0, 4}));
  const PartId back = addMade(sorter, partAt(shapes::cube(), {0, 0, 0}));
  const View view = viewFrom({0, 0, 9});
  const auto inOrder = [&] { return Answer(sorter.update(view)).in_order; };
  // The rule denies what the hulls show.
  const PairCallback rule{[](void*, const View&) { return PairOrder{false, true}; }};
  sorter.setRule(front, back, rule);
  EXPECT_TRUE(Answer(sorter.update(view)).arcs.empty());
  sorter.removePart(front);
  sorter.removePart(front);
  EXPECT_EQ(sorter.parts(), 2u);
  EXPECT_FALSE(sorter.setTransform(front, translation({0, 0, 1})));
  sorter.setEnabled(front, true);
  sorter.setRule(front, back, rule);
  sorter.removePart(PartId(77u));
  EXPECT_EQ(inOrder(), (std::vector<Group>{{1}}));
  EXPECT_EQ(addMade(sorter, partAt(shapes::cube(), {0, 0, 4})), front);
  EXPECT_EQ(Answer(sorter.update(view)).arcs, (std::vector<Pair>{{0, 1}}));
}

TEST(LayerSorterChanges, APartOfAnotherNumberOfHullsGetsANumberOfItsOwn) {
  LayerSorter sorter;
  const PartId one = addMade(sorter, partAt(shapes::cube(), {0, 0, 4}));
  addMade(sorter, partAt(shapes::cube(), {}));
  sorter.removePart(one);
  MadePart two = partAt(shapes::cube(), {0, 0, -4});
  two.hulls.push_back(shapes::cube({3, 0, 0}));
  EXPECT_EQ(addMade(sorter, two), PartId(2u));
  EXPECT_EQ(addMade(sorter, partAt(shapes::cube(), {0, 0, 8})), one);
}

TEST(LayerSorterChanges, AStaticPartKeepsItsShapeOnceSorted) {
  LayerSorter sorter;
  const HullId hull = sorter.addHull(buildHull(shapes::cube()).value());
  const PartId part = sorter.addPart(std::span(&hull, 1), {.is_static = true});
  EXPECT_TRUE(sorter.setHull(hull, buildHull(shapes::cube({1, 0, 0})).value()));
  sorter.update(viewFrom({0, 0, 9}));
  EXPECT_FALSE(sorter.setHull(hull, buildHull(shapes::cube()).value()));
  sorter.removePart(part);
  EXPECT_TRUE(sorter.setHull(hull, buildHull(shapes::cube()).value()));
}

TEST(LayerSorterChanges, WithFrustumCullingOnlyPartsOutsideTheViewAreLeftOut) {
  Random random(8);
  int left_out = 0, sorted = 0;
  for (int round = 0; round < 60; ++round) {
    MadeScene scene;
    for (int i = 0; i < 20; ++i) {
      scene.parts.push_back(partAt(somePoints(random), somePlace(random)));
    }
    scene.view = viewFrom(somePlace(random) + Vec3d{0.25, 0.5, 0.125});
    scene.view.orthographic = round % 3 == 2;
    scene.view.ortho_height = 6.0;
    LayerSettings settings;
    settings.frustum_culling = true;
    LayerSorter culling = sorterOf(scene, settings), all = sorterOf(scene, {});
    const LayerOrder& order = culling.update(scene.view);
    std::vector<bool> in_order(scene.parts.size(), false);
    for (const PartId part : order.parts) {
      in_order[part.value] = true;
    }
    const Frustum frustum = frustumOf(scene.view);
    for (std::uint32_t part = 0; part < scene.parts.size(); ++part) {
      const Points points = placed(scene.parts[part])[0];
      // How far the part reaches inside of the plane that it lies the farthest beyond.
      double beyond = -1e9;
      for (const Plane& plane : frustum.planes) {
        double inside = -1e9;
        for (const Vec3d& point : points) {
          inside = std::max(inside, plane.evaluate(point));
        }
        beyond = std::max(beyond, -inside);
      }
      EXPECT_TRUE(in_order[part] || beyond > 0.0) << "round " << round << ", part " << part;
      // Envelopes are wider than hulls, by less than the hull's size.
      EXPECT_TRUE(!in_order[part] || beyond < 4.0) << "round " << round << ", part " << part;
      (in_order[part] ? sorted : left_out) += 1;
      all.setEnabled(PartId(part), in_order[part]);
    }
    EXPECT_EQ(order.stats.outside, scene.parts.size() - order.parts.size());
    expectSame(Answer(order), Answer(all.update(scene.view)));
  }
  EXPECT_GT(left_out, 100);
  EXPECT_GT(sorted, 100);
}

TEST(LayerSorterChanges, APartThatIsNotFiniteIsNotOutside) {
  LayerSettings settings;
  settings.frustum_culling = true;
  LayerSorter sorter(settings);
  const PartId far = addMade(sorter, partAt(shapes::cube(), {0, 0, 1000}));
  const View view = viewFrom({0, 0, 9});
  EXPECT_EQ(sorter.update(view).parts.size(), 0u);
  Mat4 nowhere = translation({0, 0, 1000});
  nowhere(0, 3) = std::numeric_limits<double>::quiet_NaN();
  sorter.setTransform(far, nowhere);
  EXPECT_EQ(sorter.update(view).parts.size(), 1u);
}

TEST(LayerSorterChanges, TheSorterTellsWhatItWasTold) {
  LayerSorter sorter({.contact_tolerance = 0.25});
  const HullId box = sorter.addHull(buildHull(shapes::cube()).value());
  const PartId part = sorter.addPart(std::span(&box, 1), {.place = PartSettings::Place::kBackdrop});
  Mat4 placed;
  placed(0, 1) = 2.0;
  placed(2, 3) = -7.0;
  sorter.setTransform(part, placed);
  EXPECT_EQ(sorter.settings().contact_tolerance, 0.25);
  EXPECT_EQ(sorter.hullsOf(part), std::vector<HullId>{box});
  EXPECT_EQ(sorter.hull(box).vertices.size(), 8u);
  EXPECT_EQ(sorter.settingsOf(part).place, PartSettings::Place::kBackdrop);
  EXPECT_EQ(sorter.transformOf(part).m, placed.m);
  EXPECT_TRUE(sorter.isEnabled(part));
  sorter.setEnabled(part, false);
  EXPECT_FALSE(sorter.isEnabled(part));
  EXPECT_FALSE(sorter.isInContainer(part));
  const PartId back = sorter.addPart(std::span(&box, 1));
  sorter.setContainer(part, back);
  EXPECT_TRUE(sorter.isInContainer(back));
  sorter.removePart(part);
  EXPECT_TRUE(sorter.hullsOf(part).empty());
  EXPECT_FALSE(sorter.isEnabled(part));
  EXPECT_EQ(sorter.transformOf(part).m, Mat4{}.m);
}

}  // namespace
}  // namespace sightline
