// Compares drawn and hidden points of lines with Embree's rays.
//
// Embree works in single precision, and a line lies on the border of its surface, where a single ray proves
// little. So a point counts as visible or hidden within a tolerance: rays go to the point itself and to two
// rings of points around it, across the line of sight, at kBeside and at kRounding of its distance. Rods
// thinner than the first ring may pass between its rays, and the ray in the middle may, by its rounding, miss
// what hides the point; the second ring covers these cases. One of the rays must agree.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "oracle/ray_scene.h"
#include "oracle/view_rays.h"
#include "scenes/procedural.h"
#include "sightline/drawing/feature_edges.h"
#include "sightline/drawing/hidden_lines.h"
#include "sightline/io/camera_path_json.h"
#include "sightline/io/import.h"
#include "tests/support/random_numbers.h"
#include "tests/support/real_scenes.h"

namespace sightline {
namespace {

constexpr double kBeside = 1e-4;       // of the distance: how far beside the point a ray may go
constexpr double kRounding = 0x1p-21;  // of the distance: above what single precision moves a ray by
constexpr double kBefore = 2e-4;       // of the distance: what a visible point may lie behind
constexpr double kBehind = 1e-6;       // of the distance: what a hidden point must lie behind
constexpr double kPageOfRays = 720.0;

class Rays {
 public:
  Rays(const SceneView& scene, const View& view) : scene_(scene), rays_(scene), view_(view) {}

  // The smallest and the largest depth, over the rays, of the first opaque surface before the point, relative
  // to the point's depth; 1 if there is none.
  std::array<double, 2> nearest(const Vec3d& point) {
    const double distance = view_.orthographic ? view_.ortho_height : length(point - view_.eye);
    RayScene::Batch batch;
    for (std::size_t i = 0; i < kRays; ++i) {
      const double angle = static_cast<double>(i) * (i < 8 ? 0.78539816 : 1.57079633);
      const double beside = i < 8 ? kBeside * distance : i < 12 ? kRounding * distance : 0.0;
      const Vec3d to =
          point + view_.right * (beside * std::cos(angle)) + view_.up * (beside * std::sin(angle));
      const ViewRay ray = rayTo(view_, to);
      const double reach = depthOf(view_, to) - view_.z_near;
      batch[i] = {Vec3f(ray.origin), Vec3f(ray.direction), static_cast<float>(reach)};
    }
    hits_.clear();
    rays_.trace(batch, kRays, false, hits_);
    const double depth = depthOf(view_, point);
    std::array<double, kRays> first;
    first.fill(1.0);
    for (const RayHit& hit : hits_) {
      if (scene_.materialOf(scene_.objects[hit.object.value]).opaque()) {
        first[hit.ray] = std::min(first[hit.ray], (static_cast<double>(hit.t) + view_.z_near) / depth);
      }
    }
    return {*std::min_element(first.begin(), first.end()), *std::max_element(first.begin(), first.end())};
  }

 private:
  static constexpr std::size_t kRays = 13;  // a ring of eight, one of four, the middle

  SceneView scene_;
  RayScene rays_;
  View view_;
  std::vector<RayHit> hits_;
};

struct Tally {
  int drawn = 0, hidden = 0;  // points that were looked at
  int wrongly_drawn = 0, wrongly_hidden = 0;
};

// Checks the middle of each piece and random points between the pieces.
void checkLine(const SceneView& scene, const View& view, const FeatureLine& line,
               std::span<const LinePiece> pieces, Rays& rays, std::mt19937& random, Tally& tally) {
  const Vec3d a(scene.positions[line.a]);
  const Vec3d b(scene.positions[line.b]);
  const auto at = [&](double share) { return a + (b - a) * share; };
  const double page = (view.orthographic ? view.ortho_height : 2.0 * view.tan_half_fovy) / kPageOfRays;
  for (const LinePiece& piece : pieces) {
    // A stroke shorter than the tolerance is not checked.
    const double size = std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y) * page;
    if (size < 4.0 * kBeside) {
      continue;
    }
    ++tally.drawn;
    const Vec3d point = at(0.5 * (piece.from_share + piece.to_share));
    tally.wrongly_drawn += rays.nearest(point)[1] < 1.0 - kBefore ? 1 : 0;
    EXPECT_TRUE(inVolume(view, point, 1e-9));
  }
  // Nor is a shorter line: from afar all its points may lie within kBehind of what hides them.
  const Vec3d sight = view.orthographic ? view.forward * view.ortho_height : at(0.5) - view.eye;
  const bool large = length(cross(b - a, sight)) > 4.0 * kBeside * dot(sight, sight);
  for (int i = 0; i < 4 && large; ++i) {
    const double share = std::uniform_real_distribution<double>(0, 1)(random);
    const bool drawn = std::any_of(pieces.begin(), pieces.end(), [&](const LinePiece& p) {
      return p.from_share <= share && share <= p.to_share;
    });
    if (!drawn && inVolume(view, at(share), -1e-9)) {
      ++tally.hidden;
      tally.wrongly_hidden += rays.nearest(at(share))[0] > 1.0 - kBehind ? 1 : 0;
    }
  }
}

// Checks every n-th line of all objects, with all objects as occluders.
Tally check(const Scene& scene, const View& view, std::size_t every, std::uint32_t seed) {
  const SceneView of = scene.view();
  const FeatureEdges edges(of);
  std::vector<FeatureLine> lines;
  std::vector<FeatureLine> some;
  std::vector<ObjectId> all;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    all.emplace_back(i);
    edges.select(of, ObjectId(i), view, {}, lines);
    std::copy_if(lines.begin(), lines.end(), std::back_inserter(some),
                 [&](const FeatureLine&) { return count++ % every == 0; });
  }
  HiddenLines hidden;
  hidden.setView(of, view, kPageOfRays);
  Rays rays(of, view);
  std::mt19937 random(seed);
  Tally tally;
  std::vector<LinePiece> pieces;
  hidden.visiblePieces(some, all, pieces);
  EXPECT_EQ(hidden.stats().lines, some.size());
  std::size_t next = 0;
  for (const FeatureLine& line : some) {
    const std::size_t first = next;
    while (next < pieces.size() && pieces[next].line == line &&
           (next == first || pieces[next].from_share > pieces[next - 1].to_share)) {
      ++next;
    }
    checkLine(of, view, line, std::span(pieces).subspan(first, next - first), rays, random, tally);
  }
  EXPECT_EQ(next, pieces.size());
  return tally;
}

// A view from above a corner of the scene.
View fromOutside(const Scene& scene, bool orthographic, double angle) {
  const Box bounds = sceneBounds(scene.view());
  const double size = length(Vec3d(bounds.extent()));
  View view;
  view.eye = center(bounds) + Vec3d(std::cos(angle), 0.6, std::sin(angle)) * (0.8 * size);
  setOrientation(view, center(bounds) - view.eye, {0, 1, 0});
  view.orthographic = orthographic;
  view.ortho_height = 0.7 * size;
  view.z_near = 0.01 * size;
  view.z_far = 3.0 * size;
  return view;
}

void expectRight(const Tally& tally) {
  EXPECT_GT(tally.drawn, 20);
  EXPECT_GT(tally.hidden, 20);
  EXPECT_EQ(tally.wrongly_drawn, 0) << "of " << tally.drawn;
  EXPECT_EQ(tally.wrongly_hidden, 0) << "of " << tally.hidden;
}

void checkViews(const Scene& scene, const CameraPath& path, std::size_t every) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << i);
    expectRight(check(scene, fromOutside(scene, i == 1, 0.7 + i), every, i));
  }
  SCOPED_TRACE("on the walk");
  const View view = path.view(path.frames.size() / 2, scene.origin);
  const Tally tally = check(scene, view, every, 7);
  EXPECT_GT(tally.drawn + tally.hidden, 20);
  EXPECT_EQ(tally.wrongly_drawn, 0) << "of " << tally.drawn;
  EXPECT_EQ(tally.wrongly_hidden, 0) << "of " << tally.hidden;
}

void checkDemo(const std::string& url, std::size_t every) {
  const Result<Scene> scene = makeDemoScene(url);
  ASSERT_TRUE(scene) << scene.error().message;
  checkViews(*scene, scene->paths[0], every);
}

TEST(HiddenLinesRays, AgreeOnACity) {
  checkDemo("demo:city?copies=2", 17);
}

TEST(HiddenLinesRays, AgreeOnABuilding) {
  checkDemo("demo:building?floors=2&plants=10", 17);
}

TEST(HiddenLinesRays, AgreeOnBoxes) {
  checkDemo("demo:boxes?buildings=100&boxes=500", 5);
}

TEST(HiddenLinesRays, AgreeOnToothpicks) {
  checkDemo("demo:toothpicks?n=60", 11);
}

// Triangles that pass through each other, of all materials.
TEST(HiddenLinesRays, AgreeOnRandomTriangles) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    const auto number = test::numbersFrom<float>(random);
    Scene scene;
    scene.materials = {{.name = "double-sided", .double_sided = true},
                       {.name = "single-sided"},
                       {.name = "glass", .opacity = Opacity::kBlended}};
    for (std::uint32_t i = 0; i < 150; ++i) {
      const Vec3f at(number(-5, 5), number(-5, 5), number(-5, 5));
      Object object;
      object.first_index = 3 * i;
      object.index_count = 3;
      object.material = MaterialId(i % 3);
      for (int k = 0; k < 3; ++k) {
        scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
        scene.positions.push_back(at + Vec3f(number(-2, 2), number(-2, 2), number(-2, 2)));
      }
      scene.objects.push_back(object);
    }
    updateBounds(scene);
    for (const bool orthographic : {false, true}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << (orthographic ? ", orthographic" : ""));
      expectRight(check(scene, fromOutside(scene, orthographic, seed), 1, seed));
      View amid = fromOutside(scene, orthographic, seed);
      amid.eye = {0, 0, 0};  // many triangles cross the near plane
      expectRight(check(scene, amid, 1, seed));
      View off_centre = fromOutside(scene, orthographic, seed);
      off_centre.shift_x = 0.4;
      off_centre.shift_y = -0.3;
      expectRight(check(scene, off_centre, 1, seed));
    }
  }
}

void checkReal(const std::string& name, std::size_t every) {
  const std::filesystem::path folder = test::folderOfScenes() / name, file = folder / (name + ".glb");
  SIGHTLINE_SKIP_WITHOUT_SCENE(file);
  const Result<Scene> scene = importScene(file.string());
  ASSERT_TRUE(scene) << scene.error().message;
  const Result<CameraPath> path = readCameraPath((folder / "walk.path.json").string());
  ASSERT_TRUE(path) << path.error().message;
  checkViews(*scene, *path, every);
}

TEST(HiddenLinesRays, AgreeOnABuildingModel) {
  checkReal("ifc_duplex", 11);
}

TEST(HiddenLinesRays, AgreeOnACityModel) {
  checkReal("ingolstadt_lod3", 13);
}

}  // namespace
}  // namespace sightline
