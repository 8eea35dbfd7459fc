#pragma once

// Scenes as lists of objects that tests move, add, remove and resize.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/sight_checks.h"

namespace sightline::test {

// One object: the corners of its triangles, three each, scene space.
struct Piece {
  std::vector<Vec3f> corners;
  MaterialId material{0u};
  OccluderMark mark = OccluderMark::kAutomatic;

  Box bounds() const {
    Box box;
    for (const Vec3f& corner : corners) {
      box.extend(corner);
    }
    return box;
  }
  void move(const Vec3f& by) {
    for (Vec3f& corner : corners) {
      corner = corner + by;
    }
  }
};

struct EditedScene {
  std::vector<Piece> pieces;
  std::vector<Material> materials;

  static EditedScene of(const Scene& scene) {
    EditedScene edited{.pieces = {}, .materials = scene.materials};
    for (const Object& object : scene.objects) {
      Piece piece{.corners = {}, .material = object.material, .mark = object.mark};
      for (const std::uint32_t index : scene.view().indicesOf(object)) {
        piece.corners.push_back(scene.positions[index]);
      }
      edited.pieces.push_back(std::move(piece));
    }
    return edited;
  }

  Scene scene() const {
    Scene scene;
    scene.materials = materials;
    for (const Piece& piece : pieces) {
      Object object;
      object.first_index = static_cast<std::uint32_t>(scene.indices.size());
      object.index_count = static_cast<std::uint32_t>(piece.corners.size());
      object.material = piece.material;
      object.mark = piece.mark;
      for (const Vec3f& corner : piece.corners) {
        scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
        scene.positions.push_back(corner);
      }
      scene.objects.push_back(object);
      scene.object_names.emplace_back("piece");
    }
    weldPositions(scene);
    updateBounds(scene);
    return scene;
  }

  Box bounds() const {
    Box box;
    for (const Piece& piece : pieces) {
      box.extend(piece.bounds());
    }
    return box;
  }
};

// The file of a bake, and what it leaves for the next one.
struct Answered {
  sight_test::Bytes file{}, answers{};
  std::vector<std::uint64_t> parts{};  // their ids
  BakeStats stats{};
  Bake::TakenOver taken{};
};

// A plan of a bake that records answers, baked in full and then after an earlier bake.
class AnsweredBake {
 public:
  AnsweredBake(const Scene& scene, BakeSettings settings) {
    settings.answers = true;
    Result<Bake> bake = Bake::plan(scene.view(), allOccluders(scene), settings);
    EXPECT_TRUE(bake) << (bake ? "" : bake.error().message);
    bake_.emplace(*bake);
  }

  // To be called before after(): what was taken over once stays.
  Answered inFull() const {
    Answered made;
    const BakedParts parts = bake_->bakeAll(serialFor, {}, &made.stats);
    for (const auto& [id, part] : parts) {
      made.parts.push_back(id);
    }
    const Result<BakedVisibility> baked = bake_->assemble(parts);
    EXPECT_TRUE(baked) << (baked ? "" : baked.error().message);
    made.file = baked ? sight_test::bytesOf(*baked) : sight_test::Bytes{};
    made.answers = bake_->answers(parts);
    return made;
  }
  // Takes over the answers of an earlier bake.
  Answered after(const sight_test::Bytes& answers) {
    const Result<Bake::TakenOver> taken = bake_->takeOver(answers);
    EXPECT_TRUE(taken) << (taken ? "" : taken.error().message);
    Answered made = inFull();
    made.taken = taken ? *taken : Bake::TakenOver{};
    return made;
  }

 private:
  std::optional<Bake> bake_;
};

// Edits a scene at random, but never what is as wide as half of it: floors and outer walls stay. The octree's
// borders are where moved objects are put sometimes: exactly at them, or as far from them as occluders are
// searched.
class RandomEdits {
 public:
  explicit RandomEdits(std::uint32_t seed) : random_(seed) {}

  // Returns what it did, for messages.
  std::string edit(EditedScene& scene) {
    const std::uint32_t kind = below(16);
    if (kind == 0) {
      return "nothing";
    }
    if (kind == 1) {
      std::string all;
      for (std::uint32_t i = 0; i < 3; ++i) {
        all += one(scene, below(12)) + ", ";
      }
      return all;
    }
    return one(scene, kind - 2);
  }

 private:
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }

  // A small object; the number of pieces if there is none.
  std::size_t smallOne(const EditedScene& scene) {
    const Vec3f all = scene.bounds().max - scene.bounds().min;
    for (int attempt = 0; attempt < 200; ++attempt) {
      const std::size_t i = below(static_cast<std::uint32_t>(scene.pieces.size()));
      const Vec3f size = scene.pieces[i].bounds().max - scene.pieces[i].bounds().min;
      if (size.x < 0.5f * all.x && size.z < 0.5f * all.z) {
        return i;
      }
    }
    return scene.pieces.size();
  }

  // Moves the piece so that its lower corner is here, as far as it stays within the scene.
  static void place(Piece& piece, const Vec3f& corner, const Box& all) {
    const Box box = piece.bounds();
    const Vec3f size = box.max - box.min;
    piece.move(min(max(corner, all.min), all.max - size) - box.min);
  }

  std::string one(EditedScene& scene, std::uint32_t kind) {
    const std::size_t i = smallOne(scene);
    if (i == scene.pieces.size()) {
      return "nothing is small enough";
    }
    const Box all = scene.bounds();
    Piece& piece = scene.pieces[i];
    const Vec3f extent = all.max - all.min, at = piece.bounds().min;
    const Vec3f anywhere(in(all.min.x, all.max.x), at.y, in(all.min.z, all.max.z));
    const std::string name = "object " + std::to_string(i);
    switch (kind) {
      case 0:
      case 1:
        place(piece, anywhere, all);
        return name + " moved";
      case 2:
        place(piece, at + Vec3f(0.25f * static_cast<float>(below(9)) - 1, 0, 0.25f), all);
        return name + " moved a little";
      case 3:
        place(piece, at + Vec3f(0, in(0, 1), 0), all);
        return name + " lifted";
      case 4: {
        // The octree's root is a cube with the lower corner of the scene.
        const float edge = std::max({extent.x, extent.y, extent.z}) / static_cast<float>(2u << below(4));
        const Vec3f cells(static_cast<float>(below(16)), 0, static_cast<float>(below(16)));
        place(piece, all.min + Vec3f(cells.x * edge, at.y - all.min.y, cells.z * edge), all);
        return name + " moved to the border of a cell";
      }
      case 5: {
        const auto reach = static_cast<float>(0.125 * length(Vec3d(all.max) - Vec3d(all.min)));
        place(piece, all.min + Vec3f(0.25f * extent.x + reach, at.y - all.min.y, 0.25f * extent.z), all);
        return name + " moved to the border of a search box";
      }
      case 6:
      case 7:
        scene.pieces.erase(scene.pieces.begin() + static_cast<std::ptrdiff_t>(i));
        return name + " removed";
      case 8:
      case 9: {
        Piece added = piece;
        place(added, anywhere, all);
        scene.pieces.insert(scene.pieces.begin() + below(static_cast<std::uint32_t>(scene.pieces.size())),
                            std::move(added));
        return "a copy of " + name + " added";
      }
      case 10: {
        // A wall from floor to ceiling, or something flat.
        const Vec3f factor(in(0.3f, 3), in(0.3f, 3), in(0.3f, 3));
        for (Vec3f& corner : piece.corners) {
          corner = at + Vec3f((corner.x - at.x) * factor.x, (corner.y - at.y) * factor.y,
                              (corner.z - at.z) * factor.z);
          corner = min(corner, all.max);
        }
        return name + " resized";
      }
      case 11: {
        Piece twin = piece;
        scene.pieces.push_back(std::move(twin));
        return name + " doubled in place";
      }
      case 12:
        std::swap(scene.pieces[i], scene.pieces[below(static_cast<std::uint32_t>(scene.pieces.size()))]);
        return name + " has another number";
      default:
        piece.move({2 * extent.x, 0, 0});
        return name + " moved far outside";
    }
  }

  std::mt19937 random_;
};

// Rooms beside each other, with doors between most of them and a few things in each: a floor, a ceiling,
// walls in pieces, crates.
inline EditedScene roomScene(std::uint32_t seed, int rooms = 3) {
  std::mt19937 random(seed);
  const float size = 4, height = 3, thick = 0.25f, span = size * static_cast<float>(rooms);
  std::vector<Solid> solids{block({-thick, -thick, -thick}, {span + thick, 0, span + thick}),
                            block({-thick, height, -thick}, {span + thick, height + thick, span + thick})};
  // Walls across x and across z: two pieces and a lintel, or one piece.
  for (const bool across_x : {true, false}) {
    for (int i = 0; i <= rooms; ++i) {
      for (int j = 0; j < rooms; ++j) {
        const float at = size * static_cast<float>(i), from = size * static_cast<float>(j);
        const auto wall = [&](float low, float high, float bottom) {
          solids.push_back(across_x ? block({at - thick, bottom, low}, {at, height, high})
                                    : block({low, bottom, at - thick}, {high, height, at}));
        };
        if (i == 0 || i == rooms || random() % 4 == 0) {
          wall(from, from + size, 0);
        } else {
          const float door = from + 0.5f * static_cast<float>(1 + random() % 5);
          wall(from, door, 0);
          wall(door + 1, from + size, 0);
          wall(door, door + 1, 2);
        }
      }
    }
  }
  for (int i = 0; i < rooms * rooms * 5; ++i) {
    const auto place = [&] {
      return 0.25f * static_cast<float>(random() % static_cast<unsigned>(4 * span - 4));
    };
    const Vec3f at(place(), 0, place());
    solids.push_back(block(at, at + Vec3f(0.5f + 0.25f * static_cast<float>(random() % 3),
                                          0.25f * static_cast<float>(1 + random() % 8),
                                          0.5f + 0.25f * static_cast<float>(random() % 3))));
  }
  return EditedScene::of(sceneOf(solids));
}

// The scene with holes: half of its objects lack one of their triangles. Where a surface ends at a hole, or
// is too near, depends on the way by which it is followed.
inline EditedScene torn(EditedScene scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (Piece& piece : scene.pieces) {
    const auto triangles = static_cast<std::ptrdiff_t>(piece.corners.size() / 3);
    if (random() % 2 == 0) {
      const auto first =
          piece.corners.begin() + 3 * (static_cast<std::ptrdiff_t>(random() % 1000) % triangles);
      piece.corners.erase(first, first + 3);
    }
  }
  return scene;
}

}  // namespace sightline::test
