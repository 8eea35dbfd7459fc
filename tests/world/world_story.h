#pragma once

// A World that changes, told a second time as a scene of triangles that exact visibility judges.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"
#include "sightline/scene/scene.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "tests/support/random_numbers.h"

namespace sightline::world_story {

// A mesh as its triangles, three points each, counter-clockwise as seen from their fronts.
struct Shape {
  std::vector<Vec3f> corners;
  MeshSettings settings;
};

inline void addQuad(Shape& shape, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  shape.corners.insert(shape.corners.end(), {a, b, c, a, c, d});
}

inline Shape boxShape() {
  Shape shape;
  const auto at = [](int i) {
    return Vec3f{(i & 1) != 0 ? 1.0f : 0.0f, (i & 2) != 0 ? 1.0f : 0.0f, (i & 4) != 0 ? 1.0f : 0.0f};
  };
  for (const std::array<int, 4>& face :
       {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4}, std::array{2, 6, 7, 3},
        std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    addQuad(shape, at(face[0]), at(face[1]), at(face[2]), at(face[3]));
  }
  return shape;
}

// In the plane z = 0, with its front towards +z.
inline Shape panelShape(bool double_sided, Opacity opacity = Opacity::kOpaque) {
  Shape shape;
  addQuad(shape, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  shape.settings.double_sided = double_sided;
  shape.settings.opacity = opacity;
  return shape;
}

// Hilly ground of 8 x 8 fields of 1/8 m, fronts upwards.
inline Shape groundShape() {
  Shape shape;
  const auto at = [](int x, int z) {
    return Vec3f{static_cast<float>(x) / 8.0f, static_cast<float>((x * 7 + z * 5) % 4) / 16.0f,
                 static_cast<float>(z) / 8.0f};
  };
  for (int z = 0; z < 8; ++z) {
    for (int x = 0; x < 8; ++x) {
      addQuad(shape, at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z));
    }
  }
  return shape;
}

inline MeshId addShape(World& world, const Shape& shape) {
  const MeshView view{.positions = shape.corners.data(),
                      .vertex_count = static_cast<std::uint32_t>(shape.corners.size())};
  return world.addMesh(*makeMesh(view, shape.settings));
}

struct Told {
  std::size_t shape = 0;
  Mat4 world_from_mesh;
  bool shown = true;
};

// The world and, beside it, what is there by InstanceId.
struct Story {
  World world;
  std::vector<Shape> shapes;
  std::vector<MeshId> meshes;
  std::map<std::uint32_t, Told> told;

  explicit Story(std::vector<Shape> given) : shapes(std::move(given)) {
    for (const Shape& shape : shapes) {
      meshes.push_back(addShape(world, shape));
    }
  }
  InstanceId add(std::size_t shape, const Mat4& m, bool shown = true) {
    const InstanceId id = world.add({.mesh = meshes[shape], .world_from_mesh = m, .shown = shown});
    told[id.value] = {shape, m, shown};
    return id;
  }
  void remove(InstanceId id) {
    world.remove(id);
    told.erase(id.value);
  }
  void move(InstanceId id, const Mat4& m) {
    world.setTransform(id, m);
    told.at(id.value).world_from_mesh = m;
  }
  void show(InstanceId id, bool shown) {
    world.setShown(id, shown);
    told.at(id.value).shown = shown;
  }

  // All that is shown, exactly if points of meshes and matrices have few binary digits. ids: by ObjectId.
  Scene scene(std::vector<InstanceId>& ids) const {
    Scene scene;
    for (const Shape& shape : shapes) {
      scene.materials.push_back({"", shape.settings.opacity, shape.settings.double_sided, {}});
    }
    for (const auto& [id, instance] : told) {
      if (!instance.shown) {
        continue;
      }
      const Shape& shape = shapes[instance.shape];
      Object object;
      object.first_index = static_cast<std::uint32_t>(scene.indices.size());
      object.index_count = static_cast<std::uint32_t>(shape.corners.size());
      object.material = MaterialId(instance.shape);
      const bool mirrored = determinant3(instance.world_from_mesh) < 0.0;
      for (std::size_t i = 0; i < shape.corners.size(); ++i) {
        const std::size_t from = !mirrored || i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1;
        const Vec3d at = transformPoint(instance.world_from_mesh, Vec3d(shape.corners[from]));
        scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
        scene.positions.emplace_back(at);
        EXPECT_EQ(Vec3d(scene.positions.back()), at) << "not exact";
      }
      scene.objects.push_back(object);
      ids.emplace_back(id);
    }
    updateBounds(scene);
    return scene;
  }
};

struct Judged {
  std::size_t seen = 0, culled = 0;
};

// Fails for whatever the culler left out and is not proved hidden.
inline Judged judge(const Story& story, const View& view, const WorldCuller& culler,
                    const std::string& where) {
  std::vector<InstanceId> ids;
  const Scene scene = story.scene(ids);
  const ExactVisibility exact(scene.view());
  std::vector<ObjectId> left_out;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t id = ids[i].value;
    const bool kept = (culler.visibleBits()[id / 64] >> (id % 64) & 1) != 0;
    EXPECT_EQ(kept, std::binary_search(culler.visible().begin(), culler.visible().end(), ids[i]));
    if (!kept) {
      left_out.emplace_back(i);
    }
  }
  const Judged judged{exact.visibleThroughPixels(view, 64, 36).size(), left_out.size()};
  const std::vector<Decision> decisions = exact.decide(view, left_out, 20'000);
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    EXPECT_EQ(decisions[i].verdict, Verdict::kHidden)
        << "instance " << ids[left_out[i].value].value << " was culled, " << where;
  }
  return judged;
}

// Numbers and placements of few binary digits.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : engine_(seed), number_(test::numbersFrom<double>(engine_)) {}

  double number(double low, double high) { return number_(low, high); }
  double eighths(double low, double high) { return std::floor(8.0 * number_(low, high)) / 8.0; }
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(engine_() % bound); }

  // Axes in any order and any sense, stretched by powers of two.
  Mat4 placement(double spread, double height) {
    std::array<int, 3> axes{0, 1, 2};
    std::shuffle(axes.begin(), axes.end(), engine_);
    Mat4 m;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) {
        m(row, column) = 0.0;
      }
      m(axes[static_cast<std::size_t>(column)], column) =
          (below(2) == 0 ? 1.0 : -1.0) * std::ldexp(1.0, static_cast<int>(below(5)) - 1);
    }
    m(0, 3) = eighths(-spread, spread);
    m(1, 3) = eighths(0.0, height);
    m(2, 3) = eighths(-spread, spread);
    return m;
  }

 private:
  std::mt19937 engine_;
  decltype(test::numbersFrom<double>(std::declval<std::mt19937&>())) number_;
};

}  // namespace sightline::world_story
