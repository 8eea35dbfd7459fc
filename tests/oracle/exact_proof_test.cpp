// What the exact verifier proves of objects and of their bounding boxes, against brute force in whole
// numbers. The coordinates are small integers, and many corners lie on common lines of sight, so that most
// cases are ties.

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "oracle/exact_visibility.h"
#include "tests/support/exact_sight.h"
#include "tests/support/hand_made.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace hand_made;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kPlentyOfSteps = 4000;

struct Family {
  const char* name;
  int cases = 120;
  int min_z = -6, max_z = -1;  // of the corners; the eye is near the origin and looks along -z
  int half_extent = 3;
  int nearest_cover = -1;                  // its z
  int max_objects = 5, max_triangles = 1;  // of each object
  bool orthographic = false;
  bool eye_on_grid = false;  // else at the origin
  bool oblique = false;
  bool odd_materials = false;
  bool broken = false;  // triangles without area or with coordinates that are not finite
  std::vector<double> near{0.5}, far{100.0};
  std::vector<double> tangents{4.0}, aspects{1.0};
  std::vector<double> shifts{0.0};  // multiples of 1/64
};

std::string described(const Scene& scene, const View& view) {
  std::ostringstream text;
  text.precision(17);
  text << (view.orthographic ? "orthographic " : "perspective ") << "eye " << view.eye.x << ' ' << view.eye.y
       << ' ' << view.eye.z << " forward " << view.forward.x << ' ' << view.forward.y << ' ' << view.forward.z
       << " near " << view.z_near << " far " << view.z_far << " tan " << view.tan_half_fovy << " height "
       << view.ortho_height << " aspect " << view.aspect << " shift " << view.shift_x << ' ' << view.shift_y;
  for (const Object& object : scene.objects) {
    const Material& material = scene.view().materialOf(object);
    text << "\nobject" << (material.opaque() ? "" : " see-through")
         << (material.double_sided ? " double" : "");
    for (const std::uint32_t i : scene.view().indicesOf(object)) {
      const Vec3f& p = scene.positions[i];
      text << " (" << p.x << ' ' << p.y << ' ' << p.z << ')';
    }
  }
  return text.str();
}

class Maker {
 public:
  Maker(const Family& family, std::uint32_t seed) : family_(family), random_(seed) {}

  Scene scene() {
    Scene made;
    for (const Opacity opacity : {Opacity::kOpaque, Opacity::kBlended}) {
      for (const bool double_sided : {false, true}) {
        addMaterial(made, opacity, double_sided);
      }
    }
    makePool();
    if (below(4) != 0) {
      addCover(made);
    }
    const int objects = 2 + below(family_.max_objects - 1);
    for (int o = 0; o < objects; ++o) {
      std::vector<Vec3f> corners;
      const int triangles = 1 + below(family_.max_triangles);
      for (int t = 0; t < triangles; ++t) {
        addTriangleTo(corners);
      }
      const int material = family_.odd_materials ? below(4) : 1;
      addTriangles(made, MaterialId(static_cast<std::uint32_t>(material)), corners);
    }
    if (made.positions.size() > 3 && below(4) == 0) {
      weldPositions(made);
    }
    return made;
  }

  View view() {
    View view = frontView();
    view.orthographic = family_.orthographic;
    view.z_near = oneOf(family_.near);
    view.z_far = oneOf(family_.far);
    view.tan_half_fovy = oneOf(family_.tangents);
    view.ortho_height = 2.0 * oneOf(family_.tangents);
    view.aspect = oneOf(family_.aspects);
    view.shift_x = oneOf(family_.shifts);
    view.shift_y = oneOf(family_.shifts);
    if (family_.eye_on_grid) {
      view.eye = Vec3d(grid(family_.half_extent), grid(family_.half_extent), grid(2));
    }
    if (family_.oblique) {
      setOrientation(view, {static_cast<double>(grid(2)), static_cast<double>(grid(2)), -4.0},
                     {static_cast<double>(grid(1)), 1.0, 0.0});
    }
    return view;
  }

  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }
  int grid(int extent) { return below(2 * extent + 1) - extent; }

 private:
  double oneOf(const std::vector<double>& values) {
    return values[static_cast<std::size_t>(below(static_cast<int>(values.size())))];
  }

  // Points, others on their lines of sight from the origin, and points between them.
  void makePool() {
    pool_.clear();
    const auto add = [&](int x, int y, int z) {
      if (z >= family_.min_z && z <= family_.max_z) {
        pool_.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
      }
    };
    const int count = 4 + below(5);
    for (int i = 0; i < count; ++i) {
      const int x = grid(family_.half_extent), y = grid(family_.half_extent),
                z = family_.min_z + below(family_.max_z - family_.min_z + 1);
      add(x, y, z);
      if (family_.orthographic) {
        add(x, y, z + grid(2));
      } else {
        add(2 * x, 2 * y, 2 * z);
        add(3 * x, 3 * y, 3 * z);
        if (x % 2 == 0 && y % 2 == 0 && z % 2 == 0) {
          add(x / 2, y / 2, z / 2);
        }
      }
    }
  }

  // Triangles around one point, each perhaps an object of its own, that may leave a gap.
  void addCover(Scene& made) {
    const auto extent = static_cast<float>(family_.half_extent - 1 + below(3));
    const int nearest = family_.nearest_cover - below(2);
    Vec3f middle = fromPool();
    if (below(2) == 0) {
      middle.z = static_cast<float>(nearest);
    }
    std::vector<Vec3f> around;
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
      const auto z = static_cast<float>(nearest - below(2));
      around.emplace_back(static_cast<float>(x) * extent, static_cast<float>(y) * extent, z);
    }
    std::vector<Vec3f> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      if (below(10) != 0) {
        corners.insert(corners.end(), {around[i], around[(i + 1) % 4], middle});
      }
      if (below(3) == 0 || i == 3) {
        addTriangles(made, MaterialId(1u), corners);
        corners.clear();
      }
    }
  }

  Vec3f fromPool() { return pool_[static_cast<std::size_t>(below(static_cast<int>(pool_.size())))]; }

  void addTriangleTo(std::vector<Vec3f>& corners) {
    const auto otherThan = [&](const Vec3f& a, const Vec3f& b) {
      Vec3f c = fromPool();
      for (int i = 0; i < 10 && cross(b - a, c - a) == Vec3f{}; ++i) {
        c = fromPool();
      }
      return c;
    };
    Vec3f a = fromPool(), b = otherThan(a, a + Vec3f(1, 2, 5)), c = otherThan(a, b);
    if (family_.broken && below(4) == 0) {
      const int kind = below(4);
      c = kind == 0 ? a : kind == 1 ? a + (b - a) * 2.0f : c;
      b.y = kind == 2 ? std::nanf("") : b.y;
      b.x = kind == 3 ? std::numeric_limits<float>::infinity() : b.x;
    } else if (below(3) == 0) {
      const auto half = [](float x, float y) { return std::floor((x + y) / 2.0f); };
      c = {half(a.x, c.x), half(a.y, c.y), half(a.z, c.z)};
    }
    corners.insert(corners.end(), {a, b, c});
    if (below(6) == 0) {
      corners.insert(corners.end(), {a, c, b});
    }
  }

  const Family& family_;
  std::mt19937 random_;
  std::vector<Vec3f> pool_;
};

std::vector<ObjectId> allObjects(const Scene& scene) {
  std::vector<ObjectId> all;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    all.emplace_back(o);
  }
  return all;
}

struct Counts {
  int visible = 0, occluded = 0, not_shown = 0;  // the last: outside the view, or with nothing that is drawn
};

Scene only(const Scene& scene, ObjectId object) {
  Scene alone = scene;
  for (std::uint32_t o = 0; o < alone.objects.size(); ++o) {
    alone.objects[o].index_count = o == object.value ? alone.objects[o].index_count : 0;
  }
  return alone;
}

// Expects the same verdicts of both, and that both agree about witnesses and random points.
void compare(const Scene& scene, const View& view, Maker& maker, Counts& counts, const std::string& where) {
  const bool has_round_axes =
      maxComponent(abs(view.forward)) == 1.0;  // else the borders of the view are rounded
  const test::ExactSight sight(scene.view(), view);
  const ExactVisibility oracle(scene.view());
  const std::vector<ObjectId> all = allObjects(scene);
  const std::vector<Decision> decisions = oracle.decide(view, all, kPlentyOfSteps);
  for (const ObjectId object : all) {
    const bool visible = sight.isVisible(object);
    const bool occluded = !visible && test::ExactSight(only(scene, object).view(), view).isVisible(object);
    (visible ? counts.visible : occluded ? counts.occluded : counts.not_shown) += 1;
    const Decision& decision = decisions[object.value];
    EXPECT_EQ(decision.verdict, visible ? Verdict::kVisible : Verdict::kHidden)
        << where << " object " << object.value << '\n'
        << described(scene, view);
    if (decision.verdict == Verdict::kVisible && has_round_axes) {
      EXPECT_EQ(oracle.confirm(view, decision.witness), sight.reaches(decision.witness.point, object))
          << where << " witness of object " << object.value << '\n'
          << described(scene, view);
    }
    for (int i = 0; i < 4 && has_round_axes; ++i) {
      const Vec3d point = view.eye + Vec3d(maker.grid(4), maker.grid(4), maker.grid(8)) * 0.5;
      EXPECT_EQ(oracle.confirm(view, {object, point}), sight.reaches(point, object))
          << where << " object " << object.value << " at " << point.x << ' ' << point.y << ' ' << point.z
          << '\n'
          << described(scene, view);
    }
  }
}

// The sides of the object's bounding box as an object of its own through which one sees; and the section of
// the near plane, for views along -z.
ObjectId addBoxInView(Scene& scene, const View& view, ObjectId object) {
  const Box box = scene.objects[object.value].bounds;
  const auto near = static_cast<float>(view.eye.z - view.z_near);
  std::vector<Vec3f> corners;
  const auto addRectangle = [&](int axis, float at) {
    const int i = (axis + 1) % 3;
    Vec3f a = box.min, b = box.min, c = box.max, d = box.max;
    b[i] = box.max[i];
    d[i] = box.min[i];
    a[axis] = b[axis] = c[axis] = d[axis] = at;
    corners.insert(corners.end(), {a, b, c, a, c, d});
  };
  for (int axis = 0; axis < 3; ++axis) {
    addRectangle(axis, box.min[axis]);
    addRectangle(axis, box.max[axis]);
  }
  if (view.forward.z == -1.0 && box.min.z < near && near < box.max.z) {
    addRectangle(2, near);
  }
  return addTriangles(scene, MaterialId(3u), corners);  // see-through, double-sided
}

// Whether triangles can show all that is visible of the box: not where rays start in it and the section of
// the near plane is rounded, or where they start at the eye.
bool trianglesShow(const Box& box, const View& view) {
  bool beyond_near = true, has_eye = true;
  for (int axis = 0; axis < 3; ++axis) {
    has_eye = has_eye && box.min[axis] <= view.eye[axis] && view.eye[axis] <= box.max[axis];
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                  (corner & 4) != 0 ? box.max.z : box.min.z);
    beyond_near = beyond_near && dot(p - view.eye, view.forward) > view.z_near * (1.0 + 1e-9);
  }
  const bool has_round_axes = maxComponent(abs(view.forward)) == 1.0;
  return beyond_near || (has_round_axes && (view.orthographic || view.z_near > 0.0 || !has_eye));
}

// Expects of the bounding box of each object what brute force says of a box that is made of triangles.
void compareBoxes(const Scene& scene, const View& view, Counts& counts, const std::string& where) {
  const ExactVisibility oracle(scene.view());
  const std::vector<ObjectId> all = allObjects(scene);
  const std::vector<Decision> decisions = oracle.decideBoxes(view, all, kPlentyOfSteps);
  for (const ObjectId object : all) {
    if (!trianglesShow(scene.objects[object.value].bounds, view)) {
      continue;
    }
    Scene with_box = scene;
    const ObjectId shown = addBoxInView(with_box, view, object);
    const bool visible = test::ExactSight(with_box.view(), view).isVisible(shown);
    const bool occluded = !visible && test::ExactSight(only(with_box, shown).view(), view).isVisible(shown);
    (visible ? counts.visible : occluded ? counts.occluded : counts.not_shown) += 1;
    EXPECT_EQ(decisions[object.value].verdict, visible ? Verdict::kVisible : Verdict::kHidden)
        << where << " box of object " << object.value << '\n'
        << described(scene, view);
  }
}

const Family kFamilies[] = {
    {.name = "Mixed"},
    {.name = "InFewPlanes", .min_z = -4, .max_z = -3, .nearest_cover = -2},
    {.name = "ManyTriangles", .max_objects = 3, .max_triangles = 4},
    {.name = "OddMaterials", .max_objects = 6, .odd_materials = true},
    {.name = "EyeInPlanes", .eye_on_grid = true, .near = {0.0, 0.25}},
    {.name = "BehindTheEye",
     .min_z = -6,
     .max_z = 1,
     .half_extent = 2,

     .max_triangles = 2,
     .odd_materials = true,
     .near = {0.0, 0.5, 1.0}},
    {.name = "NearPlane", .max_triangles = 2, .near = {1.0, 2.0, 3.0}, .far = {6.0, 5.0}},
    {.name = "FarPlane", .far = {2.0, 3.0, 4.0, kInfinity}},
    {.name = "Borders", .tangents = {0.5, 1.0, 0.25}, .aspects = {0.5, 1.0, 2.0}},
    {.name = "Broken", .max_triangles = 3, .odd_materials = true, .broken = true},
    {.name = "Oblique", .oblique = true},
    {.name = "Orthographic", .orthographic = true},
    {.name = "OrthographicPlanes",
     .min_z = -4,
     .max_z = 0,
     .half_extent = 2,
     .max_triangles = 2,
     .orthographic = true,
     .odd_materials = true,
     .near = {0.0, 1.0},
     .far = {3.0, 4.0}},
    {.name = "OrthographicBorders",
     .orthographic = true,
     .eye_on_grid = true,
     .tangents = {1.0, 2.0},
     .aspects = {0.5, 1.0}},
    {.name = "OffCentre",
     .tangents = {1.0, 2.0},
     .aspects = {0.5, 1.0},
     .shifts = {0.0, -0.5, 0.75, 1.0, -2.0}},
    {.name = "OrthographicOffCentre",
     .orthographic = true,
     .eye_on_grid = true,
     .tangents = {1.0, 2.0},
     .aspects = {0.5, 1.0},
     .shifts = {0.0, -0.5, 0.75, 1.0, -2.0}},
    {.name = "OrthographicOblique", .orthographic = true, .oblique = true, .tangents = {16.0}},
};

class ExactProof : public ::testing::TestWithParam<Family> {};

TEST_P(ExactProof, SaysWhatBruteForceSays) {
  const Family& family = GetParam();
  const int cases = test::rounds(family.cases);
  Counts counts;
  const auto first = static_cast<std::uint32_t>(GTEST_FLAG_GET(random_seed)) * 1'000'000u;
  for (int i = 0; i < cases && !HasFailure(); ++i) {
    const std::uint32_t seed = first + static_cast<std::uint32_t>(i);
    Maker maker(family, seed);
    const Scene scene = maker.scene();
    compare(scene, maker.view(), maker, counts, family.name + (" seed " + std::to_string(seed)));
  }
  RecordProperty("occluded", counts.occluded);
  EXPECT_GT(counts.visible, cases / 4);
  EXPECT_GT(counts.occluded, cases / 12)
      << counts.visible << " visible, " << counts.not_shown << " not shown";
}

INSTANTIATE_TEST_SUITE_P(Families, ExactProof, ::testing::ValuesIn(kFamilies),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Families whose coordinates are finite.
std::vector<Family> familiesForBoxes() {
  std::vector<Family> families;
  std::copy_if(std::begin(kFamilies), std::end(kFamilies), std::back_inserter(families),
               [](const Family& family) { return !family.broken; });
  return families;
}

class ExactBoxProof : public ::testing::TestWithParam<Family> {};

TEST_P(ExactBoxProof, SaysWhatBruteForceSaysOfBoundingBoxes) {
  const Family& family = GetParam();
  const int cases = test::rounds(family.cases / 2);  // brute force takes longer: a box has many triangles
  Counts counts;
  const auto first = static_cast<std::uint32_t>(GTEST_FLAG_GET(random_seed)) * 1'000'000u;
  for (int i = 0; i < cases && !HasFailure(); ++i) {
    const std::uint32_t seed = first + static_cast<std::uint32_t>(i);
    Maker maker(family, seed);
    const Scene scene = maker.scene();
    compareBoxes(scene, maker.view(), counts, family.name + (" seed " + std::to_string(seed)));
  }
  RecordProperty("occluded", counts.occluded);
  EXPECT_GT(counts.visible, cases / 4);
  // A few cases may have nothing hidden.
  EXPECT_TRUE(test::sanitized() || counts.occluded > cases / 20)
      << counts.visible << " visible, " << counts.not_shown << " not shown";
}

INSTANTIATE_TEST_SUITE_P(Families, ExactBoxProof, ::testing::ValuesIn(familiesForBoxes()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sightline
