// Occluders that are written as bytes and read again.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "scenes/procedural.h"
#include "sightline/occluders/occluder_set.h"
#include "tests/support/cut_off.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

struct CityOccluders {
  Scene scene = *makeDemoScene("demo:city?copies=1");
  OccluderSet occluders = findOccluders(scene.view());
  std::uint32_t objects = static_cast<std::uint32_t>(scene.objects.size());
};

TEST(OccluderBytes, AreReadAsTheyWereWritten) {
  const CityOccluders city;
  const auto bytes = std::make_shared<const LargeVector<std::byte>>(occluderBytes(city.occluders));
  for (const SharedBytes& shared : {SharedBytes{*bytes}, SharedBytes{*bytes, bytes}}) {
    const Result<OccluderSet> read = occludersFrom(shared, city.objects);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->vertices, city.occluders.vertices);
    EXPECT_EQ(read->lines, city.occluders.lines);
    EXPECT_EQ(read->of_object, city.occluders.of_object);
    EXPECT_EQ(read->unit_of_object, city.occluders.unit_of_object);
    EXPECT_EQ(read->body_of, city.occluders.body_of);
    EXPECT_EQ(read->area, city.occluders.area);
    EXPECT_EQ(read->report.too_small, city.occluders.report.too_small);
    EXPECT_EQ(occluderBytes(*read), *bytes);
    const auto* const begin = reinterpret_cast<const std::byte*>(read->vertices.data());
    EXPECT_EQ(begin > bytes->data() && begin < bytes->data() + bytes->size(), shared.owner != nullptr);
  }
  EXPECT_FALSE(occludersFrom({*bytes}, city.objects / 2)) << "of fewer objects";
  const LargeVector<std::byte> none = occluderBytes(findOccluders({}));
  EXPECT_TRUE(occludersFrom({none}, 0)) << "a scene without triangles";
  const LargeVector<std::byte> empty = occluderBytes({});
  EXPECT_TRUE(occludersFrom({empty}, 0));
}

TEST(OccluderBytes, CutOffAnywhereTheyAreRefused) {
  const CityOccluders city;
  const LargeVector<std::byte> bytes = occluderBytes(city.occluders);
  test::expectCutOffIsRefused(bytes, "find them again", [&](std::span<const std::byte> cut) {
    return occludersFrom({cut}, city.objects);
  });
}

TEST(OccluderBytes, ThatNameWhatTheyDoNotHaveAreRefused) {
  const CityOccluders city;
  ASSERT_FALSE(city.occluders.bodies.empty());
  const auto refuses = [&](auto&& change) {
    OccluderSet set = city.occluders;
    change(set);
    const LargeVector<std::byte> bytes = occluderBytes(set);
    return !occludersFrom({bytes}, city.objects);
  };
  const auto many = static_cast<std::uint32_t>(city.occluders.occluders.size());
  EXPECT_FALSE(refuses([](OccluderSet&) {}));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.occluders[0].first_vertex = 0xffffffff; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.occluders[0].vertex_count = 2; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.occluders[0].vertex_count = 65; }));
  EXPECT_TRUE(refuses([&](OccluderSet& set) { set.occluders[0].object = ObjectId(city.objects); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.occluders[0].plane.offset = std::nan(""); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.occluders[0].slack = -1.0f; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.vertices.pop_back(); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.vertices[0].x = INFINITY; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.edges[0].line = 0xffffffff; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.edges[0].first_neighbour = 0xffffffff; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) {
    set.edges[0].mesh_edge_count = 0xffff;
    set.edges[0].first_edge_vertex = 0xffffffff;
  }));
  EXPECT_TRUE(refuses([&](OccluderSet& set) { set.neighbours[0].occluder = OccluderId(many); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.neighbours[0].mesh_edge = 0xffffffff; }));
  EXPECT_TRUE(refuses([&](OccluderSet& set) { set.of_object[0] = OccluderId(many); }));
  EXPECT_TRUE(refuses([&](OccluderSet& set) { set.unit_of_object[0] = OccluderId(many); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { std::swap(set.objects[0], set.objects[1]); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.first_of_object.back() = 0; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.body_of[0] = 0xfffffffe; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.bodies[0].first_face = 0xffffffff; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.bodies[0].face_count = 0; }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.area = std::nan(""); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) {
    set.bodies[0].vertex_count = 33;
    set.body_vertices.resize(set.body_vertices.size() + 33);
  })) << "drawing has room for 32";
  EXPECT_TRUE(refuses([](OccluderSet& set) {
    set.edges[0].mesh_edge_count = 65;
    set.edge_vertices.resize(set.edge_vertices.size() + 65);
  })) << "drawing has 64 bits";
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.body_edges[0].to = 255; }));
  EXPECT_TRUE(refuses([&](OccluderSet& set) { set.body_faces[0].occluder = OccluderId(many); }));
  EXPECT_TRUE(refuses([](OccluderSet& set) { set.body_faces[0].vertex = 255; }));
}

TEST(OccluderBytes, WithAnyBytesChangedTheyAreRefusedOrHarmless) {
  const CityOccluders city;
  const LargeVector<std::byte> bytes = occluderBytes(city.occluders);
  std::mt19937 random(1);
  std::size_t refused = 0;
  double sum = 0.0;
  for (int i = 0; i < test::rounds(2000); ++i) {
    LargeVector<std::byte> changed = bytes;
    for (int k = 0; k < 3; ++k) {
      changed[random() % changed.size()] = static_cast<std::byte>(random());
    }
    const Result<OccluderSet> read = occludersFrom({changed}, city.objects);
    refused += read ? 0 : 1;
    for (std::size_t o = 0; read && o < read->occluders.size(); ++o) {
      for (const OccluderEdge& edge : read->edgesOf(read->occluders[o])) {
        sum += read->lines[edge.line][0].x;
        for (const EdgeNeighbour& neighbour : read->neighboursOf(edge)) {
          sum += (*read)[neighbour.occluder].area;
        }
      }
      if (const OccluderBody* body = read->bodyOf(OccluderId(static_cast<std::uint32_t>(o)))) {
        for (const BodyFace& face : read->facesOf(*body)) {
          sum += read->verticesOf(*body)[face.vertex].x;
        }
      }
    }
  }
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_GT(refused, test::rounds(100u));
}

}  // namespace
}  // namespace sightline
