#include "sightline/pvs/format/scene_id.h"

#include <gtest/gtest.h>

#include <functional>

#include "scenes/procedural.h"

namespace sightline {
namespace {

Scene smallScene() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  scene.indices = {0, 1, 2, 1, 3, 2, 3, 4, 2};
  scene.objects = {{.first_index = 0, .index_count = 6, .material = MaterialId(0u)},
                   {.first_index = 6, .index_count = 3, .material = MaterialId(1u)}};
  scene.materials = {{.name = "stone"}, {.name = "glass", .opacity = Opacity::kBlended}};
  scene.object_names = {"wall", "window"};
  updateBounds(scene);
  return scene;
}

using Change = std::function<void(Scene&)>;

TEST(SceneId, CountsObjectsAndTriangles) {
  const SceneId id = sceneId(smallScene().view());
  EXPECT_EQ(id.objects, 2u);
  EXPECT_EQ(id.triangles, 3u);
}

TEST(SceneId, ChangesWithWhateverDecidesWhatIsVisible) {
  const std::vector<std::pair<const char*, Change>> changes{
      {"a position", [](Scene& s) { s.positions[4].z = 1e-30f; }},
      {"a triangle's winding", [](Scene& s) { std::swap(s.indices[0], s.indices[1]); }},
      {"the order of objects", [](Scene& s) { std::swap(s.objects[0], s.objects[1]); }},
      {"where an object ends",
       [](Scene& s) {
         s.objects[0].index_count = 3, s.objects[1].first_index = 3, s.objects[1].index_count = 6;
       }},
      {"alpha test", [](Scene& s) { s.materials[0].opacity = Opacity::kAlphaTested; }},
      {"glass that became opaque", [](Scene& s) { s.materials[1].opacity = Opacity::kOpaque; }},
      {"double-sidedness", [](Scene& s) { s.materials[0].double_sided = true; }},
      {"an object's material", [](Scene& s) { s.objects[1].material = MaterialId(0u); }},
      {"a box", [](Scene& s) { s.objects[0].bounds.max.x += 1.0f; }},
      {"a mark", [](Scene& s) { s.objects[0].mark = OccluderMark::kNever; }}};
  const SceneId before = sceneId(smallScene().view());
  for (const auto& [what, change] : changes) {
    Scene scene = smallScene();
    change(scene);
    EXPECT_NE(sceneId(scene.view()).hash, before.hash) << what;
  }
}

TEST(SceneId, StaysWithWhatIsOnlySeen) {
  const std::vector<std::pair<const char*, Change>> changes{
      {"colours",
       [](Scene& s) {
         s.materials[0].base_color = {1, 0, 0, 1};
       }},
      {"names", [](Scene& s) { s.materials[0].name = "brick", s.object_names[0] = "house"; }},
      {"the origin",
       [](Scene& s) {
         s.origin = {1e6, 0, 0};
       }},
      {"the materials' order",
       [](Scene& s) {
         std::swap(s.materials[0], s.materials[1]);
         std::swap(s.objects[0].material, s.objects[1].material);
       }},
      {"a material that nothing has", [](Scene& s) { s.materials.emplace_back(); }}};
  const SceneId before = sceneId(smallScene().view());
  for (const auto& [what, change] : changes) {
    Scene scene = smallScene();
    change(scene);
    EXPECT_EQ(sceneId(scene.view()), before) << what;
  }
}

// Positions and indices are consecutive in the hash, so data that moves from one to the other must change it.
TEST(SceneId, TellsEmptyScenesFromEachOther) {
  Scene points;
  points.positions.resize(3);
  Scene none;
  EXPECT_NE(sceneId(points.view()), sceneId(none.view()));
  EXPECT_EQ(sceneId(none.view()), sceneId(Scene().view()));
}

OccluderPolygon polygon(std::span<const Vec3f> vertices, std::uint32_t object = 0,
                        bool double_sided = false) {
  return {vertices, double_sided, ObjectId(object)};
}

TEST(OccluderSetHash, ChangesWithWhateverAnOccluderIs) {
  const std::vector<Vec3f> square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<Vec3f> moved{{0, 0, 1}, {4, 0, 1}, {4, 4, 1}, {0, 4, 1}};
  const std::vector<Vec3f> triangle{{0, 0, 9}, {1, 0, 9}, {0, 1, 9}};
  const auto hashOf = [](std::vector<OccluderPolygon> polygons) {
    const OccluderSet set = makeOccluders(polygons);
    EXPECT_EQ(set.occluders.size(), polygons.size());
    return occluderSetHash(set);
  };
  const std::uint64_t before = hashOf({polygon(square), polygon(triangle)});
  EXPECT_EQ(hashOf({polygon(square), polygon(triangle)}), before);
  EXPECT_NE(hashOf({polygon(square)}), before);
  EXPECT_NE(hashOf({polygon(moved), polygon(triangle)}), before);
  EXPECT_NE(hashOf({polygon(square, 1), polygon(triangle)}), before);
  EXPECT_NE(hashOf({polygon(square), polygon(triangle, 0, true)}), before);
}

TEST(OccluderSetHash, ChangesWithSlackPlanesAndBodies) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 1});
  const OccluderSet before = findOccluders(scene.view());
  ASSERT_FALSE(before.bodies.empty());
  const std::vector<std::function<void(OccluderSet&)>> changes{
      [](OccluderSet& s) { s.occluders[3].slack += 0.01f; },
      [](OccluderSet& s) { s.occluders[3].plane.offset += 0.01; },
      [](OccluderSet& s) { s.bodies[0].slack += 0.01f; },
      [](OccluderSet& s) { s.body_vertices[0].x += 0.01f; },
      [](OccluderSet& s) { s.body_of[0] = s.body_of[0] == OccluderSet::kNoBody ? 0 : OccluderSet::kNoBody; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    OccluderSet set = before;
    changes[i](set);
    EXPECT_NE(occluderSetHash(set), occluderSetHash(before)) << i;
  }
}

TEST(OccluderSetHash, ChangesWithTheirOrder) {
  const std::vector<Vec3f> a{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<Vec3f> b{{0, 0, 9}, {4, 0, 9}, {4, 4, 9}, {0, 4, 9}};
  const std::vector<OccluderPolygon> ab{polygon(a), polygon(b)};
  const std::vector<OccluderPolygon> ba{polygon(b), polygon(a)};
  EXPECT_NE(occluderSetHash(makeOccluders(ab)), occluderSetHash(makeOccluders(ba)));
}

}  // namespace
}  // namespace sightline
