// Embree and OpenGL are independent of each other: the objects that one sees must be those that the other
// draws.

#include <gtest/gtest.h>

#include <algorithm>

#include "oracle/exact_visibility.h"
#include "scenes/procedural.h"
#include "sightline/render/compare.h"
#include "sightline/render/renderer.h"
#include "tests/support/pictures.h"

namespace sightline {
namespace {

constexpr std::uint32_t kWidth = 320, kHeight = 180;
// Pixels on edges, where the two may round differently.
constexpr std::uint64_t kFewPixels = kWidth * kHeight / 10'000;

std::vector<ObjectId> objectsOf(const std::vector<SeenPoint>& witnesses) {
  std::vector<ObjectId> objects;
  for (const SeenPoint& witness : witnesses) {
    objects.push_back(witness.object);
  }
  return objects;
}

TEST(ExactVisibility, ItsObjectsMakeTheWholePictureAndEachIsNeeded) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  for (const char* url : {"demo:city?copies=1", "demo:building?floors=2&plants=5"}) {
    const Result<Scene> scene = makeDemoScene(url);
    ASSERT_TRUE(scene) << scene.error().message;
    Result<Renderer> renderer = Renderer::create(scene->view(), kWidth, kHeight);
    ASSERT_TRUE(renderer) << renderer.error().message;
    std::vector<ObjectId> all;
    for (std::uint32_t o = 0; o < scene->objects.size(); ++o) {
      all.push_back(ObjectId(o));
    }
    const ExactVisibility oracle(scene->view());
    const CameraPath& path = scene->paths.front();
    for (std::size_t frame = 0; frame < path.frames.size(); frame += 100) {
      const View view = path.view(frame, scene->origin);
      const std::vector<SeenPoint> seen = oracle.visibleThroughPixels(view, kWidth, kHeight);
      const std::vector<ObjectId> exact = objectsOf(seen);
      const Image picture = renderer->draw(view, exact);
      EXPECT_LE(compareImages(renderer->draw(view, all), picture).pixels, kFewPixels)
          << url << " frame " << frame;
      std::size_t needed = 0;
      const std::size_t tried = std::min<std::size_t>(exact.size(), 12);
      for (std::size_t i = 0; i < tried; ++i) {
        EXPECT_TRUE(oracle.confirm(view, seen[i]))
            << url << " frame " << frame << " object " << exact[i].value;
        std::vector<ObjectId> without = exact;
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
        needed += compareImages(picture, renderer->draw(view, without)).equal() ? 0 : 1;
      }
      EXPECT_GE(needed + 1, tried) << url << " frame " << frame;
    }
  }
}

}  // namespace
}  // namespace sightline
