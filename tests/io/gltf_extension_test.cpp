// Extensions that change what is seen through and what is shown where, and transforms that flatten.

#include <gtest/gtest.h>

#include <cmath>

#include "src/io/corner_order.h"
#include "src/io/gltf/gltf.h"
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

TEST(GltfExtension, WhatLetsLightThroughIsNotOpaque) {
  const auto opacityWith = [](const json& material) {
    Glb glb = oneTriangle();
    glb.json["materials"] = {material};
    return imported(glb.bytes()).materials[0].opacity;
  };
  const auto opacityOf = [&](const char* extension, const json& value) {
    return opacityWith({{"extensions", {{extension, value}}}});
  };
  constexpr Opacity kOpaque = Opacity::kOpaque, kBlended = Opacity::kBlended;
  EXPECT_EQ(opacityOf("KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.5}}), kBlended);
  EXPECT_EQ(opacityOf("KHR_materials_diffuse_transmission", json::object()), kOpaque) << "its default is 0";
  EXPECT_EQ(opacityOf("ADOBE_materials_thin_transparency", {{"transmissionFactor", 0.5}}), kBlended);
  EXPECT_EQ(opacityOf("ADOBE_materials_thin_transparency", json::object()), kBlended) << "its default is 1";
  EXPECT_EQ(opacityOf("ADOBE_materials_thin_transparency", {{"transmissionFactor", 0}}), kOpaque);
  EXPECT_EQ(opacityOf("KHR_materials_volume", {{"thicknessFactor", 1}}), kOpaque)
      << "it says what light meets that another extension lets through";
  EXPECT_EQ(opacityOf("MSFT_lod", {{"ids", {0}}}), kBlended) << "a coarser one may be glass";
  const json glossy = {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {1, 1, 1, 0.25}}}}};
  EXPECT_EQ(opacityWith({{"extensions", glossy}}), kOpaque) << "alpha counts only in mode BLEND";
  EXPECT_EQ(opacityWith({{"extensions", glossy}, {"alphaMode", "BLEND"}}), kBlended);
}

TEST(GltfExtension, TransmissionThatAnAnimationTurnsOnCounts) {
  for (const auto& [pointer, opacity] :
       {std::pair("/materials/0/extensions/KHR_materials_transmission/transmissionFactor", Opacity::kBlended),
        std::pair("/materials/0/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor",
                  Opacity::kBlended),
        std::pair("/materials/0/pbrMetallicRoughness/baseColorFactor", Opacity::kOpaque)}) {
    Glb glb = oneTriangle();
    glb.json["materials"] = {json::object()};
    const json target = {{"path", "pointer"},
                         {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
    glb.json["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", target}}}}, {"samplers", json::array()}}};
    EXPECT_EQ(imported(glb.bytes()).materials[0].opacity, opacity) << pointer;
  }
}

// A triangle with a material of its own and others that variants put in its place.
Glb withVariants(const json& own, const std::vector<json>& others) {
  Glb glb = oneTriangle();
  glb.json["materials"] = {own};
  json mappings = json::array();
  for (const json& other : others) {
    mappings.push_back({{"material", glb.json["materials"].size()}, {"variants", {0}}});
    glb.json["materials"].push_back(other);
  }
  json& primitive = glb.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["extensions"] = {{"KHR_materials_variants", {{"mappings", mappings}}}};
  return glb;
}

TEST(GltfExtension, APrimitiveIsAsWeakAsTheWeakestOfItsVariants) {
  const json wall = {{"name", "wall"}, {"doubleSided", true}};
  const json glass = {{"alphaMode", "BLEND"}, {"doubleSided", true}};
  const json leaf = {{"alphaMode", "MASK"}, {"doubleSided", true}};
  const auto materialWith = [](const json& own, const std::vector<json>& others) {
    const Scene scene = imported(withVariants(own, others).bytes());
    return scene.view().materialOf(scene.objects[0]);
  };
  EXPECT_EQ(materialWith(wall, {wall, glass}).opacity, Opacity::kBlended);
  EXPECT_EQ(materialWith(wall, {glass, leaf, wall}).opacity, Opacity::kBlended);
  EXPECT_EQ(materialWith(wall, {wall, leaf}).opacity, Opacity::kAlphaTested);
  EXPECT_EQ(materialWith(glass, {wall}).opacity, Opacity::kBlended);
  EXPECT_EQ(materialWith(wall, {glass}).name, "wall");
  EXPECT_TRUE(materialWith(wall, {glass}).double_sided);
  EXPECT_FALSE(materialWith(wall, {json::object()}).double_sided);
  EXPECT_EQ(materialWith(wall, {json::object()}).opacity, Opacity::kOpaque);
  EXPECT_FALSE(materialWith(json::object(), {wall}).double_sided);
}

TEST(GltfExtension, VariantsOfOnePrimitiveDoNotWeakenAnother) {
  Glb glb = withVariants({{"name", "wall"}}, {{{"alphaMode", "BLEND"}}});
  json plain = glb.json["meshes"][0]["primitives"][0];
  plain.erase("extensions");
  const json weak = glb.json["meshes"][0]["primitives"][0];
  json without = weak;
  without.erase("material");
  glb.json["meshes"][0]["primitives"] = {weak, plain, weak, without};
  const Scene scene = imported(glb.bytes());
  const SceneView view = scene.view();
  ASSERT_EQ(view.objects.size(), 4u);
  EXPECT_EQ(view.materialOf(view.objects[0]).opacity, Opacity::kBlended);
  EXPECT_EQ(view.materialOf(view.objects[1]).opacity, Opacity::kOpaque);
  EXPECT_EQ(view.objects[1].material, MaterialId(0u));
  EXPECT_EQ(view.objects[2].material, view.objects[0].material) << "made once";
  EXPECT_EQ(view.materialOf(view.objects[3]).opacity, Opacity::kBlended) << "the default material, weakened";
  EXPECT_EQ(scene.materials.size(), 5u) << "two of the file, the default, and a weak one of two of them";
}

TEST(GltfExtension, AMarkOfAVariantThatItHidesNothingCounts) {
  const json yes = {{"extras", {{"occluder", true}}}}, no = {{"extras", {{"occluder", false}}}};
  const auto markWith = [](const json& own, const json& other) {
    return imported(withVariants(own, {other}).bytes()).objects[0].mark;
  };
  EXPECT_EQ(markWith(yes, json::object()), OccluderMark::kOccluder);
  EXPECT_EQ(markWith(yes, no), OccluderMark::kNever);
  EXPECT_EQ(markWith(json::object(), no), OccluderMark::kNever);
  EXPECT_EQ(markWith(json::object(), yes), OccluderMark::kAutomatic);
  Glb wrong = withVariants(yes, {no});
  wrong
      .json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] =
      2;
  EXPECT_EQ(errorOf(wrong.bytes()),
            "scene.glb: mesh 0 primitive 0: material 2 does not exist (the file has 2)");
}

// The triangle at two places of node 0, which stands at y = 7: shifted by (10, 0, 0), and turned by a half
// turn about Y in three times the size.
Glb instanced() {
  Glb glb = oneTriangle();
  glb.json["nodes"][0]["translation"] = {0, 7, 0};
  const int translations = glb.addPositions({10, 0, 0, 0, 0, 0});
  const int rotations = glb.addAccessor<std::int8_t>({0, 0, 0, 127, 0, 127, 0, 0}, "VEC4", 4);
  glb.json["accessors"][static_cast<std::size_t>(rotations)]["normalized"] = true;
  const int scales = glb.addPositions({1, 1, 1, 3, 3, 3});
  glb.json["nodes"][0]["extensions"] = {
      {"EXT_mesh_gpu_instancing",
       {{"attributes", {{"TRANSLATION", translations}, {"ROTATION", rotations}, {"SCALE", scales}}}}}};
  return glb;
}

TEST(GltfExtension, InstancesStandWhereTheirAttributesSay) {
  Glb glb = instanced();
  for (const bool required : {false, true}) {
    if (required) {
      glb.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    }
    const Scene scene = imported(glb.bytes());
    EXPECT_EQ(scene.object_names, (std::vector<std::string>{"triangle/instance0", "triangle/instance1"}));
    EXPECT_TRUE(test::isSound(scene));
    EXPECT_EQ(cornerOf(scene, 0), Vec3d(10, 7, 0));
    EXPECT_EQ(cornerOf(scene, 1), Vec3d(11, 7, 0));
    EXPECT_EQ(cornerOf(scene, 3), Vec3d(0, 7, 0));
    EXPECT_LT(length(cornerOf(scene, 4) - Vec3d(-3, 7, 0)), 1e-6);
    EXPECT_EQ(cornerOf(scene, 5), Vec3d(0, 10, 0));
  }
  json& attributes = glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = json::object();
  EXPECT_EQ(imported(glb.bytes()).object_names, std::vector<std::string>{"triangle/instance0"});
}

TEST(GltfExtension, InstancesThatMirrorTurnTheOrderOfCornersOver) {
  Glb glb = oneTriangle();
  const int scales = glb.addPositions({1, 1, -1, -1, 1, 1, -1, 1, -1});
  glb.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", scales}}}}}};
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(areaVector(scene, 0), Vec3d(0, 0, -1));
  EXPECT_EQ(areaVector(scene, 1), Vec3d(0, 0, 1));
  EXPECT_EQ(areaVector(scene, 2), Vec3d(0, 0, -1));
}

TEST(GltfExtension, InstancesThatDoNotGoTogetherAreRefused) {
  Glb glb = instanced();
  json& attributes = glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  glb.json["accessors"][4]["count"] = 1;
  EXPECT_EQ(errorOf(glb.bytes()),
            "scene.glb: node 0 instances: accessor 4 has 1 elements, and the one before has 2");
  attributes = {{"ROTATION", 2}};
  EXPECT_EQ(errorOf(glb.bytes()),
            "scene.glb: node 0 instances: translations and scales must be VEC3, and rotations VEC4, but "
            "accessor 2 is not");
  attributes = {{"SCALE", 9}};
  EXPECT_EQ(errorOf(glb.bytes()), "scene.glb: node 0 instances: accessor 9 does not exist (the file has 5)");
  attributes = {{"TRANSLATION", 2}};
  glb.addNode(json::object());
  glb.json["skins"] = {{{"joints", {0}}}};
  glb.json["nodes"][0]["skin"] = 0;
  EXPECT_EQ(errorOf(glb.bytes()), "scene.glb: node 0: has both instances and a skin");
}

TEST(GltfExtension, TheLimitsCountInstancesTargetsAndJoints) {
  const auto errorWith = [](const Glb& glb, const io::ImportLimits& limits) {
    const Result<Scene> scene = io::importGltf(glb.bytes(), "", "scene.glb", limits);
    return scene ? std::string() : scene.error().message;
  };
  Glb glb = instanced();
  EXPECT_EQ(errorWith(glb, {.triangles = 2, .vertices = 6, .objects = 2}), "");
  EXPECT_NE(errorWith(glb, {.triangles = 1}).find("2 triangles"), std::string::npos);
  EXPECT_NE(errorWith(glb, {.objects = 1}).find("2 objects"), std::string::npos);
  EXPECT_NE(errorWith(glb, {.vertices = 5}).find("6 vertices"), std::string::npos);
  // As many instances as an accessor without bytes may have, of as many triangles as one may have.
  glb.json["accessors"].push_back({{"componentType", test::kFloat}, {"count", 4'000'000}, {"type", "VEC3"}});
  glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"SCALE", 5}};
  glb.json["meshes"][0]["primitives"] = std::vector<json>(64, Glb::primitive(5, -1, 5));
  EXPECT_NE(errorWith(glb, {}).find("at most"), std::string::npos);

  glb = oneTriangle();
  glb.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}, {{"POSITION", 0}}};
  EXPECT_EQ(errorWith(glb, {.vertices = 3}), "");
  glb.json["meshes"][0]["weights"] = {1, 2};
  EXPECT_NE(errorWith(glb, {.vertices = 8}).find("9 vertices"), std::string::npos);
  glb.json["nodes"][0]["weights"] = {1, 0};
  EXPECT_NE(errorWith(glb, {.vertices = 5}).find("6 vertices"), std::string::npos);
}

TEST(GltfExtension, UnknownExtensionsAreNamedInANote) {
  Glb glb = oneTriangle();
  glb.json["extensionsUsed"] = {"KHR_materials_ior", "EXT_texture_webp", "KHR_node_visibility", "MSFT_lod"};
  EXPECT_TRUE(imported(glb.bytes()).notes.empty());
  glb.json["extensionsUsed"] = {"KHR_materials_ior", "ACME_portals", "ACME_fog\n"};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.notes.size(), 1u);
  EXPECT_NE(scene.notes[0].find("not known here: ACME_portals, ACME_fog . "), std::string::npos)
      << scene.notes[0];
  glb.json["extensionsUsed"] = std::vector<std::string>(100, std::string(1000, 'x'));
  EXPECT_LT(imported(glb.bytes()).notes.at(0).size(), 1000u);
}

TEST(GltfFlat, TransformsThatFlattenHideNothingWhateverTheirMark) {
  // A plane z = 0 of a parent without depth, below which nodes are turned: the determinant is a rounding
  // error, whose sign depends on the angle.
  int flattened = 0;
  for (int step = 1; step < 60; ++step) {
    const double angle = 0.05 * step;
    Glb glb = oneTriangle();
    glb.json["nodes"][0]["rotation"] = {0.6 * std::sin(angle), 0.8 * std::sin(angle), 0, std::cos(angle)};
    glb.json["nodes"][0]["extras"] = {{"occluder", true}};
    glb.addNode({{"scale", {1, 1, 0}}, {"children", {0}}});
    glb.addNode({{"rotation", {0.48 * std::sin(angle), 0, 0.64 * std::sin(angle), 0.6}}, {"children", {1}}});
    glb.json["scenes"][0]["nodes"] = {2};
    flattened += imported(glb.bytes()).objects[0].mark == OccluderMark::kNever ? 1 : 0;
    glb.json["nodes"][1]["scale"] = {1, 1, 1e-5};
    EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kOccluder) << "thin, but not flat";
  }
  EXPECT_EQ(flattened, 59);
  // What is flat stays so where a parent shrinks its plane, and not what rounding has added to it.
  Glb shrunk = oneTriangle();
  shrunk.json["nodes"][0]["rotation"] = {0, std::sin(0.3), 0, std::cos(0.3)};
  shrunk.addNode({{"scale", {1, 1, 0}}, {"children", {0}}});
  shrunk.addNode({{"rotation", {std::sin(0.7), 0, 0, std::cos(0.7)}}, {"children", {1}}});
  shrunk.addNode({{"scale", {1e-9, 1e-9, 1}}, {"children", {2}}});
  shrunk.addNode({{"rotation", {-std::sin(0.7), 0, 0, std::cos(0.7)}}, {"children", {3}}});
  shrunk.json["scenes"][0]["nodes"] = {4};
  EXPECT_EQ(imported(shrunk.bytes()).objects[0].mark, OccluderMark::kNever);
  Glb glb = oneTriangle();
  glb.json["nodes"][0]["scale"] = {1, 1, 0};
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kNever);
  glb.json["nodes"][0]["scale"] = {1e-30, 1e-30, 1e-30};
  EXPECT_EQ(imported(glb.bytes()).objects[0].mark, OccluderMark::kAutomatic) << "small, but not flat";
}

TEST(GltfFlat, TheOrderOfCornersIsUnknownOnlyWhereNothingTellsIt) {
  using io::CornerOrder;
  using io::cornerOrder;
  const auto scaled = [](double x, double y, double z) {
    Mat4 matrix;
    matrix(0, 0) = x;
    matrix(1, 1) = y;
    matrix(2, 2) = z;
    return matrix;
  };
  EXPECT_EQ(cornerOrder(scaled(1, 1, 1)), CornerOrder::kKept);
  EXPECT_EQ(cornerOrder(scaled(1, 1, -1e-100)), CornerOrder::kReversed);
  EXPECT_EQ(cornerOrder(scaled(-1e90, -1e-90, 1)), CornerOrder::kKept);
  EXPECT_EQ(cornerOrder(scaled(1, 1, 0)), CornerOrder::kUnknown);
  EXPECT_EQ(cornerOrder(scaled(0, 0, 0)), CornerOrder::kUnknown);
  Mat4 sheared = scaled(1, 1, 1e-13);
  sheared(0, 2) = 1;
  EXPECT_EQ(cornerOrder(sheared), CornerOrder::kUnknown);
  sheared(2, 2) = -1e-11;
  EXPECT_EQ(cornerOrder(sheared), CornerOrder::kReversed);
}

}  // namespace
}  // namespace sightline
