#include "sightline/io/file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "sightline/io/image.h"
#include "sightline/io/import.h"
#include "src/io/assimp.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder.file(name); }

  const test::TemporaryFolder folder;
};

TEST_F(Files, BytesComeBackAsTheyWereWritten) {
  std::string bytes;
  for (int i = 0; i < 1000; ++i) {
    bytes.push_back(static_cast<char>(i));
  }
  ASSERT_TRUE(writeFile(path("a.bin"), bytes));
  EXPECT_EQ(readFile(path("a.bin")).value(), bytes);
  ASSERT_TRUE(writeFile(path("a.bin"), "short"));
  EXPECT_EQ(readFile(path("a.bin")).value(), "short") << "an older file is replaced, not overwritten in part";
  EXPECT_EQ(folder.entries(), 1u) << "nothing is left over";
}

TEST_F(Files, WhatCannotBeReadIsNamedWithTheReason) {
  EXPECT_EQ(readFile(path("none")).error().message, path("none") + ": no such file");
  EXPECT_EQ(readFile(folder.path().string()).error().message,
            folder.path().string() + ": is a directory, not a file");
  EXPECT_EQ(readFile("/dev/null").error().message, "/dev/null: is not a regular file");
}

TEST_F(Files, WhatCannotBeWrittenIsNamedAndLeavesNothing) {
  EXPECT_EQ(
      writeFile(path("no/such/folder"), "x").error().message.find(path("no/such/folder") + ": cannot be"),
      0u);
  fs::create_directories(folder.path() / "taken" / "by a folder");
  EXPECT_FALSE(writeFile(path("taken"), "x"));
  EXPECT_EQ(folder.entries(), 1u);
}

TEST_F(Files, WhatLiesWhereAFileIsPreparedIsNotOverwritten) {
  const std::string victim = folder.write("victim", "precious");
  for (const char* form : {"{}.{}.unfinished", "{}.{}.0.unfinished"}) {
    fs::create_symlink(victim, fmt::format(fmt::runtime(form), path("a.bin"), ::getpid()));
  }
  ASSERT_TRUE(writeFile(path("a.bin"), "new"));
  EXPECT_EQ(readFile(path("a.bin")).value(), "new");
  EXPECT_EQ(readFile(victim).value(), "precious");
  EXPECT_FALSE(fs::is_symlink(path("a.bin")));
  EXPECT_EQ(folder.entries(), 4u) << "the links stay, and nothing else is left over";
}

TEST_F(Files, WhatManyInterruptedRunsLeftDoesNotStopAnother) {
  for (int i = 0; i < 150; ++i) {
    folder.write(fmt::format("a.bin.{}.{}.unfinished", ::getpid(), i), "left over");
  }
  ASSERT_TRUE(writeFile(path("a.bin"), "new"));
  EXPECT_EQ(readFile(path("a.bin")).value(), "new");
  EXPECT_EQ(folder.entries(), 151u);
}

TEST_F(Files, NamesMayBeAsLongAsTheFileSystemAllows) {
  const std::string longest(255, 'n');
  ASSERT_TRUE(writeFile(path(longest), "x"));
  EXPECT_EQ(readFile(path(longest)).value(), "x");
  EXPECT_NE(writeFile(path(longest + "n"), "x").error().message.find("File name too long"),
            std::string::npos);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST_F(Files, PicturesAreWrittenAsPng) {
  const Image image{2, 1, {255, 0, 0, 255, 0, 255, 0, 128}};
  ASSERT_TRUE(writePng(image, path("a.png")));
  const std::string bytes = readFile(path("a.png")).value();
  ASSERT_GT(bytes.size(), 33u);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(12, 4), "IHDR");
  // Width and height, big-endian; 8 bits; colour type 6 is RGBA.
  EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\2\0\0\0\1\x08\x06", 10));
  EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND");
}

TEST_F(Files, PicturesOfTheWrongSizeAreRefused) {
  EXPECT_FALSE(writePng(Image{2, 2, std::vector<std::uint8_t>(15)}, path("a.png")));
  EXPECT_FALSE(writePng(Image{}, path("a.png")));
  EXPECT_FALSE(fs::exists(path("a.png")));
}

TEST_F(Files, ScenesOfUnknownKindAreRefused) {
  EXPECT_NE(importScene(folder.write("a.xyzzy", "x"))
                .error()
                .message.find("files ending in \".xyzzy\" are not read"),
            std::string::npos);
  EXPECT_NE(importScene(folder.write("noextension", "x")).error().message.find("are not read"),
            std::string::npos);
  EXPECT_EQ(importScene(path("none.obj")).error().message, path("none.obj") + ": no such file");
  fs::create_directories(path("folder.glb"));
  EXPECT_EQ(importScene(path("folder.glb")).error().message,
            path("folder.glb") + ": is a directory, not a file");
  for (const char* name : {"empty.glb", "empty.gltf", "empty.obj", "empty.stl"}) {
    EXPECT_EQ(importScene(folder.write(name, "")).error().message, path(name) + ": the file is empty");
  }
}

TEST_F(Files, AGlbThatIsNeitherBinaryGltfNorJsonIsSaidToBeNone) {
  for (const char* bytes : {"PK\3\4", "gltf", " ", "\xff\xfe{"}) {
    EXPECT_EQ(importScene(folder.write("a.glb", bytes)).error().message,
              path("a.glb") + ": is not a binary glTF: it does not begin with 'glTF'");
  }
  for (const char* bytes : {"{}", "\xef\xbb\xbf {}", "glTF"}) {
    const std::string message = importScene(folder.write("A.GLB", bytes)).error().message;
    EXPECT_EQ(message.find("is not a binary glTF"), std::string::npos) << message;
  }
  EXPECT_NE(importScene(folder.write("a.gltf", "PK")).error().message.find("is not valid JSON"),
            std::string::npos);
}

constexpr const char* kObj =
    "mtllib a.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\n"
    "o quad\nusemtl glass\nf 1 2 3 4\n"
    "o triangle\nusemtl wall\nf 1 2 5\n";
constexpr const char* kMtl = "newmtl wall\nKd 0.5 0.25 1\nnewmtl glass\nd 0.5\n";

TEST_F(Files, ObjIsReadWithItsMaterials) {
  folder.write("a.mtl", kMtl);
  const Result<Scene> scene = importScene(folder.write("a.obj", kObj));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 2u);
  EXPECT_EQ(scene->object_names[0], "quad");
  EXPECT_EQ(scene->object_names[1], "triangle");
  EXPECT_EQ(scene->objects[0].triangleCount(), 2u);
  EXPECT_EQ(scene->objects[1].triangleCount(), 1u);
  EXPECT_EQ(scene->positions.size(), 5u);
  const SceneView view = scene->view();
  EXPECT_EQ(view.materialOf(view.objects[0]).opacity, Opacity::kBlended);
  EXPECT_EQ(view.materialOf(view.objects[1]).opacity, Opacity::kOpaque);
  EXPECT_EQ(view.materialOf(view.objects[1]).name, "wall");
  EXPECT_EQ(view.objects[1].bounds, (Box{{0, 0, 0}, {1, 0, 5}}));
}

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n2 0 0\n2 3 0\n0 3 0\n4 0 1 2 3\n";

// A triangle in a node that is turned below one of the given scale.
std::string flattenedDae(const char* scale) {
  return fmt::format(R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="turned"><rotate>1 2 3 40</rotate>
<node id="flat"><scale>{}</scale><node id="n"><rotate>3 1 2 70</rotate><instance_geometry url="#g"/></node>
</node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)",
                     scale);
}

TEST_F(Files, WhatATransformFlattensHidesNothing) {
  for (const auto& [scale, mark] :
       {std::pair("1 1 0", OccluderMark::kNever), std::pair("1 1 0.001", OccluderMark::kAutomatic),
        std::pair("1 1 -1", OccluderMark::kAutomatic)}) {
    const Result<Scene> scene = importScene(folder.write("flat.dae", flattenedDae(scale)));
    ASSERT_TRUE(scene) << scene.error().message;
    ASSERT_EQ(scene->objects.size(), 1u);
    EXPECT_EQ(scene->objects[0].mark, mark) << scale;
  }
}

// What stands below a node that moves moves with it.
TEST_F(Files, WhatAnAnimationOfAnotherFormatMovesHidesNothing) {
  std::string moving = flattenedDae("1 1 1");
  moving.replace(moving.find("<scale>"), 7, "<scale sid=\"k\">");
  const auto source = [](const std::string& id, const std::string& name, const std::string& values) {
    return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"2\">" + values +
           "</float_array><technique_common><accessor source=\"#" + id + "a\" count=\"2\"><param name=\"" +
           name + "\" type=\"float\"/></accessor></technique_common></source>";
  };
  moving.insert(moving.find("<library_visual_scenes>"),
                "<library_animations><animation id=\"a\">" + source("i", "TIME", "0 1") +
                    source("o", "X", "1 9") +
                    "<sampler id=\"m\"><input semantic=\"INPUT\" source=\"#i\"/><input semantic=\"OUTPUT\" "
                    "source=\"#o\"/></sampler><channel source=\"#m\" target=\"flat/k.X\"/></animation>"
                    "</library_animations>");
  const Result<Scene> scene = importScene(folder.write("moving.dae", moving));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].mark, OccluderMark::kNever);
  ASSERT_EQ(scene->notes.size(), 1u);
  EXPECT_EQ(scene->notes[0].find("objects that move, by animations, bones or morph targets: 1."), 0u)
      << scene->notes[0];
  const Result<Scene> still = importScene(folder.write("still.dae", flattenedDae("1 1 1")));
  ASSERT_TRUE(still) << still.error().message;
  EXPECT_EQ(still->objects[0].mark, OccluderMark::kAutomatic);
  EXPECT_TRUE(still->notes.empty());
}

TEST_F(Files, PlyIsReadInTriangles) {
  const Result<Scene> scene = importScene(folder.write("a.PLY", kPly));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].triangleCount(), 2u);
  EXPECT_EQ(scene->objects[0].bounds, (Box{{0, 0, 0}, {2, 3, 0}}));
}

// A .ply has no materials, so it is glass if any of its vertices or faces may be.
TEST_F(Files, PlyWithAlphaIsSeeThrough) {
  const auto opacityWith = [this](const std::string& of_vertex, const std::string& of_face,
                                  const std::string& last_vertex, const std::string& face) {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
        of_vertex + "element face 1\nproperty list uchar int vertex_indices\n" + of_face +
        "end_header\n0 0 0 9 9 9 255\n2 0 0 9 9 9 255\n2 3 0 9 9 9 " + last_vertex + "\n3 0 1 2" + face +
        "\n";
    const Result<Scene> scene = importScene(folder.write("a.ply", ply));
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? scene->view().materialOf(scene->objects[0]).opacity : Opacity::kOpaque;
  };
  const std::string colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string alpha = "property uchar alpha\n", other = "property uchar quality\n";
  EXPECT_EQ(opacityWith(colour + alpha, "", "255", ""), Opacity::kOpaque);
  EXPECT_EQ(opacityWith(colour + alpha, "", "254", ""), Opacity::kBlended);
  EXPECT_EQ(opacityWith(colour + other, "", "60", ""), Opacity::kOpaque);
  EXPECT_EQ(opacityWith(colour + alpha, other, "255", " 60"), Opacity::kOpaque);
  EXPECT_EQ(opacityWith(colour + alpha, alpha, "255", " 60"), Opacity::kBlended);
}

// Assimp would hand over only the last triangle of a strip, and its box would not hold what is shown.
TEST_F(Files, PlyWithStripsIsRefused) {
  const Result<Scene> scene = importScene(folder.write(
      "strip.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n2 0 0\n0 3 0\n2 3 0\n4 0 1 2 3\n"));
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("tristrips"), std::string::npos) << scene.error().message;
}

TEST_F(Files, PlyThatIsCutOffIsRefused) {
  const std::string whole = kPly;
  const std::size_t last_line = whole.find("4 0 1 2 3");
  for (std::size_t size = 1; size <= last_line; ++size) {
    EXPECT_FALSE(importScene(folder.write("cut.ply", whole.substr(0, size))))
        << "cut after " << size << " bytes";
  }
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::int32_t indices[3] = {0, 1, 2};
  binary.append(reinterpret_cast<const char*>(corners), 36);
  const std::size_t before_face = binary.size();
  binary.push_back(3);
  binary.append(reinterpret_cast<const char*>(indices), 12);
  const Result<Scene> scene = importScene(folder.write("whole.ply", binary));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->triangleCount(), 1u);
  for (std::size_t size = 1; size <= before_face; ++size) {
    EXPECT_FALSE(importScene(folder.write("cut.ply", binary.substr(0, size))))
        << "cut after " << size << " bytes";
  }
}

std::string binaryStl(const std::vector<float>& corners) {
  std::string bytes(80, ' ');
  const auto triangles = static_cast<std::uint32_t>(corners.size() / 9);
  bytes.append(reinterpret_cast<const char*>(&triangles), 4);
  for (std::size_t i = 0; i < triangles; ++i) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(&corners[9 * i]), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(Files, StlIsReadAndWelded) {
  const Result<Scene> scene =
      importScene(folder.write("a.stl", binaryStl({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].triangleCount(), 2u);
  EXPECT_EQ(scene->positions.size(), 4u);
}

TEST_F(Files, NumbersThatAreNotFiniteAreRefused) {
  const float nan = std::nanf("");
  const Result<Scene> stl = importScene(folder.write("a.stl", binaryStl({0, 0, 0, 1, 0, 0, 0, nan, 0})));
  ASSERT_FALSE(stl);
  EXPECT_EQ(stl.error().message.find(path("a.stl") + ": "), 0u) << stl.error().message;
}

TEST_F(Files, BrokenFilesOfOtherKindsGiveOneLine) {
  const std::string stl = binaryStl({0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (const std::string& file :
       {folder.write("cut.stl", stl.substr(0, 100)), folder.write("index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
        folder.write("noise.fbx", "nothing of the kind")}) {
    const Result<Scene> scene = importScene(file);
    if (scene) {
      EXPECT_TRUE(scene->objects.empty()) << file << " has no whole triangle";
      continue;
    }
    EXPECT_EQ(scene.error().message.find(file + ": "), 0u) << scene.error().message;
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
  }
}

TEST_F(Files, WhatExceedsTheLimitsIsRefused) {
  folder.write("a.mtl", kMtl);
  const std::string file = folder.write("a.obj", kObj);  // two objects of three triangles
  io::AssimpFindings findings;
  EXPECT_TRUE(io::importAssimp(file, {.triangles = 3, .objects = 2}, findings));
  EXPECT_NE(io::importAssimp(file, {.triangles = 2}, findings).error().message.find("exceeds 2 triangles"),
            std::string::npos);
  EXPECT_NE(io::importAssimp(file, {.objects = 1}, findings).error().message.find("exceeds 1 objects"),
            std::string::npos);
}

// It announces more than the process that reads it may take, which must not be the end of this one.
TEST_F(Files, WhatBringsAssimpDownIsOneError) {
  const std::string file = folder.write("a.off", "OFF\n200000000 1 0\n0 0 0\n");
  const Result<Scene> scene = importScene(file);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().message.find(file + ": could not be read: "), 0u) << scene.error().message;
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace sightline
