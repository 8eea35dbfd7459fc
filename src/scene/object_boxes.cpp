#include "sightline/scene/object_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "src/math/outer_box.h"
#include "src/scene/cell_grid.h"
#include "src/scene/grid_divisions.h"
#include "src/scene/like_objects.h"

namespace sightline {
namespace {

using scene::CellGrid;
using scene::DivisionTree;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A part of a triangle between planes across the axes: a convex polygon.
class Piece {
 public:
  void reset(std::span<const Vec3f, 3> triangle) {
    count_ = 3;
    std::transform(triangle.begin(), triangle.end(), corners_.begin(),
                   [](const Vec3f& p) { return Vec3d(p); });
  }
  std::span<const Vec3d> corners() const { return std::span(corners_).first(count_); }
  // Keeps what lies on one side of a plane across the axis: above it where sign is 1, below it where it is -1
  // (Sutherland, Hodgman 1974).
  void clip(int axis, double plane, double sign) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3d& a = corners_[i];
      const Vec3d& b = corners_[i + 1 < count_ ? i + 1 : 0];
      const double da = (a[axis] - plane) * sign, db = (b[axis] - plane) * sign;
      if (da >= 0.0) {
        clipped_[kept++] = a;
      }
      if ((da >= 0.0) != (db >= 0.0)) {
        clipped_[kept++] = a + (b - a) * (da / (da - db));
      }
    }
    std::copy_n(clipped_.begin(), kept, corners_.begin());
    count_ = kept;
  }

 private:
  // With rounding, a polygon may cross a plane at every other corner, so that each of six planes leaves at
  // most half as many corners more: 3, 4, 6, 9, 13, 19, 28.
  static constexpr std::size_t kMost = 28;

  std::array<Vec3d, kMost> corners_, clipped_;
  std::size_t count_ = 0;
};

// A plane that divides a box, and how its halves are divided: indices into the object's cuts.
struct Cut {
  static constexpr std::uint32_t kNone = ~0u;

  int axis = 0;
  float plane = 0.0f;
  std::uint32_t corner = kNone;  // one of those that lie in the plane; corners are counted by triangle
  std::array<std::uint32_t, 2> halves{kNone, kNone};  // kNone: it is not divided
};

// The first one divides the object's box; none: it is not divided.
using Cuts = std::vector<Cut>;

// Finds the boxes of one object: in a grid of cells how to divide its box, and then the boxes around the
// parts of its triangles.
class Divider {
 public:
  explicit Divider(const ObjectBoxesSettings& settings)
      : max_boxes_(std::clamp(settings.max_boxes, 1u, kMaxObjectBoxes)),
        min_saving_(std::max(settings.min_saving, 0.0)) {}

  // Sets `cuts` to those by which the object's box is divided, and appends its boxes to out; nothing if one
  // is enough.
  void divide(const SceneView& scene, const Object& object, Cuts& cuts, std::vector<Box>& out);
  // Does the same with the cuts of an object like this one, moved to it.
  void divideLike(const SceneView& scene, const Object& object, const Object& other, const Cuts& cuts,
                  std::vector<Box>& out);

 private:
  std::span<const Vec3f, 3> triangle(std::uint32_t t) const {
    return std::span<const Vec3f, 3>(&corners_[3 * std::size_t{t}], 3);
  }
  Vec3d doubledArea(std::uint32_t t) const {
    const Vec3d a(triangle(t)[0]);
    return cross(Vec3d(triangle(t)[1]) - a, Vec3d(triangle(t)[2]) - a);
  }
  // Reads the triangles. False if they have no box, or one of which nothing can be said.
  bool read(const SceneView& scene, const Object& object);
  // Whether triangles fill all sides of the object's box: then no division saves volume.
  bool fillsItsBox() const;
  // What the part of a triangle in a box reaches, at least.
  Box boundsWithin(const Box& box, std::uint32_t t);
  // Which triangles of a list have parts in this half of a box, and a box around those; appends them to
  // lists_.
  Box halve(std::size_t begin, std::size_t end, const Box& half, const Cut& cut, bool upper);
  // Appends the cuts by which a node of divisions_ becomes `count` boxes. Returns the number of the first.
  std::uint32_t appendCuts(std::uint32_t n, std::uint32_t count, Cuts& cuts) const;
  // Appends the boxes around the parts of all triangles.
  void appendBoxes(const Cuts& cuts, std::vector<Box>& out);
  // Does so for those listed from `begin` on, in a box that is divided by a cut and others below it.
  void append(const Cuts& cuts, std::uint32_t cut, const Box& box, std::size_t begin, std::vector<Box>& out);

  std::uint32_t max_boxes_;
  double min_saving_;
  std::vector<Vec3f> corners_;  // three for each triangle of the object
  std::vector<Box> bounds_;     // by triangle of the object
  Box box_{};                   // of the object
  double slack_ = 0.0;          // more than any rounding of a piece's corners
  DivisionTree divisions_;
  Piece piece_;
  std::vector<std::uint32_t> lists_, cut_;  // of triangles
  Cuts moved_;
};

bool Divider::read(const SceneView& scene, const Object& object) {
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  const std::size_t triangles = object.triangleCount();
  corners_.resize(3 * triangles);
  bounds_.assign(triangles, {});
  box_ = {};
  bool finite = true;
  for (std::size_t t = 0; t < triangles; ++t) {
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
      corners_[k] = scene.positions[indices[k]];
      finite = finite && isFinite(corners_[k]);
      bounds_[t].extend(corners_[k]);
    }
    box_.extend(bounds_[t]);
  }
  return finite && triangles > 0;
}

bool Divider::fillsItsBox() const {
  // By side: twice the area of the triangles in it that face one way, and of the others. Both layers of a
  // panel fill no more than one.
  std::array<std::array<double, 2>, 6> filled{};
  for (std::uint32_t t = 0; t < bounds_.size(); ++t) {
    const Box& flat = bounds_[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (flat.min[axis] != flat.max[axis]) {
        continue;
      }
      const double area = doubledArea(t)[axis];
      const std::size_t way = area < 0.0 ? 1 : 0;
      filled[2 * axis][way] += flat.min[axis] == box_.min[axis] ? std::abs(area) : 0.0;
      filled[2 * axis + 1][way] += flat.min[axis] == box_.max[axis] ? std::abs(area) : 0.0;
    }
  }
  const Vec3d extent = Vec3d(box_.max) - Vec3d(box_.min);
  for (int axis = 0; axis < 3; ++axis) {
    const double side = 2.0 * extent[(axis + 1) % 3] * extent[(axis + 2) % 3] * (1.0 - 1e-6);
    const auto& [low, high] = std::tie(filled[2 * axis], filled[2 * axis + 1]);
    if (std::max(low[0], low[1]) < side || std::max(high[0], high[1]) < side) {
      return false;
    }
  }
  return true;
}

Box Divider::boundsWithin(const Box& box, std::uint32_t t) {
  piece_.reset(triangle(t));
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - slack_, high = box.max[axis] + slack_;
    if (bounds_[t].min[axis] < low) {
      piece_.clip(axis, low, 1.0);
    }
    if (bounds_[t].max[axis] > high) {
      piece_.clip(axis, high, -1.0);
    }
  }
  Vec3d min{kInfinity, kInfinity, kInfinity}, max{-kInfinity, -kInfinity, -kInfinity};
  for (const Vec3d& corner : piece_.corners()) {
    min = sightline::min(min, corner);
    max = sightline::max(max, corner);
  }
  const Vec3d slack(slack_, slack_, slack_);
  return piece_.corners().empty() ? Box{} : intersection(math::outerBox(min - slack, max + slack), box);
}

Box Divider::halve(std::size_t begin, std::size_t end, const Box& half, const Cut& cut, bool upper) {
  const auto& [axis, plane] = std::tie(cut.axis, cut.plane);
  Box box;
  cut_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t t = lists_[i];
    const Box& bounds = bounds_[t];
    // What touches the plane from the other side does not belong here. What lies in it bounds a solid, so it
    // goes to the half behind it.
    const bool in_plane = bounds.min[axis] == plane && bounds.max[axis] == plane;
    const bool elsewhere = in_plane ? upper == (doubledArea(t)[axis] > 0.0)
                           : upper  ? bounds.max[axis] <= plane
                                    : bounds.min[axis] >= plane;
    if (elsewhere) {
      continue;
    }
    if (contains(half, bounds)) {
      box.extend(bounds);
      lists_.push_back(t);
    } else {
      cut_.push_back(t);
    }
  }
  for (const std::uint32_t t : cut_) {
    // No more is known of it than its bounds, as long as all that they have in the half is in the box anyway.
    const Box most = intersection(half, bounds_[t]);
    const Box reached = most.empty() || contains(box, most) ? most : boundsWithin(half, t);
    if (!reached.empty()) {
      box.extend(reached);
      lists_.push_back(t);
    }
  }
  return box;
}

std::uint32_t Divider::appendCuts(std::uint32_t n, std::uint32_t count, Cuts& cuts) const {
  const DivisionTree::Node& node = divisions_.nodes[n];
  const std::uint32_t in_first = node.in_first[count];
  if (in_first == 0) {
    return Cut::kNone;
  }
  const auto in_plane = std::find_if(corners_.begin(), corners_.end(),
                                     [&](const Vec3f& corner) { return corner[node.axis] == node.plane; });
  const auto number = static_cast<std::uint32_t>(cuts.size());
  cuts.push_back({.axis = node.axis, .plane = node.plane});
  if (in_plane != corners_.end()) {
    cuts[number].corner = static_cast<std::uint32_t>(in_plane - corners_.begin());
  }
  const std::uint32_t first = appendCuts(node.first_half, in_first, cuts),
                      second = appendCuts(node.first_half + 1, count - in_first, cuts);
  cuts[number].halves = {first, second};
  return number;
}

void Divider::append(const Cuts& cuts, std::uint32_t number, const Box& box, std::size_t begin,
                     std::vector<Box>& out) {
  if (number == Cut::kNone) {
    out.push_back(box);
    return;
  }
  const Cut& cut = cuts[number];
  const std::size_t end = lists_.size();
  for (std::uint32_t h = 0; h < 2; ++h) {
    Box half = box;
    float& side = (h == 0 ? half.max : half.min)[cut.axis];
    side = h == 0 ? std::min(side, cut.plane) : std::max(side, cut.plane);
    const Box part = halve(begin, end, half, cut, h == 1);
    if (!part.empty()) {
      append(cuts, cut.halves[h], part, end, out);
    }
    lists_.resize(end);
  }
}

void Divider::appendBoxes(const Cuts& cuts, std::vector<Box>& out) {
  slack_ = std::ldexp(maxComponent(max(abs(Vec3d(box_.min)), abs(Vec3d(box_.max)))), -44);
  lists_.resize(bounds_.size());
  std::iota(lists_.begin(), lists_.end(), 0u);
  const std::size_t before = out.size();
  append(cuts, 0, box_, 0, out);
  if (out.size() < before + 2) {
    out.resize(before);
  }
}

void Divider::divide(const SceneView& scene, const Object& object, Cuts& cuts, std::vector<Box>& out) {
  cuts.clear();
  if (max_boxes_ < 2 || !object.bounds.wellFormed() || !read(scene, object) || fillsItsBox()) {
    return;
  }
  const CellGrid grid(box_, corners_);
  // For a mesh of few triangles, more divisions gain little and would take most of the time.
  const bool many = bounds_.size() >= scene::kManyTriangles;
  scene::findDivisions(grid,
                       {.max_boxes = max_boxes_,
                        .min_saving = min_saving_,
                        .max_divided = many ? DivisionTree::kMaxDivided : DivisionTree::kMaxDivided / 2},
                       divisions_);
  if (divisions_.boxes > 1) {
    appendCuts(0, divisions_.boxes, cuts);
    appendBoxes(cuts, out);
  }
}

void Divider::divideLike(const SceneView& scene, const Object& object, const Object& other, const Cuts& cuts,
                         std::vector<Box>& out) {
  if (cuts.empty() || !read(scene, object)) {
    return;
  }
  moved_ = cuts;
  for (Cut& cut : moved_) {
    const double place = double{cut.plane} - other.bounds.min[cut.axis];
    cut.plane = cut.corner != Cut::kNone ? corners_[cut.corner][cut.axis]
                                         : static_cast<float>(object.bounds.min[cut.axis] + place);
  }
  appendBoxes(moved_, out);
}

}  // namespace

bool areBoxesOf(std::span<const Box> boxes, const Box& bounds) {
  Box around;
  for (const Box& box : boxes) {
    around.extend(box);
  }
  return boxes.size() <= kMaxObjectBoxes && bounds.wellFormed() && around == bounds &&
         std::all_of(boxes.begin(), boxes.end(), [](const Box& box) { return box.wellFormed(); });
}

ObjectBoxes findObjectBoxes(const SceneView& scene, const ObjectBoxesSettings& settings,
                            const ParallelFor& parallel_for) {
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  std::vector<std::vector<Box>> of_object(count);
  const std::vector<std::uint32_t> like = scene::findLikeObjects(scene, parallel_for);
  std::vector<Cuts> cuts(count);  // of objects that are like none before
  const auto forObjects = [&](const auto& divide) {
    parallel_for(count, [&](std::uint32_t begin, std::uint32_t end) {
      Divider divider(settings);
      for (std::uint32_t i = begin; i < end; ++i) {
        divide(divider, i);
      }
    });
  };
  forObjects([&](Divider& divider, std::uint32_t i) {
    if (like[i] == i) {
      divider.divide(scene, scene.objects[i], cuts[i], of_object[i]);
    }
  });
  forObjects([&](Divider& divider, std::uint32_t i) {
    if (like[i] != i) {
      divider.divideLike(scene, scene.objects[i], scene.objects[like[i]], cuts[like[i]], of_object[i]);
    }
  });
  ObjectBoxes found;
  found.first.reserve(std::size_t{count} + 1);
  found.first.push_back(0);
  for (const std::vector<Box>& boxes : of_object) {
    for (const Box& box : boxes) {
      found.boxes.push_back(widened(box, settings.margin));
    }
    found.first.push_back(static_cast<std::uint32_t>(found.boxes.size()));
  }
  return found;
}

}  // namespace sightline
