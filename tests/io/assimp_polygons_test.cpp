// Faces of more than three corners, in formats that Assimp reads.

#include <gtest/gtest.h>

#include <cmath>

#include "sightline/io/import.h"
#include "src/io/assimp.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

// The sum of the triangles' areas as seen along z; none of them may be turned away.
double areaFacing(const Scene& scene) {
  double area = 0.0;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const Vec3d a(scene.positions[scene.indices[i]]), b(scene.positions[scene.indices[i + 1]]);
    const Vec3d c(scene.positions[scene.indices[i + 2]]);
    const double own = 0.5 * cross(b - a, c - a).z;
    EXPECT_GT(own, 0.0);
    area += own;
  }
  return area;
}

class AssimpPolygons : public testing::Test {
 protected:
  Scene read(const std::string& name, const std::string& text) {
    Result<Scene> scene = importScene(folder_.write(name, text));
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? std::move(*scene) : Scene();
  }

  const test::TemporaryFolder folder_;
};

const std::string kHead = "ply\nformat ascii 1.0\nelement vertex ";
const std::string kMiddle = "\nproperty float x\nproperty float y\nproperty float z\nelement face ";
const std::string kEnd = "\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(AssimpPolygons, AreCoveredByTheirTrianglesAlone) {
  const std::string corners = "0 0 -5\n2 0 -5\n2 1 -5\n1 1 -5\n1 2 -5\n0 2 -5\n";
  const Scene ply = read("l.ply", kHead + "6" + kMiddle + "1" + kEnd + corners + "6 0 1 2 3 4 5\n");
  EXPECT_EQ(areaFacing(ply), 3.0);
  EXPECT_EQ(ply.objects.at(0).mark, OccluderMark::kAutomatic);
  EXPECT_EQ(areaFacing(read("l.off", "OFF\n6 1 0\n" + corners + "6 0 1 2 3 4 5\n")), 3.0);
  EXPECT_TRUE(ply.notes.empty());
}

TEST_F(AssimpPolygons, OfAMeshAreOneObjectWithItsTriangles) {
  const Scene scene = read("m.ply", kHead + "9" + kMiddle + "3" + kEnd +
                                        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n2 1 0\n3 0 0\n3 1 0\n2.5 2 0\n" +
                                        "4 0 1 2 3\n3 1 4 2\n5 4 6 7 8 5\n");
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.triangleCount(), 6u);
  EXPECT_EQ(areaFacing(scene), 3.0);
}

TEST_F(AssimpPolygons, ThatCrossThemselvesHideNothingAndAreNoted) {
  const Scene scene =
      read("bow.ply", kHead + "4" + kMiddle + "1" + kEnd + "0 0 0\n4 4 0\n4 0 0\n0 3 0\n4 0 1 2 3\n");
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].mark, OccluderMark::kNever);
  EXPECT_EQ(scene.objects[0].bounds, (Box{{0, 0, 0}, {4, 4, 0}}));
  ASSERT_EQ(scene.notes.size(), 1u);
  EXPECT_EQ(scene.notes[0].find("1 polygon crosses itself"), 0u) << scene.notes[0];
}

TEST_F(AssimpPolygons, OfMirroredNodesKeepTheirFronts) {
  const std::string collada =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="18">0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0</float_array>
<technique_common><accessor source="#a" count="6" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>6</vcount><p>0 1 2 3 4 5</p></polylist>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node id="n"><scale>-1 1 1</scale><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  EXPECT_EQ(areaFacing(read("mirrored.dae", collada)), 3.0);
}

}  // namespace
}  // namespace sightline
