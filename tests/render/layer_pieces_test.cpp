// Pieces of objects: together they are the object, bit for bit.

#include <array>
#include <vector>

#include "sightline/render/layer_compositor.h"
#include "tests/render/layer_test.h"

namespace sightline {
namespace {

class LayerPiecesTest : public LayerTest {};

// Every object of a scene, cut by two planes into three pieces; pieces are numbered after the objects.
std::vector<ObjectPiece> thirds(const Scene& scene, const Plane& first, const Plane& second) {
  std::vector<ObjectPiece> pieces;
  auto number = static_cast<std::uint32_t>(scene.objects.size());
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const std::vector<std::vector<PieceSide>> all{
        {{first, true}}, {{first, false}, {second, true}}, {{first, false}, {second, false}}};
    for (const std::vector<PieceSide>& sides : all) {
      pieces.push_back({ObjectId(number++), ObjectId(i), sides});
    }
  }
  return pieces;
}

const Plane kUpright{{0.8, 0.36, -0.48}, 0.11}, kLevel{{0.0, 0.96, 0.28}, -0.2};

TEST_F(LayerPiecesTest, EachPixelOfAnObjectIsInExactlyOneOfItsPieces) {
  const SceneMaker maker = opaqueScene(5);
  LayerRenderer layers = layersOf(maker.scene);
  const std::vector<ObjectPiece> pieces = thirds(maker.scene, kUpright, kLevel);
  layers.setPieces(pieces);
  const View view = turnedView(false);
  std::array<std::size_t, 3> pixels{};
  for (std::uint32_t object = 0; object < maker.scene.objects.size(); ++object) {
    const ObjectId whole_id(object);
    const LayerImage whole = drawn(layers, view, {&whole_id, 1}, {.depths = true});
    LayerImage nearest;
    nearest.clear(kWidth, kHeight);
    nearest.depths.assign(std::size_t{kWidth} * kHeight, LayerImage::kNoDepth);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const ObjectId id = pieces[3 * object + k].piece;
      EXPECT_EQ(layers.objectOf(id), whole_id);
      const LayerImage piece = drawn(layers, view, {&id, 1}, {.depths = true});
      for (std::size_t i = 0; i < piece.pixels.size(); ++i) {
        pixels[k] += piece.pixels[i].alpha > 0.0f ? 1 : 0;
        if (piece.depths[i] < nearest.depths[i]) {
          nearest.depths[i] = piece.depths[i];
          nearest.pixels[i] = piece.pixels[i];
        }
      }
    }
    EXPECT_EQ(nearest.pixels, whole.pixels) << object;
    EXPECT_EQ(nearest.depths, whole.depths) << object;
  }
  for (const std::size_t count : pixels) {
    EXPECT_GT(count, 30u);
  }
}

TEST_F(LayerPiecesTest, AllPiecesDrawnTogetherAreTheWholeScene) {
  const std::vector<Material> materials{{.name = "opaque", .double_sided = true},
                                        {.name = "glass",
                                         .opacity = Opacity::kBlended,
                                         .double_sided = true,
                                         .base_color = {0.2f, 0.5f, 0.8f, 0.5f}}};
  const Scene scene = triangles(8, 14, materials);
  LayerRenderer layers = layersOf(scene);
  const std::vector<ObjectPiece> pieces = thirds(scene, kUpright, kLevel);
  layers.setPieces(pieces);
  std::vector<ObjectId> whole, cut;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    whole.emplace_back(i);
  }
  for (const ObjectPiece& piece : pieces) {
    cut.push_back(piece.piece);
  }
  for (const bool orthographic : {false, true}) {
    const View view = turnedView(orthographic);
    const LayerImage expected = drawn(layers, view, whole, {.peel = true, .depths = true});
    const LayerImage found = drawn(layers, view, cut, {.peel = true, .depths = true});
    EXPECT_EQ(found.pixels, expected.pixels);
    EXPECT_EQ(found.depths, expected.depths);
  }
}

TEST_F(LayerPiecesTest, APieceOfAnObjectThatIsDrawnWholeAddsNothing) {
  const SceneMaker maker = opaqueScene(6);
  LayerRenderer layers = layersOf(maker.scene);
  const std::vector<ObjectPiece> pieces = thirds(maker.scene, kUpright, kLevel);
  layers.setPieces(pieces);
  const std::vector<ObjectId> both{ObjectId(0u), pieces[0].piece, pieces[1].piece}, whole{ObjectId(0u)};
  LayerImage image;
  const LayerDrawStats of_both = layers.draw(turnedView(false), both, {}, image);
  const std::vector<ShapedPixel> pixels = image.pixels;
  EXPECT_EQ(layers.draw(turnedView(false), whole, {}, image).triangles, of_both.triangles);
  EXPECT_EQ(image.pixels, pixels);
  layers.setPieces({});
  const ObjectId gone = pieces[0].piece;
  EXPECT_EQ(layers.draw(turnedView(false), {&gone, 1}, {}, image).triangles, 0u);
}

// Two panes that cross: cut where they do, four pieces have an order.
TEST_F(LayerPiecesTest, CrossingPanesAreCompositedFromTheirPieces) {
  Scene scene;
  scene.materials = {{.name = "red",
                      .opacity = Opacity::kBlended,
                      .double_sided = true,
                      .base_color = {0.8f, 0.1f, 0.1f, 0.5f}},
                     {.name = "blue",
                      .opacity = Opacity::kBlended,
                      .double_sided = true,
                      .base_color = {0.1f, 0.1f, 0.8f, 0.4f}}};
  const std::array<std::array<Vec3f, 4>, 2> panes{{{{{-1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, -1}}},
                                                   {{{-1, -1, 1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, 1}}}}};
  for (std::uint32_t i = 0; i < 2; ++i) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), panes[i].begin(), panes[i].end());
    scene.objects.push_back({.first_index = static_cast<std::uint32_t>(scene.indices.size()),
                             .index_count = 6,
                             .material = MaterialId(i)});
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) {
      scene.indices.push_back(first + corner);
    }
  }
  updateBounds(scene);
  LayerRenderer layers = layersOf(scene);
  const Plane middle{{1, 0, 0}, 0.0};
  layers.setPieces({{ObjectId(2u), ObjectId(0u), {{middle, true}}},
                    {ObjectId(3u), ObjectId(0u), {{middle, false}}},
                    {ObjectId(4u), ObjectId(1u), {{middle, true}}},
                    {ObjectId(5u), ObjectId(1u), {{middle, false}}}});
  // Seen along -z, on the right pane 0 is nearer, on the left pane 1.
  FrameLayers frame;
  frame.parts = {PartId(2u), PartId(4u), PartId(5u), PartId(3u)};
  frame.first_part = {0, 1, 2, 3, 4};
  frame.first_layer = {0, 1, 2, 3, 4};
  LayerCompositor compositor(scene.view(), layers);
  LayerImage picture;
  const View view = testView({0.2, 0.1, 6.0});
  const Result<CompositeStats> stats = compositor.composite(view, frame, {.sky = false}, picture);
  ASSERT_TRUE(stats.has_value());
  EXPECT_EQ(stats->unordered_groups, 0u);
  const std::vector<ObjectId> whole{ObjectId(0u), ObjectId(1u)};
  const LayerImage peeled = drawn(layers, view, whole, {.peel = true});
  EXPECT_LE(measureDifference(picture, peeled).largest, 1.0);
  // The other way round the picture is another one.
  std::reverse(frame.parts.begin(), frame.parts.end());
  ASSERT_TRUE(compositor.composite(view, frame, {.sky = false}, picture).has_value());
  EXPECT_GT(measureDifference(picture, peeled).largest, 10.0);
}

}  // namespace
}  // namespace sightline
