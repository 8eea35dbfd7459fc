// What a sound glTF file becomes.

#include <gtest/gtest.h>

#include <cmath>

#include "src/io/gltf/gltf_uris.h"
#include "tests/io/glb_builder.h"
#include "tests/io/scene_checks.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::areaVector;
using test::cornerOf;
using test::errorOf;
using test::Glb;
using test::imported;
using test::oneTriangle;

// A mesh of one triangle of its own, so that each has a place to be told by.
int addTriangleMesh(Glb& glb, float x) {
  return glb.addMesh({Glb::primitive(glb.addPositions({x, 0, 0, x + 1, 0, 0, x, 1, 0}))});
}

TEST(Gltf, NumbersObjectsDepthFirstWithPrimitivesBeforeChildren) {
  Glb glb;
  const int positions = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int two = glb.addMesh({Glb::primitive(positions), Glb::primitive(positions)});
  const int one = glb.addMesh({Glb::primitive(positions)});
  // Roots in the order 4, 0; children of 0 in the order 3, 1; 2 hangs below 3.
  glb.addNode({{"name", "zero"}, {"mesh", two}, {"children", {3, 1}}});
  glb.addNode({{"name", "one"}, {"mesh", one}});
  glb.addNode({{"name", "two"}, {"mesh", one}});
  glb.addNode({{"name", "three"}, {"mesh", one}, {"children", {2}}});
  glb.addNode({{"name", "four"}, {"mesh", one}});
  glb.json["scenes"][0]["nodes"] = {4, 0};
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(scene.object_names,
            (std::vector<std::string>{"four", "zero/primitive0", "zero/primitive1", "three", "two", "one"}));
  EXPECT_TRUE(test::isSound(scene));
}

TEST(Gltf, PrimitivesWithoutTrianglesMakeNoObject) {
  Glb glb;
  const int positions = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int pair = glb.addPositions({0, 0, 0, 1, 0, 0});
  const int mesh = glb.addMesh({Glb::primitive(positions, -1, 0), Glb::primitive(positions, -1, 1),
                                Glb::primitive(positions, -1, 2), Glb::primitive(positions, -1, 3),
                                Glb::primitive(pair, -1, 5), Glb::primitive(positions, -1, 4)});
  glb.addNode({{"name", "mixed"}, {"mesh", mesh}});
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.object_names[0], "mixed/primitive5");
}

TEST(Gltf, NamesItsBuffersAndPicturesWhicheverItsContainer) {
  Glb glb = oneTriangle();
  glb.json["buffers"].push_back({{"uri", "a%20b.bin"}, {"byteLength", 1}});
  glb.json["buffers"].push_back({{"uri", "data:application/octet-stream;base64,AAAA"}, {"byteLength", 3}});
  glb.json["images"] = {{{"uri", "red.png"}}, {{"bufferView", 0}}, {{"uri", "100%.png"}}, 7};
  const std::vector<std::string> expected{"a b.bin", "red.png", "100%.png"};
  EXPECT_EQ(io::filesNamedByGltf(glb.bytes()), expected);
  EXPECT_EQ(io::filesNamedByGltf(glb.json.dump()), expected);
  EXPECT_EQ(io::filesNamedByGltf("\xef\xbb\xbf" + glb.json.dump()), expected) << "after a byte-order mark";
  EXPECT_TRUE(io::filesNamedByGltf(glb.bytes().substr(0, 40)).empty());
  EXPECT_TRUE(io::filesNamedByGltf("[1, 2]").empty());
}

TEST(Gltf, StripsAndFansCoverTheirAreaOnceAndFaceOneWay) {
  Glb glb;
  // A strip over [0,3] x [0,1], and a fan around the origin over the same unit squares' half disc.
  const int strip =
      glb.addPositions({0, 1, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 2, 1, 0, 2, 0, 0, 3, 1, 0, 3, 0, 0});
  const int fan = glb.addPositions({0, 0, 5, 1, 0, 5, 1, 1, 5, 0, 1, 5, -1, 1, 5, -1, 0, 5});
  const int mesh = glb.addMesh({Glb::primitive(strip, -1, 5), Glb::primitive(fan, -1, 6)});
  glb.addNode({{"mesh", mesh}});
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.objects.size(), 2u);
  ASSERT_EQ(scene.objects[0].triangleCount(), 6u);
  ASSERT_EQ(scene.objects[1].triangleCount(), 4u);
  double area[2] = {0, 0};
  for (std::size_t triangle = 0; triangle < 10; ++triangle) {
    const Vec3d twice = areaVector(scene, triangle);
    EXPECT_EQ(twice, Vec3d(0, 0, 1)) << "triangle " << triangle;
    area[triangle < 6 ? 0 : 1] += 0.5 * twice.z;
  }
  EXPECT_EQ(area[0], 3.0);
  EXPECT_EQ(area[1], 2.0);
}

template <typename T>
void expectIndicesRead() {
  Glb glb;
  const int positions = glb.addPositions({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  glb.addNode({{"mesh", glb.addMesh({Glb::primitive(positions, glb.addIndices<T>({1, 2, 3}))})}});
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 3u);
  EXPECT_EQ(scene.positions.size(), 3u) << "the unused vertex is dropped";
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, 1));
}

TEST(Gltf, IndicesOfEveryTypeAreRead) {
  expectIndicesRead<std::uint8_t>();
  expectIndicesRead<std::uint16_t>();
  expectIndicesRead<std::uint32_t>();
}

TEST(Gltf, MirroringTransformsKeepFrontsOutside) {
  Glb glb = oneTriangle();
  glb.json["nodes"][0]["scale"] = {-1, 1, 1};
  Scene scene = imported(glb.bytes());
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, 1)) << "the mirror image of a front that looks along +Z";
  glb.json["nodes"][0]["scale"] = {1, 1, -1};
  scene = imported(glb.bytes());
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, -1));
  glb.json["nodes"][0]["scale"] = {-1, -1, 1};
  scene = imported(glb.bytes());
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, 1)) << "two mirrors are a rotation";
}

TEST(Gltf, TransformsAreComposedFromTheRoot) {
  Glb glb;
  const double half = std::sqrt(0.5);
  // World = T(10,0,0) * R(90 degrees about Y) * S(2) * matrix(translation 0,0,1).
  glb.addNode({{"translation", {10, 0, 0}},
               {"rotation", {0, half, 0, half}},
               {"scale", {2, 2, 2}},
               {"children", {1}}});
  glb.addNode(
      {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1}}, {"mesh", addTriangleMesh(glb, 0)}});
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 3u);
  // (0,0,0) -> (0,0,1) -> (0,0,2) -> (2,0,0) -> (12,0,0), and so on: the rotation takes X to -Z and Z to X.
  const Vec3d wanted[3] = {{12, 0, 0}, {12, 0, -2}, {12, 2, 0}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(length(cornerOf(scene, i) - wanted[i]), 1e-5) << "corner " << i;
  }
}

TEST(Gltf, SparseAccessorsReplaceSomeElements) {
  Glb glb = oneTriangle();
  const int where = glb.addView<std::uint8_t>({0, 2});
  const int what = glb.addView<float>({5, 5, 5, 7, 7, 7});
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", where}, {"componentType", test::kUnsignedByte}}},
                       {"values", {{"bufferView", what}}}};
  glb.json["accessors"][0]["sparse"] = sparse;
  Scene scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(5, 5, 5));
  EXPECT_EQ(cornerOf(scene, 1), Vec3d(1, 0, 0));
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(7, 7, 7));

  glb.json["accessors"][0].erase("bufferView");
  scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(5, 5, 5));
  EXPECT_EQ(cornerOf(scene, 1), Vec3d(0, 0, 0)) << "zero by definition";
}

TEST(Gltf, QuantizedPositionsAreDecoded) {
  Glb glb;
  const int plain = glb.addAccessor<std::int16_t>({0, 0, 0, -300, 0, 0, 0, 20000, 0}, "VEC3", 3);
  const int shorts = glb.addAccessor<std::int16_t>({0, 0, 0, -32768, 0, 0, 0, 32767, 0}, "VEC3", 3);
  const int bytes = glb.addAccessor<std::uint8_t>({0, 0, 0, 255, 0, 0, 0, 51, 0}, "VEC3", 3);
  const int signed_bytes = glb.addAccessor<std::int8_t>({0, 0, 0, 127, 0, 0, 0, -128, 0}, "VEC3", 3);
  for (const int normalized : {shorts, bytes, signed_bytes}) {
    glb.json["accessors"][static_cast<std::size_t>(normalized)]["normalized"] = true;
  }
  glb.addNode({{"mesh", glb.addMesh({Glb::primitive(plain), Glb::primitive(shorts), Glb::primitive(bytes),
                                     Glb::primitive(signed_bytes)})}});
  glb.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 12u);
  EXPECT_EQ(cornerOf(scene, 1), Vec3d(-300, 0, 0));
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(0, 20000, 0));
  EXPECT_EQ(cornerOf(scene, 4), Vec3d(-1, 0, 0)) << "the lowest value is clamped";
  EXPECT_EQ(cornerOf(scene, 5), Vec3d(0, 1, 0));
  EXPECT_EQ(cornerOf(scene, 7), Vec3d(1, 0, 0));
  EXPECT_FLOAT_EQ(static_cast<float>(cornerOf(scene, 8).y), 0.2f);
  EXPECT_EQ(cornerOf(scene, 10), Vec3d(1, 0, 0));
  EXPECT_EQ(cornerOf(scene, 11), Vec3d(0, -1, 0));
}

TEST(Gltf, InterleavedPositionsAreReadWithTheirStride) {
  Glb glb;
  // Position and one more number per vertex; the first vertex starts 4 bytes into the view.
  const int view = glb.addView<float>({99, 0, 0, 0, 99, 1, 0, 0, 99, 0, 1, 0}, 16);
  glb.json["accessors"].push_back({{"bufferView", view},
                                   {"byteOffset", 4},
                                   {"componentType", test::kFloat},
                                   {"count", 3},
                                   {"type", "VEC3"}});
  glb.addNode({{"mesh", glb.addMesh({Glb::primitive(0)})}});
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 3u);
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(0, 0, 0));
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, 1));
}

TEST(Gltf, LargeCoordinatesKeepTheirMillimetres) {
  Glb glb;
  const int mesh = addTriangleMesh(glb, 0);
  glb.addNode({{"mesh", mesh}, {"translation", {5e6, 10, -3e6}}});
  glb.addNode({{"mesh", mesh}, {"translation", {5e6 + 0.001, 10, -3e6}}});
  glb.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 6u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(scene.origin[axis], std::round(scene.origin[axis])) << "the origin is a whole number";
  }
  EXPECT_LT(length(cornerOf(scene, 0) - Vec3d(5e6, 10, -3e6)), 1e-6);
  EXPECT_LT(length(cornerOf(scene, 3) - Vec3d(5e6 + 0.001, 10, -3e6)), 1e-6);
  EXPECT_LT(maxComponent(abs(Vec3d(sceneBounds(scene.view()).max))), 2.0)
      << "scene space is around its origin";
}

TEST(Gltf, ScenesNearTheOriginStayWhereTheyAre) {
  Glb glb;
  const int mesh = addTriangleMesh(glb, 0);
  glb.addNode({{"mesh", mesh}, {"translation", {500, 0, 0}}});
  EXPECT_EQ(imported(glb.bytes()).origin, Vec3d(0, 0, 0));
  // Wide, but around the origin: moving would win nothing.
  glb.json["nodes"][0]["translation"] = {50000, 0, 0};
  glb.addNode({{"mesh", mesh}, {"translation", {-50000, 0, 0}}});
  glb.json["scenes"][0]["nodes"] = {0, 1};
  EXPECT_EQ(imported(glb.bytes()).origin, Vec3d(0, 0, 0));
}

TEST(Gltf, EqualPositionsOfDifferentObjectsAreStoredOnce) {
  Glb glb;
  // Two triangles side by side in two objects, sharing an edge.
  const int left = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int right = glb.addPositions({1, 0, 0, 1, 1, 0, -0.0f, 1, 0});
  glb.addNode({{"mesh", glb.addMesh({Glb::primitive(left), Glb::primitive(right)})}});
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(scene.positions.size(), 4u);
  EXPECT_EQ(scene.indices[1], scene.indices[3]);
  EXPECT_EQ(scene.indices[2], scene.indices[5]) << "minus zero equals zero";
}

TEST(Gltf, MaterialsSayWhatIsSeenThrough) {
  Glb glb = oneTriangle();
  glb.json["materials"] = {
      {{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.75, 0.5}}}}},
      {{"alphaMode", "MASK"}},
      {{"alphaMode", "BLEND"}, {"doubleSided", true}},
      {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}}}},
      {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0}}}}}}};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.materials.size(), 6u) << "five of the file and the default";
  EXPECT_EQ(scene.materials[0].name, "wall");
  EXPECT_EQ(scene.materials[0].opacity, Opacity::kOpaque) << "alpha counts only in mode BLEND";
  EXPECT_EQ(scene.materials[0].base_color, (std::array<float, 4>{0.25f, 0.5f, 0.75f, 0.5f}));
  EXPECT_FALSE(scene.materials[0].double_sided);
  EXPECT_EQ(scene.materials[1].opacity, Opacity::kAlphaTested);
  EXPECT_EQ(scene.materials[2].opacity, Opacity::kBlended);
  EXPECT_TRUE(scene.materials[2].double_sided);
  EXPECT_EQ(scene.materials[3].opacity, Opacity::kBlended) << "light passes through";
  EXPECT_EQ(scene.materials[4].opacity, Opacity::kOpaque);
  EXPECT_EQ(scene.objects[0].material, MaterialId(5u));
  EXPECT_TRUE(scene.materials[5].opaque());
  EXPECT_FALSE(scene.materials[5].double_sided);
}

TEST(Gltf, TheMarkNearestToThePrimitiveWins) {
  const json yes = {{"occluder", true}};
  const json no = {{"occluder", false}};
  Glb glb = oneTriangle();
  glb.json["materials"] = {{{"extras", no}}};
  glb.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kNever);
  glb.json["meshes"][0]["extras"] = yes;
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kOccluder);
  glb.json["nodes"][0]["extras"] = no;
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kNever);
  glb.json["nodes"][0]["extras"] = {{"occluder", 1}};
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kOccluder)
      << "how some exporters write true";
  EXPECT_EQ(imported(oneTriangle().bytes()).objects[0].mark, OccluderMark::kAutomatic);
  glb.json["nodes"][0]["extras"] = {{"occluder", "yes"}};
  EXPECT_EQ(errorOf(glb.bytes()), "scene.glb: node 0: extras: \"occluder\" must be true or false");
}

TEST(Gltf, ReadsTheDefaultSceneOnly) {
  Glb glb;
  glb.addNode({{"name", "a"}, {"mesh", addTriangleMesh(glb, 0)}});
  glb.addNode({{"name", "b"}, {"mesh", 0}});
  glb.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  glb.json["scene"] = 1;
  EXPECT_EQ(imported(glb.bytes()).object_names, std::vector<std::string>{"b"});
  glb.json.erase("scene");
  EXPECT_EQ(imported(glb.bytes()).object_names, std::vector<std::string>{"a"});
  glb.json.erase("scenes");
  EXPECT_EQ(imported(glb.bytes()).object_names, (std::vector<std::string>{"a", "b"})) << "every root";
}

TEST(Gltf, AChainOfAHundredThousandNodesIsRead) {
  Glb glb = oneTriangle();
  constexpr int kNodes = 100'000;
  for (int i = 1; i < kNodes; ++i) {
    glb.addNode({{"children", {i == 1 ? 0 : i - 1}}, {"translation", {0, 0, 1}}});
  }
  glb.json["scenes"][0]["nodes"] = {kNodes - 1};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.indices.size(), 3u);
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(0, 0, kNodes - 1));
}

TEST(Gltf, DegenerateTrianglesStay) {
  Glb glb;
  const int positions = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  glb.addNode(
      {{"mesh", glb.addMesh({Glb::primitive(positions, glb.addIndices<std::uint8_t>({0, 0, 0, 0, 1, 2}))})}});
  EXPECT_EQ(imported(glb.bytes()).objects[0].triangleCount(), 2u);
}

TEST(Gltf, AFileWithoutMeshesIsAnEmptyScene) {
  Glb glb;
  glb.addNode({{"name", "nothing"}});
  const Scene scene = imported(glb.bytes());
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_TRUE(sceneBounds(scene.view()).empty());
}

}  // namespace
}  // namespace sightline
