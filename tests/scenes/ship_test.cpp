#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "scenes/procedural.h"
#include "scenes/random.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

const CameraPath& pathCalled(const Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.paths.begin(), scene.paths.end(),
                                  [&](const CameraPath& path) { return path.name == name; });
  EXPECT_NE(found, scene.paths.end()) << name;
  return found == scene.paths.end() ? scene.paths.front() : *found;
}

struct Hit {
  double distance = 1e30;
  bool from_front = false;
  std::size_t object = 0;
};

// Where and from which side the ray hits the triangle; the distance is 1e30 if it does not.
Hit meet(const Scene& scene, std::size_t first_index, const Vec3d& eye, const Vec3d& direction) {
  const auto at = [&](std::size_t k) { return Vec3d(scene.positions[scene.indices[first_index + k]]); };
  const Vec3d a = at(0), e1 = at(1) - a, e2 = at(2) - a, p = cross(direction, e2);
  const double det = dot(e1, p);
  Hit hit;
  if (std::abs(det) < 1e-15) {
    return hit;
  }
  const Vec3d s = eye - a, q = cross(s, e1);
  const double u = dot(s, p) / det, v = dot(direction, q) / det, along = dot(e2, q) / det;
  if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along > 0.0) {
    hit.distance = along;
    hit.from_front = det > 0.0;
  }
  return hit;
}

bool holds(const Box& box, const Vec3d& p) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && box.min[axis] <= p[axis] && p[axis] <= box.max[axis];
  }
  return inside;
}

bool meetsBox(const Box& box, const Vec3d& eye, const Vec3d& direction) {
  double enter = 0.0, leave = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - eye[axis]) / direction[axis];
    const double b = (box.max[axis] - eye[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b) - 1e-9);
    leave = std::min(leave, std::max(a, b) + 1e-9);
  }
  return enter <= leave;
}

// Returns an empty text, or the frame and the closed object that contains the eye: there a ray leaves the
// object more often than it enters it.
std::string whatHoldsTheEye(const Scene& scene, const CameraPath& path) {
  const Vec3d direction = normalized(Vec3d(0.36, 0.48, 0.81));
  for (std::size_t f = 0; f < path.frames.size(); ++f) {
    const Vec3d eye = path.frames[f].eye - scene.origin;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      int left = 0;
      for (std::uint32_t i = 0; holds(object.bounds, eye) && i < object.index_count; i += 3) {
        const Hit hit = meet(scene, object.first_index + i, eye, direction);
        left += hit.distance < 1e30 ? (hit.from_front ? -1 : 1) : 0;
      }
      if (left != 0) {
        return path.name + " frame " + std::to_string(f) + ": " + scene.object_names[o];
      }
    }
  }
  return "";
}

// The object that the ray hits first, by trying all objects; the number of objects if there is none.
std::size_t firstObject(const Scene& scene, const Vec3d& eye, const Vec3d& direction) {
  Hit nearest;
  nearest.object = scene.objects.size();
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    if (!meetsBox(object.bounds, eye, direction)) {
      continue;
    }
    for (std::uint32_t i = 0; i < object.index_count; i += 3) {
      const Hit hit = meet(scene, object.first_index + i, eye, direction);
      if (hit.from_front && hit.distance < nearest.distance) {
        nearest = hit;
        nearest.object = o;
      }
    }
  }
  return nearest.object;
}

std::size_t objectsCalled(const Scene& scene, const std::string& part) {
  return static_cast<std::size_t>(
      std::count_if(scene.object_names.begin(), scene.object_names.end(),
                    [&](const std::string& name) { return name.find(part) != std::string::npos; }));
}

// True if a face of one box covers part of a face of the other that faces the same way.
bool shareAFace(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool cover = std::min(a.max[u], b.max[u]) - std::max(a.min[u], b.min[u]) > 1e-4f &&
                       std::min(a.max[v], b.max[v]) - std::max(a.min[v], b.min[v]) > 1e-4f;
    if (cover && (a.min[axis] == b.min[axis] || a.max[axis] == b.max[axis])) {
      return true;
    }
  }
  return false;
}

TEST(Ship, TheDefaultOneHasTheSizeThatIsPromised) {
  const Scene scene = makeShip({});
  EXPECT_GE(scene.objects.size(), 2000u);
  EXPECT_LE(scene.objects.size(), 6000u);
  EXPECT_GE(scene.triangleCount(), 80000u);
  EXPECT_LE(scene.triangleCount(), 130000u);
  const Vec3d size(sceneBounds(scene.view()).extent());
  EXPECT_NEAR(size.x, 180.0, 0.5);
  EXPECT_NEAR(size.z, 30.0, 0.5);
}

TEST(Ship, ScenesOfAllSizesAreInOrder) {
  for (const ShipOptions& options :
       {ShipOptions{}, ShipOptions{.decks = 3, .rooms = 4, .machinery = 0, .seed = 2},
        ShipOptions{.decks = 4, .rooms = 5, .machinery = 1000, .seed = 3},
        ShipOptions{.decks = 12, .rooms = 16, .machinery = 1000, .seed = 4}}) {
    const Scene scene = makeShip(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_EQ(degenerateShare(scene), 0.0) << "seed " << options.seed;
    const SolidCounts counts = countSolids(scene);
    EXPECT_EQ(counts.closed, scene.objects.size()) << "seed " << options.seed;
    EXPECT_EQ(counts.inside_out, 0u) << "seed " << options.seed;
  }
}

TEST(Ship, NamesAreUnique) {
  const Scene scene = makeShip({});
  const std::set<std::string> names(scene.object_names.begin(), scene.object_names.end());
  EXPECT_EQ(names.size(), scene.object_names.size());
}

TEST(Ship, DecksRoomsAndMachinesAreAsManyAsAskedFor) {
  const Scene scene = makeShip({.decks = 5, .rooms = 6, .machinery = 20});
  EXPECT_GT(objectsCalled(scene, "deck 4 room"), 0u);
  EXPECT_EQ(objectsCalled(scene, "deck 5 room"), 0u);
  std::set<std::string> doors, machines;
  for (const std::string& name : scene.object_names) {
    if (name.rfind("deck ", 0) == 0 && name.size() > 5 && name.substr(name.size() - 5) == " door") {
      doors.insert(name);
    }
    if (name.rfind("machine ", 0) == 0) {
      machines.insert(name.substr(0, name.find(' ', 8)));
    }
  }
  EXPECT_EQ(doors.size(), 5u * 2 * 6);
  EXPECT_EQ(machines.size(), 20u);
}

TEST(Ship, WallsSlabsAndDoorsAreBoxes) {
  const Scene scene = makeShip({.seed = 6});
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.object_names[i];
    if (name.find(" wall") == std::string::npos && name.find(" slab ") == std::string::npos &&
        name.find(" door") == std::string::npos) {
      continue;
    }
    ++count;
    const Vec3d size(scene.objects[i].bounds.extent());
    const double volume = size.x * size.y * size.z;
    EXPECT_EQ(scene.objects[i].triangleCount(), 12u) << name;
    EXPECT_NEAR(volumeOf(scene, scene.objects[i]), volume, 1e-3 * volume) << name;
  }
  EXPECT_GT(count, 500u);
}

// Overlapping faces of two boxes in one plane that face the same way would flicker.
TEST(Ship, NoFacesOfBoxesLieOnEachOther) {
  for (const std::uint32_t seed : {1u, 2u}) {
    const Scene scene = makeShip({.seed = seed});
    std::vector<std::size_t> boxes;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Vec3d size(scene.objects[i].bounds.extent());
      const double volume = size.x * size.y * size.z;
      if (scene.objects[i].triangleCount() == 12 &&
          std::abs(volumeOf(scene, scene.objects[i]) - volume) < 1e-3 * volume) {
        boxes.push_back(i);
      }
    }
    EXPECT_GT(boxes.size(), 2000u);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = i + 1; k < boxes.size(); ++k) {
        const Box &a = scene.objects[boxes[i]].bounds, &b = scene.objects[boxes[k]].bounds;
        EXPECT_FALSE(overlaps(a, b) && shareAFace(a, b))
            << scene.object_names[boxes[i]] << ", " << scene.object_names[boxes[k]] << ", seed " << seed;
      }
    }
  }
}

TEST(Ship, TheWalkGoesFromTheMainDeckToTheEngineRoom) {
  const Scene scene = makeShip({});
  ASSERT_EQ(scene.paths.size(), 2u);
  const CameraPath& path = scene.paths.front();
  EXPECT_EQ(path.name, "walk");
  ASSERT_EQ(path.frames.size(), 400u);
  EXPECT_NEAR(path.frames.front().eye.y, 18.25 + 1.7, 1e-9);
  EXPECT_NEAR(path.frames.back().eye.y, 2.0 + 1.7, 1e-9);
  EXPECT_LT(longestStep(path), 0.6);
  EXPECT_GT(smallestTurnCosine(path), 0.9);
  EXPECT_EQ(pathCalled(scene, "random").frames.size(), 200u);
}

TEST(Ship, EveryFrameIsFinite) {
  for (const CameraPath& path : makeShip({.seed = 9}).paths) {
    for (const CameraFrame& frame : path.frames) {
      EXPECT_TRUE(isFinite(frame.eye) && isFinite(frame.forward) && isFinite(frame.up)) << path.name;
      EXPECT_NEAR(length(frame.forward), 1.0, 1e-9) << path.name;
    }
  }
}

TEST(Ship, NoEyeIsInASolid) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = makeShip({.machinery = 1000, .seed = seed});
    for (const CameraPath& path : scene.paths) {
      EXPECT_EQ(whatHoldsTheEye(scene, path), "") << "seed " << seed;
    }
  }
}

TEST(Ship, AnEyeInAWallIsFound) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4});
  const auto wall =
      std::find(scene.object_names.begin(), scene.object_names.end(), "deck 1 room 0 cross wall");
  ASSERT_NE(wall, scene.object_names.end());
  const Object& object = scene.objects[static_cast<std::size_t>(wall - scene.object_names.begin())];
  CameraPath path;
  path.frames.push_back({Vec3d(center(object.bounds)) + Vec3d(0.01, 0.17, 0.29), {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(whatHoldsTheEye(scene, path), " frame 0: " + *wall);
}

TEST(Ship, TheWalkTouchesNothing) {
  for (const auto& [decks, rooms, seed] :
       {std::array{6u, 8u, 1u}, {6u, 8u, 2u}, {6u, 8u, 3u}, {3u, 4u, 4u}, {4u, 5u, 5u}, {3u, 16u, 6u}}) {
    const Scene scene = makeShip({.decks = decks, .rooms = rooms, .machinery = 1000, .seed = seed});
    EXPECT_EQ(whatIsHit(scene, scene.paths.front(), 0.16), "") << rooms << " rooms, seed " << seed;
  }
}

TEST(Ship, RandomViewsTouchNothing) {
  const Scene scene = makeShip({.seed = 11});
  CameraPath one = pathCalled(scene, "random");
  const std::vector<CameraFrame> frames = one.frames;
  for (const CameraFrame& frame : frames) {
    one.frames = {frame};
    EXPECT_EQ(whatIsHit(scene, one, 0.25), "") << "seed 11";
  }
}

// Counts the objects visible all around, not only in the picture, as the set of a cell does.
TEST(Ship, InsideLittleOfItIsSeen) {
  constexpr std::size_t kRays = 6000;
  const Scene scene = makeShip({});
  const CameraPath& path = scene.paths.front();
  for (std::size_t f = 0; f < path.frames.size(); f += 80) {
    const Vec3d eye = path.frames[f].eye - scene.origin;
    scenes::Random random(17, f);
    std::set<std::size_t> seen;
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      const double x = random.range(-1, 1), y = random.range(-1, 1), z = random.range(-1, 1);
      seen.insert(firstObject(scene, eye, normalized(Vec3d(x, y, z) + Vec3d(1e-9, 1e-9, 1e-9))));
    }
    EXPECT_GT(seen.size(), 10u) << "frame " << f;
    EXPECT_LT(seen.size(), scene.objects.size() / 4) << "frame " << f;
  }
}

TEST(Ship, TheSameOptionsGiveTheSameBitsAndAnotherSeedOthers) {
  const ShipOptions options{.decks = 4, .rooms = 5, .machinery = 30, .seed = 3};
  EXPECT_EQ(hashOf(makeShip(options)), hashOf(makeShip(options)));
  ShipOptions other = options;
  other.seed = 4;
  EXPECT_NE(hashOf(makeShip(options)), hashOf(makeShip(other)));
}

TEST(Ship, IsMadeByItsUrl) {
  const Result<Scene> scene = makeDemoScene("demo:ship?rooms=5&decks=3&machinery=7&seed=8");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeShip({.decks = 3, .rooms = 5, .machinery = 7, .seed = 8})));
  for (const char* url : {"demo:ship?decks=2", "demo:ship?decks=13", "demo:ship?rooms=3",
                          "demo:ship?rooms=17", "demo:ship?machinery=1001", "demo:ship?floors=3"}) {
    EXPECT_FALSE(makeDemoScene(url)) << url;
  }
}

}  // namespace
}  // namespace sightline
