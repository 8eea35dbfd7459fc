#pragma once

// A World that changes, told a second time as a scene of triangles that exact visibility judges.

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
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

// Scales a box of 1 m to this size, from this corner.
inline Mat4 boxAt(const Vec3d& corner, const Vec3d& size) {
  Mat4 m;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, axis) = size[axis];
    m(axis, 3) = corner[axis];
  }
  return m;
}

// The panel is in the plane z = 0, with its front towards +z.
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

// The matrix of what is put elsewhere by a vector.
inline Mat4 movedBy(Mat4 world_from_mesh, const Vec3d& by) {
  for (int axis = 0; axis < 3; ++axis) {
    world_from_mesh(axis, 3) += by[axis];
  }
  return world_from_mesh;
}

struct Told {
  std::size_t shape = 0;
  Mat4 world_from_mesh;
  bool shown = true;
};

// What is there by InstanceId, to be judged as triangles.
struct ToldScene {
  std::vector<Shape> shapes;
  std::map<std::uint32_t, Told> told{};

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
      }
      scene.objects.push_back(object);
      ids.emplace_back(id);
    }
    updateBounds(scene);
    return scene;
  }
};

// A world that is told while it changes.
struct Story : ToldScene {
  World world;
  std::vector<MeshId> meshes;  // by shape

  explicit Story(std::vector<Shape> given) : ToldScene{std::move(given)} {
    for (const Shape& shape : shapes) {
      meshes.push_back(addShape(world, shape));
    }
  }
  InstanceId add(std::size_t shape, const Mat4& m, bool shown = true) {
    const InstanceId id = world.add(
        {.mesh = meshes[shape], .world_from_mesh = m, .shown = shown, .moves = world.idBound() % 3 == 0});
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
};

inline bool keeps(const WorldCuller& culler, InstanceId id) {
  return std::binary_search(culler.visible().begin(), culler.visible().end(), id);
}

struct Judged {
  std::size_t culled = 0;  // by the first culler
  std::string wrong;       // what was culled and is not proved hidden; empty: nothing
};

// Proves in exact arithmetic that whatever is shown and was left out by any of the cullers, all of one view,
// is hidden.
inline Judged judge(const ToldScene& told, const View& view,
                    std::initializer_list<const WorldCuller*> cullers) {
  std::vector<InstanceId> ids;
  const Scene scene = told.scene(ids);
  const ExactVisibility exact(scene.view());
  std::vector<ObjectId> left_out;
  Judged judged;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t id = ids[i].value;
    bool all_keep = true;
    for (const WorldCuller* culler : cullers) {
      const bool kept = (culler->visibleBits()[id / 64] >> (id % 64) & 1) != 0;
      if (kept != keeps(*culler, ids[i]) || kept != culler->isVisible(ids[i])) {
        judged.wrong += "the bit of instance " + std::to_string(id) + " is not what the list says; ";
      }
      all_keep = all_keep && kept;
      judged.culled += !kept && culler == *cullers.begin() ? 1 : 0;
    }
    if (!all_keep) {
      left_out.emplace_back(i);
    }
  }
  const std::vector<Decision> decisions = exact.decide(view, left_out, 20'000);
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (decisions[i].verdict == Verdict::kHidden) {
      continue;
    }
    const InstanceId id = ids[left_out[i].value];
    judged.wrong += "instance " + std::to_string(id.value) +
                    (decisions[i].verdict == Verdict::kVisible ? " can be seen" : " is undecided");
    for (std::size_t c = 0; c < cullers.size(); ++c) {
      judged.wrong += keeps(*cullers.begin()[c], id) ? "" : ", left out by culler " + std::to_string(c);
    }
    judged.wrong += "; ";
  }
  return judged;
}

inline Judged judge(const ToldScene& told, const View& view, const WorldCuller& culler) {
  return judge(told, view, {&culler});
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

inline View viewFrom(const Vec3d& eye, const Vec3d& forward) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, {0, 1, 0});
  view.z_near = 0.0625;
  view.z_far = 500.0;
  return view;
}

inline std::vector<Shape> allShapes() {
  return {boxShape(), panelShape(false), panelShape(true), groundShape(),
          panelShape(true, Opacity::kBlended)};
}

// Changes of all kinds, and a camera that walks and jumps.
struct RandomStory {
  Chance chance;
  Story story{allShapes()};
  std::vector<InstanceId> ids;
  std::vector<JoinId> joins;
  Vec3d eye;
  double heading = 0.0;

  RandomStory(std::uint32_t seed, std::uint32_t instances) : chance(seed) {
    for (std::uint32_t i = 0; i < instances; ++i) {
      add();
    }
    eye = {chance.eighths(-5, 5), 1.5, chance.eighths(-5, 5)};
    heading = chance.number(0.0, 6.0);
  }

  void add() { ids.push_back(story.add(chance.below(5), chance.placement(20.0, 6.0), chance.below(4) != 0)); }
  std::size_t any() { return chance.below(static_cast<std::uint32_t>(ids.size())); }

  void change() {
    const std::size_t which = any();
    const std::uint32_t kind = chance.below(8);
    if (kind == 0 && ids.size() < 100) {
      add();
    } else if (kind == 1 && ids.size() > 20) {
      story.remove(ids[which]);
      ids[which] = ids.back();
      ids.pop_back();
    } else if (kind == 2) {
      story.show(ids[which], chance.below(2) == 0);
    } else if (kind == 3 && joins.size() < 8) {
      std::vector<InstanceId> some;
      for (const InstanceId id : ids) {
        if (chance.below(2) == 0) {
          some.push_back(id);
        }
      }
      joins.push_back(story.world.addJoin(makeJoin(story.world.joinInput(some))));
    } else if (kind == 4 && !joins.empty()) {
      const std::size_t dropped = chance.below(static_cast<std::uint32_t>(joins.size()));
      story.world.removeJoin(joins[dropped]);
      joins[dropped] = joins.back();
      joins.pop_back();
    } else {
      Mat4 m = story.told.at(ids[which].value).world_from_mesh;
      m(0, 3) += chance.eighths(-1.0, 1.0);
      m(2, 3) += chance.eighths(-1.0, 1.0);
      story.move(ids[which], chance.below(8) == 0 || std::abs(m(0, 3)) > 30.0 || std::abs(m(2, 3)) > 30.0
                                 ? chance.placement(20.0, 6.0)
                                 : m);
    }
  }

  // A frame: some changes, and the next view.
  View next() {
    for (std::uint32_t changes = chance.below(6); changes > 0; --changes) {
      change();
    }
    story.world.tidy(chance.below(100));
    if (chance.below(24) == 0) {
      story.world.setOrigin(
          {chance.eighths(-500.0, 500.0), chance.eighths(-9.0, 9.0), chance.eighths(-500.0, 500.0)});
    }
    const auto stay = [](double x) { return std::clamp(x, -25.0, 25.0); };
    eye = {stay(eye.x + chance.eighths(-0.5, 0.5)), 1.5, stay(eye.z + chance.eighths(-0.5, 0.5))};
    heading += chance.number(-0.1, 0.1) + (chance.below(16) == 0 ? 2.5 : 0.0);
    return viewFrom(eye, {std::sin(heading), 0.0, std::cos(heading)});
  }
};

}  // namespace sightline::world_story
