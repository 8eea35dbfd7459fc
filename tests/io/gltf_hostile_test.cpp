// What a wrong glTF file gets: one line that names the element, and never a crash or a scene that is not
// sound.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "src/io/gltf/gltf.h"
#include "tests/io/glb_builder.h"
#include "tests/io/scene_checks.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::errorOf;
using test::Glb;
using test::imported;
using test::oneTriangle;

struct Fault {
  const char* name;
  std::function<void(Glb&)> make;  // from oneTriangle
  std::string message;             // a part of it
};

std::ostream& operator<<(std::ostream& out, const Fault& fault) {
  return out << fault.name;
}

class GltfFault : public testing::TestWithParam<Fault> {};

TEST_P(GltfFault, IsRefusedByTheNameOfItsElement) {
  Glb glb = oneTriangle();
  GetParam().make(glb);
  const std::string message = errorOf(glb.bytes());
  EXPECT_EQ(message.find("scene.glb: "), 0u) << message;
  EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

const float kNan = std::numeric_limits<float>::quiet_NaN();

// Accessor 0: positions, 36 bytes in view 0; accessor 1: indices, 6 bytes in view 1 at byte 36; 42 bytes in
// all.
const Fault kFaults[] = {
    {"IndexValue", [](Glb& g) { g.binary[38] = 17; },
     "mesh 0 primitive 0: index 17 at position 1 is out of range (accessor 0 has 3 vertices)"},
    {"PositionNotANumber", [](Glb& g) { std::memcpy(g.binary.data() + 12, &kNan, 4); },
     "mesh 0 primitive 0: vertex 1 of accessor 0 is not finite"},
    {"AccessorBeyondView", [](Glb& g) { g.json["accessors"][0]["count"] = 4; },
     "accessor 0: 4 elements of 12 bytes"},
    {"AccessorOffsetBeyondView", [](Glb& g) { g.json["accessors"][0]["byteOffset"] = 4; },
     "accessor 0: 3 elements"},
    {"AccessorCountHuge", [](Glb& g) { g.json["accessors"][0]["count"] = 9007199254740992; }, "accessor 0: "},
    {"AccessorCountBeyondExact", [](Glb& g) { g.json["accessors"][0]["count"] = 1e300; },
     "accessor 0: \"count\" must be an integer"},
    {"AccessorCountNegative", [](Glb& g) { g.json["accessors"][0]["count"] = -3; },
     "accessor 0: \"count\" must be"},
    {"AccessorCountFraction", [](Glb& g) { g.json["accessors"][0]["count"] = 2.5; },
     "accessor 0: \"count\" must be"},
    {"AccessorCountText", [](Glb& g) { g.json["accessors"][0]["count"] = "3"; },
     "accessor 0: \"count\" must be"},
    {"AccessorCountMissing", [](Glb& g) { g.json["accessors"][0].erase("count"); },
     "accessor 0: \"count\" is missing"},
    {"AccessorOffsetHuge", [](Glb& g) { g.json["accessors"][0]["byteOffset"] = 9007199254740992; },
     "accessor 0: "},
    {"AccessorComponentType", [](Glb& g) { g.json["accessors"][0]["componentType"] = 5124; },
     "accessor 0: component"},
    {"AccessorComponentDouble", [](Glb& g) { g.json["accessors"][0]["componentType"] = 5130; },
     "component type 5130"},
    {"AccessorType", [](Glb& g) { g.json["accessors"][0]["type"] = "VEC5"; }, "accessor 0: \"type\" must be"},
    {"PositionsOfTwoComponents", [](Glb& g) { g.json["accessors"][0]["type"] = "VEC2"; },
     "mesh 0 primitive 0: positions must be VEC3"},
    {"PositionsOfIntegers", [](Glb& g) { g.json["accessors"][0]["componentType"] = test::kUnsignedInt; },
     "mesh 0 primitive 0: positions must be"},
    {"IndicesOfFloats", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["indices"] = 0; },
     "mesh 0 primitive 0: indices must be"},
    {"IndicesSigned", [](Glb& g) { g.json["accessors"][1]["componentType"] = test::kShort; },
     "indices must be SCALAR"},
    {"ImpliedElementsHuge",
     [](Glb& g) {
       g.json["accessors"][0].erase("bufferView");
       g.json["accessors"][0]["count"] = 4000000000;
     },
     "accessor 0: has 4000000000 elements without a buffer view"},
    {"AccessorViewMissing", [](Glb& g) { g.json["accessors"][0]["bufferView"] = 7; },
     "buffer view 7 does not exist"},
    {"ViewBeyondBuffer", [](Glb& g) { g.json["bufferViews"][0]["byteLength"] = 43; },
     "buffer view 0: 43 bytes from byte 0 do not lie in buffer 0 of 42 bytes"},
    {"ViewOffsetBeyondBuffer", [](Glb& g) { g.json["bufferViews"][0]["byteOffset"] = 9007199254740991; },
     "buffer view 0: "},
    {"ViewBufferMissing", [](Glb& g) { g.json["bufferViews"][0]["buffer"] = 1; }, "buffer 1 does not exist"},
    {"ViewStrideTooSmall", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 8; },
     "accessor 0: elements of 12"},
    {"ViewStrideBeyondEnd", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 16; },
     "every 16 from byte 0"},
    {"ViewStrideHuge", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 1 << 30; },
     "buffer view 0: \"byteStride\" must be"},
    {"ViewStrideOdd", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 13; }, "must be a multiple of 4"},
    {"BufferLongerThanItsBytes", [](Glb& g) { g.json["buffers"][0]["byteLength"] = 45; },
     "buffer 0: states 45 bytes, but has only 44"},
    {"BufferLengthHuge", [](Glb& g) { g.json["buffers"][0]["byteLength"] = 9007199254740992; },
     "buffer 0: states"},
    {"BufferElsewhere", [](Glb& g) { g.json["buffers"][0]["uri"] = "other.bin"; },
     "buffer 0: is in another file"},
    {"BufferDataUriWrong",
     [](Glb& g) { g.json["buffers"][0]["uri"] = "data:application/gltf-buffer;base64,A*=="; },
     "buffer 0: its data URI"},
    {"BufferDataUriNotBase64", [](Glb& g) { g.json["buffers"][0]["uri"] = "data:text/plain,abc"; },
     "buffer 0: its data URI is not base64"},
    {"NoPositions", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["attributes"] = json::object(); },
     "mesh 0 primitive 0: has no POSITION"},
    {"PositionAccessorMissing",
     [](Glb& g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2; },
     "mesh 0 primitive 0: accessor 2 does not exist (the file has 2)"},
    {"PrimitivesNotAnArray", [](Glb& g) { g.json["meshes"][0]["primitives"] = 3; },
     "mesh 0: \"primitives\" must be"},
    {"PrimitiveNotAnObject", [](Glb& g) { g.json["meshes"][0]["primitives"][0] = "x"; },
     "mesh 0 primitive 0: must be an object"},
    {"ModeUnknown", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["mode"] = 7; },
     "mesh 0 primitive 0: mode 7 does not exist"},
    {"MaterialMissing", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["material"] = 0; },
     "mesh 0 primitive 0: material 0 does not exist (the file has 0)"},
    {"AlphaModeUnknown",
     [](Glb& g) {
       g.json["materials"] = {{{"alphaMode", "GLASS"}}};
     },
     "material 0: alpha mode"},
    {"ColourOfThree",
     [](Glb& g) {
       g.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1}}}}}};
     },
     "material 0 pbrMetallicRoughness: \"baseColorFactor\" must be an array of 4"},
    {"HalfATriangle", [](Glb& g) { g.json["accessors"][1]["count"] = 2; },
     "2 corners do not make whole triangles"},
    {"MeshMissing", [](Glb& g) { g.json["nodes"][0]["mesh"] = 1; },
     "node 0: mesh 1 does not exist (the file has 1)"},
    {"MeshNegative", [](Glb& g) { g.json["nodes"][0]["mesh"] = -1; }, "node 0: \"mesh\" must be an integer"},
    {"CameraMissing", [](Glb& g) { g.json["nodes"][0]["camera"] = 0; }, "node 0: camera 0 does not exist"},
    {"ChildMissing", [](Glb& g) { g.json["nodes"][0]["children"] = {5}; }, "node 0: child 5 does not exist"},
    {"OwnChild", [](Glb& g) { g.json["nodes"][0]["children"] = {0}; }, "node 0: is its own ancestor"},
    {"CycleOfTwo",
     [](Glb& g) {
       g.addNode({{"name", "a"}, {"children", {2}}});
       g.addNode({{"name", "b"}, {"children", {1}}});
     },
     "node 1: is its own ancestor"},
    {"TwoParents",
     [](Glb& g) {
       g.addNode({{"name", "p"}, {"children", {3}}});
       g.addNode({{"name", "q"}, {"children", {3}}});
       g.addNode({{"name", "child"}, {"mesh", 0}});
     },
     "node 3: is a child of node 1 and of node 2"},
    {"ChildTwice",
     [](Glb& g) {
       g.addNode({{"name", "twice"}, {"children", {0, 0}}});
     },
     "node 0: is a child of node 1"},
    {"RootTwice",
     [](Glb& g) {
       g.json["scenes"][0]["nodes"] = {0, 0};
     },
     "scene 0: node 0 is named twice"},
    {"RootWithParent",
     [](Glb& g) {
       g.addNode({{"name", "parent"}, {"children", {0}}});
     },
     "scene 0: node 0 is not a root"},
    {"RootMissing", [](Glb& g) { g.json["scenes"][0]["nodes"] = {3}; }, "scene 0: node 3 does not exist"},
    {"SceneMissing", [](Glb& g) { g.json["scene"] = 1; }, "scene 1 does not exist (the file has 1)"},
    {"MatrixOfNine", [](Glb& g) { g.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 1, 0, 0, 0, 1}; },
     "node 0: \"matrix\" must be an array of 16 numbers"},
    {"MatrixWithNull",
     [](Glb& g) {
       g.json["nodes"][0]["matrix"] = {1, nullptr};
     },
     "node 0: \"matrix\" must be"},
    {"MatrixProjective",
     [](Glb& g) { g.json["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
     "node 0: the last row of its matrix"},
    {"RotationOfLengthZero",
     [](Glb& g) {
       g.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "node 0: its transform is not finite"},
    {"ScaleOfOneNumber", [](Glb& g) { g.json["nodes"][0]["scale"] = {2}; },
     "node 0: \"scale\" must be an array of 3 numbers"},
    {"PositionOverflow",
     [](Glb& g) {
       g.json["nodes"][0]["translation"] = {1e39, 0, 0};
     },
     "node 0: mesh 0 primitive 0: the world position of vertex 0 exceeds single precision"},
    {"TransformOverflow",
     [](Glb& g) {
       g.json["nodes"][0]["scale"] = {1e300, 1, 1};
       g.addNode({{"scale", {1e300, 1, 1}}, {"children", {0}}});
       g.json["scenes"][0]["nodes"] = {1};
     },
     "node 0: its transform to world space is too large"},
    {"ComponentTypeUnknown", [](Glb& g) { g.json["accessors"][0]["componentType"] = 5119; },
     "Invalid `componentType` in accessor. Got 5119"},
    {"IndicesWithoutAccessor", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["indices"] = 2; },
     "primitive indices accessor out of bounds"},
    {"IndicesWithoutView", [](Glb& g) { g.json["accessors"][1].erase("bufferView"); },
     "accessor[1] invalid bufferView"},
    {"CameraTypeUnknown",
     [](Glb& g) {
       g.json["cameras"] = {{{"type", "fisheye"}}};
     },
     "Invalid camera type: \"fisheye\""},
    {"CameraWithoutPerspective",
     [](Glb& g) {
       g.json["cameras"] = {{{"type", "perspective"}}};
     },
     "Perspective camera description not found."},
    {"CameraWithoutOrthographic",
     [](Glb& g) {
       g.json["cameras"] = {{{"type", "orthographic"}}};
     },
     "Orthographic camera description not found."},
    {"Draco", [](Glb& g) { g.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
     "requires the extension \"KHR_draco_mesh_compression\""},
    {"Meshopt", [](Glb& g) { g.json["extensionsRequired"] = {"EXT_meshopt_compression"}; },
     "requires the extension \"EXT_meshopt_compression\""},
    {"VersionOne", [](Glb& g) { g.json["asset"]["version"] = "1.0"; }, "is glTF version \"1.0\""},
    {"NoAsset", [](Glb& g) { g.json.erase("asset"); }, "\"asset\" is missing"},
    {"NodesNotAnArray", [](Glb& g) { g.json["nodes"] = json::object(); }, "\"nodes\" must be an array"},
};

INSTANTIATE_TEST_SUITE_P(All, GltfFault, testing::ValuesIn(kFaults),
                         [](const testing::TestParamInfo<Fault>& fault) {
                           return std::string(fault.param.name);
                         });

json sparseOf(int count, int indices, int values) {
  return {{"count", count},
          {"indices", {{"bufferView", indices}, {"componentType", test::kUnsignedByte}}},
          {"values", {{"bufferView", values}}}};
}

TEST(GltfHostile, SparseIndicesMustAscendWithinTheAccessor) {
  for (const std::vector<std::uint8_t>& indices : {std::vector<std::uint8_t>{0, 3}, {2, 1}, {1, 1}}) {
    Glb glb = oneTriangle();
    const int where = glb.addView(indices);
    glb.json["accessors"][0]["sparse"] = sparseOf(2, where, glb.addView<float>({5, 5, 5, 7, 7, 7}));
    EXPECT_NE(errorOf(glb.bytes()).find("accessor 0 sparse: index "), std::string::npos);
  }
}

TEST(GltfHostile, SparseRangesMustLieInTheirViews) {
  Glb glb = oneTriangle();
  const int where = glb.addView<std::uint8_t>({0, 1});
  const int what = glb.addView<float>({5, 5, 5, 7, 7, 7});
  const auto message = [&](const json& sparse) {
    glb.json["accessors"][0]["sparse"] = sparse;
    return errorOf(glb.bytes());
  };
  EXPECT_NE(message(sparseOf(3, where, what)).find("accessor 0 sparse indices: 3 elements"),
            std::string::npos);
  EXPECT_NE(message(sparseOf(2, where, where)).find("accessor 0 sparse values: 2 elements"),
            std::string::npos);
  EXPECT_NE(message(sparseOf(2, 9, what)).find("buffer view 9 does not exist"), std::string::npos);
  EXPECT_NE(message(sparseOf(0x7fffffff, where, what)).find("sparse accessors replace"), std::string::npos);
  json signed_indices = sparseOf(2, where, what);
  signed_indices["indices"]["componentType"] = test::kByte;
  EXPECT_NE(message(signed_indices).find("component type 5120"), std::string::npos);
}

TEST(GltfHostile, EveryTruncationIsRefused) {
  const std::string whole = oneTriangle().bytes();
  ASSERT_EQ(imported(whole).objects.size(), 1u);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(importGltf(whole.substr(0, size), "", "cut.glb")) << "cut after " << size << " bytes";
  }
}

TEST(GltfHostile, TruncatedJsonIsRefused) {
  Glb glb = oneTriangle();
  const std::string whole = glb.json.dump();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(importGltf(whole.substr(0, size), "", "cut.gltf")) << "cut after " << size << " bytes";
  }
}

TEST(GltfHostile, FlippedBytesGiveAnErrorOrASoundScene) {
  Glb glb = oneTriangle();
  const int where = glb.addView<std::uint8_t>({0, 2});
  glb.json["accessors"][0]["sparse"] = sparseOf(2, where, glb.addView<float>({5, 5, 5, 7, 7, 7}));
  glb.json["materials"] = {{{"alphaMode", "MASK"}}};
  glb.addNode({{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}});
  glb.json["scenes"][0]["nodes"] = {0, 1};
  const std::string whole = glb.bytes();
  ASSERT_EQ(imported(whole).objects.size(), 2u);
  int refused = 0;
  for (std::uint32_t seed = 0; seed < 20'000; ++seed) {
    std::mt19937 random(seed);
    std::string bytes = whole;
    for (std::uint32_t flips = 1 + random() % 4; flips > 0; --flips) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    }
    const Result<Scene> scene = importGltf(bytes, "", "flipped.glb");
    refused += scene ? 0 : 1;
    EXPECT_TRUE(!scene || test::isSound(*scene)) << "seed " << seed;
  }
  EXPECT_GT(refused, 5'000) << "most places are checked";
  EXPECT_LT(refused, 20'000) << "some change only numbers or names";
}

TEST(GltfHostile, DeepNestingIsRefusedQuickly) {
  for (const char bracket : {'[', '{'}) {
    const std::string text = "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(1'000'000, bracket);
    EXPECT_NE(errorOf(text).find("is nested more than"), std::string::npos);
  }
  const std::string in_text =
      "{\"asset\":{\"version\":\"2.0\",\"generator\":\"" + std::string(1000, '[') + "\"}}";
  EXPECT_TRUE(importGltf(in_text, "", "text.gltf")) << "brackets in a string are not nesting";
}

TEST(GltfHostile, AFewBytesCannotMultiplyIntoBillionsOfVertices) {
  Glb glb;
  // 4 million corners without a byte behind them, drawn by every node.
  glb.json["accessors"].push_back({{"componentType", test::kFloat}, {"count", 1 << 22}, {"type", "VEC3"}});
  const int mesh = glb.addMesh({Glb::primitive(0, -1, 5)});
  std::vector<int> roots;
  for (int i = 0; i < 1000; ++i) {
    roots.push_back(glb.addNode({{"name", "n"}, {"mesh", mesh}}));
  }
  glb.json["scenes"][0]["nodes"] = roots;
  EXPECT_NE(errorOf(glb.bytes()).find("node 1: up to here the scene has 8388608 vertices"),
            std::string::npos);
}

TEST(GltfHostile, TheLimitsCountEveryInstance) {
  Glb glb = oneTriangle();
  glb.addNode({{"name", "second"}, {"mesh", 0}});
  glb.addNode({{"name", "third"}, {"mesh", 0}});
  glb.json["scenes"][0]["nodes"] = {0, 1, 2};
  const auto fault = [&](const io::ImportLimits& limits) {
    const Result<Scene> scene = io::importGltf(glb.bytes(), "", "scene.glb", limits);
    return scene ? std::string() : scene.error().message;
  };
  EXPECT_EQ(
      fault({.triangles = 3, .vertices = 9, .objects = 3, .implied_elements = 0, .implied_vertices = 0}), "");
  EXPECT_NE(fault({.triangles = 2}).find("node 2: up to here the scene has 3 objects, 3 triangles"),
            std::string::npos);
  EXPECT_NE(fault({.objects = 2}).find("node 2: up to here the scene has 3 objects"), std::string::npos);
  EXPECT_NE(fault({.vertices = 8}).find("node 2: up to here the scene has 9 vertices"), std::string::npos);
  glb.json["accessors"][0].erase("bufferView");
  EXPECT_EQ(fault({.implied_elements = 3, .implied_vertices = 9}), "");
  EXPECT_NE(fault({.implied_vertices = 8}).find("9 vertices, 9 of them without a buffer view"),
            std::string::npos);
  EXPECT_NE(
      fault({.implied_elements = 2}).find("accessor 0: has 3 elements without a buffer view; at most 2"),
      std::string::npos);
}

TEST(GltfHostile, ContainersThatLieAreRefused) {
  const std::string whole = oneTriangle().bytes();
  const auto with = [&](std::size_t offset, std::size_t value) {
    std::string bytes = whole;
    bytes.replace(offset, 4, Glb::uint32(value));
    return errorOf(bytes);
  };
  EXPECT_EQ(with(4, 1), "scene.glb: binary glTF version 1 is not supported, only version 2");
  EXPECT_NE(with(8, whole.size() + 4).find("the file is cut off"), std::string::npos);
  EXPECT_NE(with(8, 4).find("less than its own header"), std::string::npos);
  EXPECT_NE(with(12, 0xffffffff).find("chunk 0: has 4294967295 bytes"), std::string::npos);
  EXPECT_NE(with(16, 0x004e4942).find("the first chunk must be JSON"), std::string::npos);
  EXPECT_EQ(test::errorOf(""), "scene.glb: the file is empty");
}

class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder / "scene");
    written = oneTriangle();
    std::ofstream(folder / "scene" / "some data.bin", std::ios::binary) << written.binary;
    std::ofstream(folder / "secret.bin", std::ios::binary) << written.binary;
  }

  Result<Scene> withUri(const std::string& uri) {
    written.json["buffers"][0]["uri"] = uri;
    return importGltf(written.json.dump(), (folder / "scene").string(), "scene.gltf");
  }

  const test::TemporaryFolder temporary;
  const std::filesystem::path folder = temporary.path();
  Glb written;
};

TEST_F(GltfFiles, BuffersBesideTheSceneAreRead) {
  for (const char* uri :
       {"some data.bin", "some%20data.bin", "./some%20data.bin", "../scene/some%20data.bin"}) {
    const Result<Scene> scene = withUri(uri);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->objects.size(), 1u);
  }
}

TEST_F(GltfFiles, BuffersInTheTextAreRead) {
  Glb glb;
  // (0,0,0), (1,0,0), (0,1,0) as little-endian floats, by hand: 1.0 is 00 00 80 3f.
  glb.json["buffers"][0] = {
      {"byteLength", 36},
      {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}};
  glb.json["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 36}});
  glb.json["accessors"].push_back(
      {{"bufferView", 0}, {"componentType", test::kFloat}, {"count", 3}, {"type", "VEC3"}});
  glb.addNode({{"name", "n"}, {"mesh", glb.addMesh({Glb::primitive(0)})}});
  const Scene scene = imported("\xef\xbb\xbf" + glb.json.dump());
  ASSERT_EQ(scene.indices.size(), 3u);
  EXPECT_EQ(test::areaVector(scene, 0), Vec3d(0, 0, 1));
}

TEST_F(GltfFiles, PathsOutOfTheFolderAreRefused) {
  std::filesystem::create_symlink(folder / "secret.bin", folder / "scene" / "link.bin");
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("%2e%2e/secret.bin"), std::string("x/../../secret.bin"),
        (folder / "secret.bin").string(), "file://" + (folder / "secret.bin").string(),
        std::string("..\\secret.bin"), std::string("link.bin"), std::string("http://example.com/a.bin")}) {
    const Result<Scene> scene = withUri(uri);
    ASSERT_FALSE(scene) << uri;
    EXPECT_EQ(scene.error().message.find("scene.gltf: buffer 0: "), 0u) << scene.error().message;
    EXPECT_TRUE(scene.error().message.find("outside") != std::string::npos ||
                scene.error().message.find("not a path relative") != std::string::npos)
        << scene.error().message;
  }
}

TEST_F(GltfFiles, MissingAndShortBuffersAreNamed) {
  EXPECT_NE(withUri("none.bin").error().message.find("buffer 0: "), std::string::npos);
  EXPECT_NE(withUri("").error().message.find("malformed"), std::string::npos);
  EXPECT_NE(withUri("%00").error().message.find("malformed"), std::string::npos);
  EXPECT_NE(withUri(".").error().message.find("buffer 0: "), std::string::npos);
  std::ofstream(folder / "scene" / "short.bin", std::ios::binary) << "abc";
  EXPECT_EQ(withUri("short.bin").error().message, "scene.gltf: buffer 0: states 42 bytes, but has only 3");
}

}  // namespace
}  // namespace sightline
