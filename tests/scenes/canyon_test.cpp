#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "scenes/procedural.h"
#include "tests/scenes/moving_checks.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

std::vector<std::size_t> partsOf(const MovingScene& scene, const char* of_class) {
  std::vector<std::size_t> parts;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    if (scene.classes[scene.parts[i].class_of] == of_class) {
      parts.push_back(i);
    }
  }
  return parts;
}

// Expects a difference of at most 15 %.
void expectAbout(double actual, double paper, const std::string& what) {
  EXPECT_NEAR(actual, paper, 0.15 * paper) << what;
}

// The terrain's height under a point, or -1e9 if there is none. Uses the triangles of a scene whose terrain
// is one piece.
class Ground {
 public:
  explicit Ground(const Scene& scene, const Object& terrain) : scene_(scene), terrain_(terrain) {}

  double heightAt(double x, double z) const {
    double height = -1e9;
    for (std::uint32_t i = 0; i < terrain_.index_count; i += 3) {
      const Vec3d a = at(i), b = at(i + 1), c = at(i + 2);
      const auto turn = [](const Vec3d& p, const Vec3d& q, double rx, double rz) {
        return (q.x - p.x) * (rz - p.z) - (q.z - p.z) * (rx - p.x);
      };
      const double u = turn(b, c, x, z), v = turn(c, a, x, z), w = turn(a, b, x, z), sum = u + v + w;
      if (sum != 0.0 && u / sum >= -1e-9 && v / sum >= -1e-9 && w / sum >= -1e-9) {
        height = std::max(height, (a.y * u + b.y * v + c.y * w) / sum);
      }
    }
    return height;
  }

 private:
  Vec3d at(std::uint32_t i) const {
    return Vec3d(scene_.positions[scene_.indices[terrain_.first_index + i]]);
  }

  const Scene& scene_;
  const Object& terrain_;
};

TEST(Canyon, HasSixAircraftOfSixPartsATerrainAndASky) {
  const MovingScene scene = makeCanyon({});
  EXPECT_EQ(partsOf(scene, "aircraft").size(), 36u);
  ASSERT_EQ(partsOf(scene, "sky").size(), 1u);
  EXPECT_EQ(scene.parts.back().settings.place, PartSettings::Place::kBackdrop);
  EXPECT_EQ(scene.scene.objects.back().triangleCount(), 480u);
  for (const MovingPart& part : scene.parts) {
    EXPECT_EQ(part.settings.is_static, scene.classes[part.class_of] != "aircraft");
  }
  EXPECT_EQ(scene.frames, 250u);
  EXPECT_EQ(whatIsWrongWithParts(scene), "");
  EXPECT_EQ(whatIsWrong(scene.scene), "");
}

TEST(Canyon, AircraftHaveAboutThePapersPolygonsAndHullPolygons) {
  const MovingScene scene = makeCanyon({.grid = 1});
  const std::map<std::string, std::array<double, 2>> paper{{"body", {1558, 192}}, {"engine", {1255, 230}},
                                                           {"wing", {1421, 80}},  {"tail", {22, 22}},
                                                           {"rudder", {48, 28}},  {"hinge", {64, 46}}};
  for (std::size_t i = 0; i < 36; ++i) {
    const std::string& name = scene.parts[i].name;
    const std::array<double, 2>& expected = paper.at(name.substr(0, name.find(' ')));
    expectAbout(scene.scene.objects[i].triangleCount(), expected[0], name);
    expectAbout(static_cast<double>(scene.hulls[scene.parts[i].hulls[0]].triangles.size()), expected[1],
                name + "'s hull");
    EXPECT_TRUE(isClosed(scene.scene, scene.scene.objects[i])) << name;
    EXPECT_GT(volumeOf(scene.scene, scene.scene.objects[i]), 0.0) << name;
  }
}

TEST(Canyon, TerrainSplitsIntoAboutThePapersPieces) {
  const MovingScene whole = makeCanyon({.grid = 1});
  ASSERT_EQ(partsOf(whole, "terrain").size(), 1u);
  expectAbout(whole.scene.objects[36].triangleCount(), 2473, "unsplit");
  struct Row {
    std::uint32_t grid;
    double pieces, polygons, hull_polygons;
  };
  for (const Row& row : {Row{20, 390, 31.98, 29.01},
                         {14, 191, 48.91, 37.78},
                         {10, 100, 76.48, 42.42},
                         {7, 49, 130.45, 57.51},
                         {5, 25, 225.32, 72.72}}) {
    const MovingScene scene = makeCanyon({.grid = row.grid});
    const std::vector<std::size_t> pieces = partsOf(scene, "terrain");
    double polygons = 0.0, hull_polygons = 0.0;
    for (const std::size_t i : pieces) {
      polygons += scene.scene.objects[i].triangleCount();
      hull_polygons += static_cast<double>(scene.hulls[scene.parts[i].hulls[0]].triangles.size());
    }
    EXPECT_EQ(polygons, canyonTerrainTriangles({.grid = row.grid}));
    const auto count = static_cast<double>(pieces.size());
    const std::string grid = "grid " + std::to_string(row.grid);
    expectAbout(count, row.pieces, grid + " pieces");
    // The paper's "20 %" may be the whole overlap, as here, or that of each side, which is a third more.
    EXPECT_NEAR(polygons / count, row.polygons, 0.25 * row.polygons) << grid;
    expectAbout(hull_polygons / count, row.hull_polygons, grid + " hull polygons");
  }
}

TEST(Canyon, AFewCellsOfAFineGridAreEmptyAndNoneOfACoarseOne) {
  EXPECT_LT(partsOf(makeCanyon({.grid = 14}), "terrain").size(), 196u);
  EXPECT_EQ(partsOf(makeCanyon({.grid = 10}), "terrain").size(), 100u);
  EXPECT_EQ(partsOf(makeCanyon({.grid = 5}), "terrain").size(), 25u);
}

TEST(Canyon, MeshesAreWithinTheirHulls) {
  EXPECT_EQ(whatSticksOut(makeCanyon({.grid = 14})), "");
  EXPECT_EQ(whatSticksOut(makeCanyon({.grid = 20, .seed = 3})), "");
}

TEST(Canyon, AircraftPartsKeepToTheirSidesOfTheirPlanesInAllFrames) {
  const MovingScene scene = makeCanyon({.grid = 2});
  const std::vector<Mat4> start = posesOf(scene, 0);
  std::size_t planes = 0;
  for (const MovingPlane& plane : scene.planes) {
    if (plane.first >= 36) {
      continue;
    }
    ++planes;
    ASSERT_EQ(plane.first / 6, plane.second / 6);
    for (const bool first : {true, false}) {
      const std::size_t part = first ? plane.first : plane.second;
      const auto indices = scene.scene.view().indicesOf(scene.scene.objects[part]);
      for (std::uint32_t frame = 0; frame < scene.frames; frame += 7) {
        const std::vector<Mat4> poses = posesOf(scene, frame);
        for (const std::uint32_t index : indices) {
          const Vec3d local = partFromWorld(start[part], Vec3d(scene.scene.positions[index]));
          const Vec3d in_first = partFromWorld(poses[plane.first], transformPoint(poses[part], local));
          const double side = plane.rule.plane.evaluate(in_first);
          ASSERT_GT(first ? side : -side, 1e-4) << scene.parts[plane.first].name << ", "
                                                << scene.parts[plane.second].name << " frame " << frame;
        }
      }
    }
  }
  EXPECT_EQ(planes, 6u * 6u);
}

TEST(Canyon, HullsOfPartsThatBelongTogetherReachThroughTheirPlanes) {
  // Otherwise the separating planes would not be needed.
  const MovingScene scene = makeCanyon({.grid = 1});
  const std::vector<Mat4> poses = posesOf(scene, 40);
  std::size_t reach_through = 0;
  for (const MovingPlane& plane : scene.planes) {
    double lowest = 1.0, highest = -1.0;
    for (const Vec3d& vertex : scene.hulls[scene.parts[plane.first].hulls[0]].vertices) {
      lowest = std::min(lowest, plane.rule.plane.evaluate(vertex));
    }
    for (const Vec3d& vertex : scene.hulls[scene.parts[plane.second].hulls[0]].vertices) {
      const Vec3d in_first = partFromWorld(poses[plane.first], transformPoint(poses[plane.second], vertex));
      highest = std::max(highest, plane.rule.plane.evaluate(in_first));
    }
    reach_through += highest > lowest ? 1 : 0;
  }
  // All parts except tail and rudder, which have the hinge between them.
  EXPECT_EQ(reach_through, 6u * 5u);
}

TEST(Canyon, TerrainPiecesIntersectOnlyTheirNeighboursAndEachHasAPlane) {
  const MovingScene scene = makeCanyon({.grid = 14});
  const std::vector<std::size_t> pieces = partsOf(scene, "terrain");
  std::size_t planes = 0;
  for (const MovingPlane& plane : scene.planes) {
    planes += plane.first >= 36 ? 1 : 0;
    EXPECT_EQ(plane.first >= 36, plane.second >= 36);
  }
  std::size_t neighbours = 0;
  const auto cellOf = [&](std::size_t part) { return std::stoi(scene.parts[part].name.substr(8)); };
  for (const std::size_t a : pieces) {
    for (const std::size_t b : pieces) {
      const int columns = std::abs(cellOf(a) % 14 - cellOf(b) % 14),
                rows = std::abs(cellOf(a) / 14 - cellOf(b) / 14);
      neighbours += a < b && columns <= 1 && rows <= 1 ? 1 : 0;
    }
  }
  // At the terrain's outline, the pieces of some neighbours do not reach each other.
  EXPECT_LE(planes, neighbours);
  EXPECT_GE(planes + 8, neighbours);
}

TEST(Canyon, AircraftFlyAboveTheTerrainBetweenTheValleysSides) {
  const MovingScene scene = makeCanyon({.grid = 1});
  const Ground ground(scene.scene, scene.scene.objects[36]);
  for (std::uint32_t frame = 0; frame < scene.frames; frame += 31) {
    const std::vector<Mat4> poses = posesOf(scene, frame);
    for (std::size_t part = 0; part < 36; part += 6) {
      const Vec3d at = transformPoint(poses[part], {});
      for (const double across : {-6.0, 0.0, 6.0}) {
        const Vec3d under = transformPoint(poses[part], {0, 0, across});
        const double height = ground.heightAt(under.x, under.z);
        EXPECT_GT(height, -20.0);
        EXPECT_GT(under.y - 3.0, height + 15.0) << scene.parts[part].name << " frame " << frame;
      }
      for (const double side : {-1.0, 1.0}) {
        double highest = -1e9;
        for (double across = 0.0; across < 120.0; across += 6.0) {
          const Vec3d p = transformPoint(poses[part], {0, 0, side * across});
          highest = std::max(highest, ground.heightAt(p.x, p.z));
        }
        EXPECT_GT(highest, at.y + 20.0) << scene.parts[part].name << " frame " << frame;
      }
    }
  }
}

TEST(Canyon, AircraftKeepApartMoveSmoothlyAndLookWhereTheyFly) {
  const MovingScene scene = makeCanyon({.grid = 1});
  std::vector<Mat4> before = posesOf(scene, 0);
  for (std::uint32_t frame = 1; frame < scene.frames; ++frame) {
    const std::vector<Mat4> now = posesOf(scene, frame);
    for (std::size_t a = 0; a < 36; a += 6) {
      const Vec3d at = transformPoint(now[a], {}), step = at - transformPoint(before[a], {});
      EXPECT_GT(length(step), 1.0);
      EXPECT_LT(length(step), 5.0);
      EXPECT_GT(dot(normalized(step), transformDirection(now[a], {1, 0, 0})), 0.98);
      for (std::size_t b = 0; b < a; b += 6) {
        EXPECT_GT(length(at - transformPoint(now[b], {})), 13.0) << "frame " << frame;
      }
    }
    before = now;
  }
}

TEST(Canyon, RuddersTurnWithTheirHinges) {
  const MovingScene scene = makeCanyon({.grid = 1});
  double most = 0.0;
  for (std::uint32_t frame = 0; frame < 60; ++frame) {
    const std::vector<Mat4> poses = posesOf(scene, frame);
    const Vec3d body = transformDirection(poses[0], {1, 0, 0}),
                rudder = transformDirection(poses[4], {1, 0, 0});
    EXPECT_EQ(poses[4].m, poses[5].m);
    most = std::max(most, length(cross(body, rudder)));
  }
  EXPECT_GT(most, 0.1);
  EXPECT_LT(most, 0.3);
}

TEST(Canyon, CameraSeesTheAircraftFromWithinTheValley) {
  const MovingScene scene = makeCanyon({.grid = 1});
  const Ground ground(scene.scene, scene.scene.objects[36]);
  const CameraPath& path = scene.scene.paths[0];
  for (std::uint32_t frame = 0; frame < scene.frames; frame += 25) {
    const View view = path.view(frame, scene.scene.origin);
    const double height = ground.heightAt(view.eye.x, view.eye.z);
    EXPECT_GT(view.eye.y, height + 15.0) << "frame " << frame;
    EXPECT_LT(view.eye.y, 70.0);
    const std::vector<Mat4> poses = posesOf(scene, frame);
    const Frustum frustum = frustumOf(view);
    for (std::size_t part = 0; part < 36; part += 6) {
      for (const Plane& plane : frustum.planes) {
        EXPECT_GT(plane.evaluate(transformPoint(poses[part], {})), 0.0)
            << scene.parts[part].name << " frame " << frame;
      }
    }
  }
}

TEST(Canyon, IsTheSameForTheSameOptionsAndComesByItsUrl) {
  const MovingScene a = makeCanyon({.grid = 7}), b = makeCanyon({.grid = 7}),
                    c = makeCanyon({.grid = 7, .seed = 2});
  EXPECT_EQ(hashOf(a.scene), hashOf(b.scene));
  EXPECT_NE(hashOf(a.scene), hashOf(c.scene));
  ASSERT_TRUE(isMovingDemoUrl("demo:canyon"));
  const Result<MovingScene> by_url = makeMovingDemoScene("demo:canyon?grid=7&seed=2");
  ASSERT_TRUE(by_url);
  EXPECT_EQ(hashOf(by_url->scene), hashOf(c.scene));
  EXPECT_EQ(by_url->planes.size(), c.planes.size());
  EXPECT_FALSE(makeMovingDemoScene("demo:canyon?grid=0"));
}

}  // namespace
}  // namespace sightline
