#include "src/io/obj/obj.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sightline/io/import.h"
#include "src/io/obj/obj_libraries.h"
#include "tests/support/temporary_folder.h"

namespace sightline::io {
namespace {

namespace fs = std::filesystem;

// Four corners of a square, of which faces may be made.
const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class Obj : public testing::Test {
 protected:
  // What the text is read to, without a file of its own; .mtl files lie in the folder.
  Scene read(const std::string& text) {
    findings_ = {};
    Result<Scene> scene = importObj(text, folder_.path().string(), "a.obj", limits_, findings_);
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? std::move(*scene) : Scene();
  }
  std::string errorOf(const std::string& text) {
    findings_ = {};
    const Result<Scene> scene = importObj(text, folder_.path().string(), "a.obj", limits_, findings_);
    EXPECT_FALSE(scene) << text;
    const std::string error = scene ? "" : scene.error().message;
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  }
  // Returns the material of the only object.
  Material materialOf(const std::string& text) {
    const Scene scene = read(text);
    EXPECT_EQ(scene.objects.size(), 1u) << text;
    return scene.objects.empty() ? Material() : scene.materials.at(scene.objects[0].material.value);
  }
  // Returns the material of a face whose .mtl file has these statements.
  Material materialIn(const std::string& statements) {
    folder_.write("a.mtl", "newmtl m\n" + statements + "\n");
    return materialOf("mtllib a.mtl\n" + kSquare + "usemtl m\nf 1 2 3\n");
  }

  const test::TemporaryFolder folder_;
  ImportLimits limits_;
  ObjFindings findings_;
};

Box boundsOf(const Scene& scene) {
  return sceneBounds(scene.view());
}

TEST_F(Obj, VerticesAreReadInAllForms) {
  for (const std::string form : {"v {} {} {}", "  v {} {} {}", "v\t{}  {} {} ", "v {} {} {} 1",
                                 "v {} {} {} 255 0 0", "v {} {} {} .5 .5 .5 1", "v {} {} {} 1.0 1 0 0 1",
                                 "v {} {} {} #b 2", "v {} {} {}#b", "v {} \\\n{} {}", "v {} {} {}\r"}) {
    std::string text = "\xef\xbb\xbf# a comment\r\n";
    for (const auto& [x, y, z] :
         {std::array{"-.5", "-5e-1", "+.25"}, {"2.", "0", "-3E+0"}, {"0", "1e-400", "4"}}) {
      text += fmt::format(fmt::runtime(form), x, y, z) + "\n";
    }
    EXPECT_EQ(boundsOf(read(text + "f 1 2 3")), (Box{{-0.5, -0.5, -3}, {2, 0, 4}})) << form;
  }
}

TEST_F(Obj, FacesAreReadInAllForms) {
  for (const std::string face :
       {"f 1 2 3", "\tf 1/9 2/9 3/9", "f 1//9 2//-1 3//9 # a comment", "f 1/1/1 2/2/2 3/3/3", "f -4 -3 -2",
        "f 1 \\\r\n 2 3", "f 1 \\\n\\\n2 3 \\", "fo 1 2 3", "f 1 2 3\rp 1"}) {
    const Scene scene = read(kSquare + face);
    EXPECT_EQ(scene.indices, (std::vector<std::uint32_t>{0, 1, 2})) << face;
    EXPECT_EQ(boundsOf(scene), (Box{{0, 0, 0}, {1, 1, 0}})) << face;
  }
  // Vertices may follow. What has less than three corners is no triangle, and curves and surfaces are not
  // read.
  EXPECT_EQ(read("f 1 2 3\n" + kSquare).triangleCount(), 1u);
  EXPECT_TRUE(read(kSquare + "f 1 2\nl 1 2 3\np 1\nvt 0 0\nvn 0 0 1\ns off\nunknown 1\n"
                             "cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nsurf 0 1 0 1 1 2 3 4\nend\n")
                  .objects.empty());
}

TEST_F(Obj, EndsOfLinesMayBeOfAnyKind) {
  for (const std::string end : {"\n", "\r\n", "\r", "\n\r"}) {
    std::string text;
    for (const char c : kSquare + "f 1 2 3\nf 1 2 9\n") {
      text += c == '\n' ? end : std::string(1, c);
    }
    const std::string line = end == "\n\r" ? "11" : "6";
    EXPECT_EQ(errorOf(text), "a.obj: line " + line + ": the face has the vertex 9, and the file has 4");
  }
}

TEST_F(Obj, PolygonsAreCoveredByTheirTrianglesAlone) {
  const Scene scene = read("v 0 0 -5\nv 2 0 -5\nv 2 1 -5\nv 1 1 -5\nv 1 2 -5\nv 0 2 -5\nf 1 2 3 4 5 6\n");
  double area = 0.0;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const Vec3d a(scene.positions[scene.indices[i]]), b(scene.positions[scene.indices[i + 1]]);
    const double own = 0.5 * cross(b - a, Vec3d(scene.positions[scene.indices[i + 2]]) - a).z;
    EXPECT_GT(own, 0.0);
    area += own;
  }
  EXPECT_EQ(area, 3.0);
  EXPECT_EQ(scene.objects.at(0).mark, OccluderMark::kAutomatic);
  // What covers too much is set apart.
  const Scene crossing = read("v 9 0 0\n" + kSquare + "usemtl x\nf 2 4 3 5\nf 2 3 4\no next\nf 2 3 1\n");
  ASSERT_EQ(crossing.objects.size(), 3u);
  EXPECT_EQ(crossing.objects[0].mark, OccluderMark::kAutomatic);
  EXPECT_EQ(crossing.objects[0].triangleCount(), 1u);
  EXPECT_EQ(crossing.object_names[1], crossing.object_names[0] + "/uncertain");
  EXPECT_EQ(crossing.objects[1].mark, OccluderMark::kNever);
  EXPECT_EQ(crossing.objects[1].bounds, (Box{{0, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(crossing.objects[1].material, crossing.objects[0].material);
  EXPECT_EQ(crossing.object_names[2], "next");
  EXPECT_EQ(crossing.objects[2].mark, OccluderMark::kAutomatic);
  EXPECT_EQ(findings_.uncertain_polygons, 1u);
}

TEST_F(Obj, LargeCoordinatesKeepMillimetres) {
  // Two panels with a gap of 30 mm between them.
  const Scene scene = read(
      "v 689012.000 5339000 0\nv 689012.300 5339000 0\nv 689012.300 5339001 0\nv 689012.330 5339000 0\n"
      "v 689013.000 5339000 0\nv 689013.000 5339001 0\no a\nf 1 2 3\no b\nf 4 5 6\n");
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_NEAR(scene.objects[1].bounds.min.x - scene.objects[0].bounds.max.x, 0.030, 1e-4);
  EXPECT_NEAR(scene.origin.x + scene.objects[0].bounds.max.x, 689012.3, 1e-4);
}

TEST_F(Obj, ObjectsAreThoseOfObjectsGroupsAndMaterials) {
  folder_.write("a.mtl", "newmtl m\nnewmtl n\n");
  const Scene scene = read("mtllib a.mtl\n" + kSquare +
                           "f 1 2 3\nusemtl m\nf 1 2 3\n"                    // no object yet
                           "o empty\no one # a comment\nf 1 2 3\nf 1 3 4\n"  // keeps the material
                           "usemtl n\nf 1 2 3\nusemtl n\nf 1 3 4\nusemtl m\nf 1 2 3\n"
                           "g left\nl 1 2\ng right wall\nf 1 2 3\ng right wall\nf 1 3 4\n"
                           "o Box#2\ng right wall\nf 1 2 3\no Box#2\nf 1 3 4\ng\nf 1 2 3\n");
  const std::vector<std::string> names{"defaultobject/primitive0",
                                       "defaultobject/primitive1",
                                       "one/primitive0",
                                       "one/primitive1",
                                       "one/primitive2",
                                       "right wall",
                                       "Box#2",
                                       "default"};
  EXPECT_EQ(scene.object_names, names);
  std::vector<std::string> materials;
  std::vector<std::uint32_t> triangles;
  for (const Object& object : scene.objects) {
    materials.push_back(scene.materials.at(object.material.value).name);
    triangles.push_back(object.triangleCount());
  }
  EXPECT_EQ(materials, (std::vector<std::string>{"default", "m", "m", "n", "m", "m", "m", "m"}));
  EXPECT_EQ(triangles, (std::vector<std::uint32_t>{1, 1, 2, 2, 1, 2, 2, 1}));
  EXPECT_EQ(scene.positions.size(), 4u);
}

TEST_F(Obj, MaterialsThatLetLightThroughHideNothing) {
  for (const char* glass : {"d 0.5",
                            "d -halo 0.5",
                            "Tr 0.2",
                            "tr .2",
                            "D 0",
                            " d\t0.5 # half",
                            "Tf 0.1 0.1 0.1",
                            "Tf 1 1 0.9",
                            "Tf 0",
                            "illum 6",
                            "illum 7\nd 1",
                            "illum 9 # glass",
                            "# from C:\\scenes\\\nd 0.5",
                            "map_Kd ..\\textures\\\nd 0.5",
                            "Tf xyz 0.5 0.5 0.5",
                            "Tf spectral glass.rfl 1",
                            "d 0.5\nd 1",
                            "Tr 0.5\nd 1",
                            "d 1\nTr 1",
                            "map_d a.png\nd 0.5",
                            "d 0.5\nmap_d a.png",
                            "d 0.5\nnewmtl other\nnewmtl m\nd 1"}) {
    EXPECT_EQ(materialIn(glass).opacity, Opacity::kBlended) << glass;
  }
  for (const char* leaf : {"map_d a.png", "map_Tr a.png", "map_opacity -s 1 1 1 a.png", "MAP_D a.png\nd 1"}) {
    EXPECT_EQ(materialIn(leaf).opacity, Opacity::kAlphaTested) << leaf;
  }
  for (const char* wall : {"", "d 1", "d 1.0\nTr 0", "Tf 1 1 1", "Tf 1", "d -halo 1", "aniso 0.5", "illum 2",
                           "illum 4", "decal a.png", "map_Kd a.png", "Ks 0 0 0", "newmtl other\nd 0.5"}) {
    EXPECT_EQ(materialIn(wall).opacity, Opacity::kOpaque) << wall;
  }
  const Material material = materialIn("Kd 0.5 0.25 2\nd 0.5");
  EXPECT_EQ(material.base_color, (std::array<float, 4>{0.5f, 0.25f, 1.0f, 0.5f}));
  EXPECT_EQ(materialIn("Kd 0.5").base_color, (std::array<float, 4>{0.5f, 0.5f, 0.5f, 1.0f}));
  EXPECT_EQ(materialIn("Kd spectral a.rfl").opacity, Opacity::kOpaque);
  EXPECT_FALSE(material.double_sided);
}

TEST_F(Obj, NothingGetsTheMaterialOfWhatCameBefore) {
  folder_.write("a.mtl", "newmtl wall\nnewmtl glass\nd 0.5\nnewmtl\nd 0.5\n");
  const std::string begin = "mtllib a.mtl\n" + kSquare + "usemtl wall\n";
  for (const char* glass : {"usemtl glass", "USEMTL glass", "# C:\\\nusemtl glass", "usemtl"}) {
    EXPECT_EQ(materialOf(begin + glass + "\nf 1 2 3\n").opacity, Opacity::kBlended) << glass;
  }
}

TEST_F(Obj, FacesOfVerticesThatMayBeSeeThroughHideNothing) {
  for (const char* form : {"v 0 0 0 1 0.5 0.5 0.5 {}", "v 0 0 0 0.5 0.5 0.5 {}"}) {
    for (const char* alpha : {"1", "0.9"}) {
      const Scene scene = read("v 1 0 0\nv 1 1 0\nv 0 1 0\n" + fmt::format(fmt::runtime(form), alpha) +
                               "\nf 1 2 3\nf 4 1 2\n");
      const bool apart = alpha[0] == '0';
      ASSERT_EQ(scene.objects.size(), apart ? 2u : 1u) << form;
      EXPECT_EQ(scene.objects[0].mark, OccluderMark::kAutomatic);
      EXPECT_EQ(scene.objects.back().mark, apart ? OccluderMark::kNever : OccluderMark::kAutomatic) << form;
      EXPECT_EQ(findings_.uncertain_polygons, 0u);
    }
  }
}

TEST_F(Obj, NumbersThatMaterialsNeedAreMissed) {
  for (const char* bad : {"d", "d half", "Tr", "Tf", "Tf 1 x 1", "d nan"}) {
    folder_.write("a.mtl", std::string("newmtl m\n") + bad + "\n");
    const std::string error = errorOf("mtllib a.mtl\n" + kSquare + "f 1 2 3\n");
    EXPECT_EQ(error.find(folder_.file("a.mtl") + ": line 2: \"" + bad), 0u) << error;
  }
}

TEST_F(Obj, MaterialsAreFoundHoweverTheyAreNamed) {
  folder_.write("a.mtl", "newmtl wall\nnewmtl Wall #25\nnewmtl stone # grey\n");
  folder_.write("b c.mtl", "newmtl brick\n");
  fs::create_directories(folder_.path() / "sub");
  folder_.write("sub/d.mtl", "newmtl wood\n");
  const std::string faces = "f 1 2 3\n";
  for (const std::string statements :
       {"mtllib a.mtl\nusemtl wall\n", "mtllib a.mtl\nusemtl wall # a comment\n",
        "mtllib a.mtl\r\n  usemtl wall \r\n", "mtllib a.mtl\nusemtl Wall #25\n",
        "mtllib a.mtl\nusemtl stone\n", "mtllib a.mtl # all\nusemtl stone # grey\n",
        "mtllib none.mtl a.mtl\nusemtl wall\n", "mtllib b c.mtl a.mtl\nusemtl wall\n",
        "mtllib a.mtl b c.mtl\nusemtl brick\n", "mtllib b c.mtl\nusemtl brick\n",
        "mtllib \"b c.mtl\"\nusemtl brick\n", "mtllib \"a.mtl\" \"b c.mtl\"\nusemtl brick\n",
        "mtllib sub\\d.mtl\nusemtl wood\n", "mtllib ./sub/../a.mtl\nusemtl wall\n"}) {
    EXPECT_EQ(materialOf(statements + kSquare + faces).opacity, Opacity::kOpaque) << statements;
    EXPECT_EQ(findings_.faces_without_material, 0u) << statements;
  }
  // After its use.
  EXPECT_EQ(materialOf("usemtl wall\n" + kSquare + faces + "mtllib a.mtl\n").opacity, Opacity::kOpaque);
}

TEST_F(Obj, MaterialsThatAreNotDefinedHideNothingAndAreNoted) {
  folder_.write("a.mtl", "newmtl wall\nnewmtl Glas #1\nnewmtl Glas #2\n");
  for (const std::string statements :
       {"usemtl wall\n", "mtllib A.mtl\nusemtl wall\n", "mtllib a.mtl\nusemtl Wall\n",
        "mtllib a.mtl\nusemtl Glas\n", "mtllib a.mtl\nusemtl Glas #3\n", "mtllib .\nusemtl wall\n",
        "mtllib /dev/zero\nusemtl wall\n"}) {
    EXPECT_EQ(materialOf(statements + kSquare + "f 1 2 3\nf 1 3 4\n").opacity, Opacity::kBlended)
        << statements;
    EXPECT_EQ(findings_.faces_without_material, 2u) << statements;
    EXPECT_EQ(findings_.missing_materials.size(), 1u) << statements;
  }
  // Faces without any material are no glass.
  EXPECT_EQ(materialOf(kSquare + "f 1 2 3\n").opacity, Opacity::kOpaque);
  EXPECT_EQ(materialOf(kSquare + "usemtl\nf 1 2 3\n").opacity, Opacity::kOpaque);

  const std::string file = folder_.write(
      "x.obj", "mtllib none.mtl a.mtl\n" + kSquare +
                   "usemtl m1\nf 1 2 3\nusemtl m2\nf 1 2 3\nusemtl wall\nf 1 2 3\nusemtl m1\nf 1 2 3\n");
  const Result<Scene> scene = importScene(file);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->notes.size(), 1u);
  EXPECT_EQ(scene->notes[0],
            "3 faces have a material that no .mtl file defines (\"m1\" and \"m2\"); it may be glass, so they "
            "hide nothing; put \"none.mtl\" beside the file, or define them");
}

TEST_F(Obj, BadStatementsAreNamedWithTheirLine) {
  const std::vector<std::array<std::string, 2>> bad{
      {"v 0 0", "line 5: a vertex has 2 numbers; give x, y and z"},
      {"v 0 0 x", "line 5: \"x\" is not a number"},
      {"v 0 0 0x10", "line 5: \"0x10\" is not a number"},
      {"v 1 2 3 4 5 6 7 8 9", "line 5: a vertex has more than 8 numbers; give x, y and z"},
      {"v 0 0 nan", "line 5: a coordinate is not finite or exceeds single precision"},
      {"v 0 0 1e39", "line 5: a coordinate is not finite or exceeds single precision"},
      {"v 0 0 1e999", "line 5: a coordinate is not finite or exceeds single precision"},
      {"f 1 2 x", "line 5: \"x\" is not a corner of a face; give v, v/vt, v//vn or v/vt/vn"},
      {"f 1 2 3.5", "line 5: \"3.5\" is not a corner of a face; give v, v/vt, v//vn or v/vt/vn"},
      {"f 1 2 99999999999999999999",
       "line 5: \"99999999999999999999\" is not a corner of a face; give v, v/vt, "
       "v//vn or v/vt/vn"},
      {"f 1 2 0", "line 5: the face has the vertex 0, and 4 are there so far"},
      {"f 1 2 -5", "line 5: the face has the vertex -5, and 4 are there so far"},
      {"f 1 2 1000000000", "line 5: the face has the vertex 1000000000, and the file has 4"},
      {"f 1 2 9223372036854775807",
       "line 5: the face has the vertex 9223372036854775807; at most 4294967280 are read"},
      {"v 0 0 0 2\n\nf 1 2 5",
       "line 5: the vertex has a weight other than 1, which means nothing to the face in line 7; leave the "
       "weight "
       "out"}};
  for (const auto& [text, error] : bad) {
    EXPECT_EQ(errorOf(kSquare + text + "\n"), "a.obj: " + error);
  }
  // No face has it.
  EXPECT_EQ(read(kSquare + "v 9 9 9 0.5\nf 1 2 3\n").triangleCount(), 1u);
}

TEST_F(Obj, WhatExceedsTheLimitsIsRefused) {
  const std::string text = kSquare + "o a\nf 1 2 3\no b\nf 1 2 3 4\n";
  limits_ = {.triangles = 3, .objects = 2};
  EXPECT_EQ(read(text).triangleCount(), 3u);
  limits_ = {.triangles = 2};
  EXPECT_EQ(errorOf(text), "a.obj: line 8: with the 2 triangles of \"b\" the scene exceeds 2 triangles");
  limits_ = {.objects = 1};
  EXPECT_EQ(errorOf(text), "a.obj: line 8: the scene exceeds 1 objects");
  limits_ = {.name_bytes = 1};
  EXPECT_EQ(errorOf(text), "a.obj: line 8: the names of objects have more than 1 bytes");
}

TEST_F(Obj, FilesThatAreCutOffAreReadOrRefusedWithOneLine) {
  folder_.write("a.mtl", "newmtl m\nd 0.5\n");
  const std::string whole =
      "mtllib a.mtl\n" + kSquare + "o a\nusemtl m\nf 1/1/1 2/2/2 \\\n3//3 -1\ng b\nf -4 -3 -2\n";
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Result<Scene> scene =
        importObj(whole.substr(0, size), folder_.path().string(), "a.obj", limits_, findings_);
    if (!scene) {
      EXPECT_EQ(scene.error().message.find("a.obj: line "), 0u) << scene.error().message;
    }
  }
}

// One that names itself, and others that make readers look for much.
// Quadratic in its lines or names, this would not end while anyone waits.
TEST_F(Obj, AFileMadeToTakeLongIsRefusedWithOneLine) {
  std::string text = "mtllib self.obj\nmtllib self.obj ./self.obj self.obj\nusemtl m\n" + kSquare;
  for (int i = 0; i < 50'000; ++i) {
    text += fmt::format("o object{}\nusemtl material{}\nf 1 2 3 4\nmtllib {} {}\n", i, i, i, i + 1);
  }
  text += "v \\\n" + std::string(200'000, '\\') + "\n1 2 3\n";
  for (int i = 0; i < 100'000; ++i) {
    text += "\\\r";
  }
  const std::string file = folder_.write("self.obj", text);
  const Result<Scene> scene = importScene(file);
  EXPECT_EQ(filesNamedByObj(text, folder_.path().string()), std::vector<std::string>{file});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("is not a number"), std::string::npos) << scene.error().message;
  EXPECT_LT(scene.error().message.size(), 300u);
}

TEST_F(Obj, NamesTheFilesThatItIsMadeOf) {
  const std::string library =
      folder_.write("a b.mtl", "newmtl m\nmap_Kd -s 1 1 1 red brick.png\nbump x.png\nKd 1 1 1\n");
  const std::vector<std::string> files =
      filesNamedByObj("mtllib a b.mtl\nmtllib none.mtl\n", folder_.path().string());
  const auto has = [&](const std::string& name) {
    return std::find(files.begin(), files.end(), folder_.file(name)) != files.end();
  };
  EXPECT_TRUE(has("a b.mtl"));
  EXPECT_TRUE(has("brick.png"));
  EXPECT_TRUE(has("x.png"));
  EXPECT_FALSE(has("none.mtl"));
}

}  // namespace
}  // namespace sightline::io
