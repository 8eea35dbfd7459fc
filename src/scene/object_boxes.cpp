#include "sightline/scene/object_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "src/geometry/clip_convex.h"

namespace sightline {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A corner of a part of a triangle between planes across the axes, which is a convex polygon.
struct Corner {
  Vec3d position;
};
using Piece = std::vector<Corner>;

float roundedDown(double v) {
  const float f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -kInfinity) : f;
}
float roundedUp(double v) {
  const float f = static_cast<float>(v);
  return f < v ? std::nextafter(f, kInfinity) : f;
}

// Planes across an axis, ascending, at which a box may be divided.
struct Cuts {
  static constexpr std::uint32_t kMost = 15;
  std::array<float, kMost + 1> at{};  // infinite beyond those that there are
  std::uint32_t count = 0;

  Cuts() { at.fill(kInfinity); }
  // Between neighbouring planes lie the slabs 0 to count, the slab i below the plane i. Returns the first one
  // whose plane is not below the value.
  template <typename Number>
  std::uint32_t slabOf(Number value) const {
    std::uint32_t below = 0;
    for (const float plane : at) {
      below += plane < value ? 1 : 0;
    }
    return below;
  }
};

// The least and the largest coordinate along an axis.
std::pair<double, double> reach(const Piece& piece, int axis) {
  double low = kInfinity, high = -kInfinity;
  for (const Corner& corner : piece) {
    low = std::min(low, corner.position[axis]);
    high = std::max(high, corner.position[axis]);
  }
  return {low, high};
}

// A box in double precision, rounded as may be: divisions are compared by it, and nothing else.
struct Bounds {
  Vec3d min{kInfinity, kInfinity, kInfinity};
  Vec3d max{-kInfinity, -kInfinity, -kInfinity};

  Bounds() = default;
  explicit Bounds(const Box& box) : min(box.min), max(box.max) {}
  void extend(const Vec3d& p) {
    min = sightline::min(min, p);
    max = sightline::max(max, p);
  }
  void extend(const Bounds& b) {
    min = sightline::min(min, b.min);
    max = sightline::max(max, b.max);
  }
};

Bounds around(Bounds a, const Bounds& b) {
  a.extend(b);
  return a;
}

// Divides one object's box, again and again, and then chooses which of the divisions to keep.
class Divider {
 public:
  explicit Divider(const ObjectBoxesSettings& settings)
      : max_boxes_(std::clamp(settings.max_boxes, 1u, kMaxObjectBoxes)),
        min_saving_(std::max(settings.min_saving, 0.0)) {}

  // Appends the object's boxes to out; nothing if one is enough.
  void divide(const SceneView& scene, const Object& object, std::vector<Box>& out);

 private:
  // A box of the tree of divisions.
  struct Node {
    Box box{};
    std::vector<std::uint32_t> triangles{};  // those that reach into it
    std::uint32_t first_half = 0;            // the other one follows; 0: it is not divided
    // By number of boxes: the least volume of so many boxes that hold what this one holds, and how many of
    // them are in the first half; 0: it is one box.
    std::array<double, kMaxObjectBoxes + 1> min_volume{};
    std::array<std::uint8_t, kMaxObjectBoxes + 1> in_first{};
  };
  // What lies between an axis's planes, and the triangles that lie in a plane.
  struct AxisSlabs {
    Cuts cuts{};
    std::array<Bounds, Cuts::kMost + 1> between{}, in_plane{};  // by slab; by plane
  };
  struct Division {
    double rank = std::numeric_limits<double>::infinity();  // the less, the better
    int axis = 0;
    float at = 0.0f;
    bool planar_in_first = true;  // triangles that lie in the plane go to the first half
  };

  // Halves of halves: four divisions one after the other, so that what saves only after a second one, as the
  // opening of a door frame does, is found.
  static constexpr std::uint32_t kMaxNodes = 31;
  static constexpr std::uint32_t kMaxDivided = 15;
  // A share of the box's volume, by which planes near its ends rank behind those in the middle. All planes
  // across a door frame save the same, and thin slices of its ends would use up the divisions.
  static constexpr double kOffCentre = 1e-3;

  // 0 for empty bounds.
  double volume(const Bounds& bounds) const {
    if (bounds.min.x > bounds.max.x) {
      return 0.0;
    }
    const Vec3d e = bounds.max - bounds.min;
    return (e.x + thickness_) * (e.y + thickness_) * (e.z + thickness_);
  }
  const Vec3f& corner(std::uint32_t t, std::uint32_t k) const {
    return scene_.positions[indices_[3 * std::size_t{t} + k]];
  }
  // Whether triangles fill all sides of the object's box: then no division saves volume.
  bool fillsItsBox() const;
  // The part of a triangle in the box, or a little more than that.
  // Valid until the next call.
  const Piece& pieceIn(const Box& box, std::uint32_t t);
  // Extends the bounds to hold the piece, as far as it lies in the box.
  void extendBy(const Piece& piece, const Box& box, Box& bounds) const;
  Cuts cutsOf(const Node& node, int axis) const;
  // Adds a part of a triangle to the slabs along the axis.
  static void addTo(AxisSlabs& slabs, int axis, const Piece& piece);
  void fillSlabs(const Node& node, std::array<AxisSlabs, 3>& slabs);
  Division bestDivision(const Node& node);
  void addHalves(std::uint32_t node, const Division& division);
  void findMinVolumes(Node& node) const;
  void append(std::uint32_t node, std::uint32_t count, std::vector<Box>& out) const;

  std::uint32_t max_boxes_;
  double min_saving_;
  SceneView scene_;
  std::span<const std::uint32_t> indices_;  // of the object
  std::vector<Box> bounds_;                 // by triangle of the object
  Piece piece_, scratch_;                   // see pieceIn()
  double slack_ = 0.0;                      // more than any rounding of a piece's corners
  double thickness_ = 0.0;
  std::array<Node, kMaxNodes> nodes_;
  std::uint32_t node_count_ = 0;
};

bool Divider::fillsItsBox() const {
  const Box& box = nodes_[0].box;
  // By side: twice the area of the triangles in it that face one way, and of the others. Both layers of a
  // panel fill no more than one.
  std::array<std::array<double, 2>, 6> filled{};
  for (std::uint32_t t = 0; t < bounds_.size(); ++t) {
    const Box& flat = bounds_[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (flat.min[axis] != flat.max[axis]) {
        continue;
      }
      const Vec3d a(corner(t, 0));
      const double area = cross(Vec3d(corner(t, 1)) - a, Vec3d(corner(t, 2)) - a)[axis];
      const std::size_t way = area < 0.0 ? 1 : 0;
      filled[2 * axis][way] += flat.min[axis] == box.min[axis] ? std::abs(area) : 0.0;
      filled[2 * axis + 1][way] += flat.min[axis] == box.max[axis] ? std::abs(area) : 0.0;
    }
  }
  const Vec3d extent = Vec3d(box.max) - Vec3d(box.min);
  for (int axis = 0; axis < 3; ++axis) {
    const double side = 2.0 * extent[(axis + 1) % 3] * extent[(axis + 2) % 3] * (1.0 - 1e-6);
    const auto& [low, high] = std::tie(filled[2 * axis], filled[2 * axis + 1]);
    if (std::max(low[0], low[1]) < side || std::max(high[0], high[1]) < side) {
      return false;
    }
  }
  return true;
}

const Piece& Divider::pieceIn(const Box& box, std::uint32_t t) {
  piece_.clear();
  for (std::uint32_t k = 0; k < 3; ++k) {
    piece_.push_back({Vec3d(corner(t, k))});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - slack_, high = box.max[axis] + slack_;
    if (bounds_[t].min[axis] < low) {
      clipConvex(piece_, scratch_, {}, [&](const Vec3d& p) { return p[axis] - low; });
    }
    if (bounds_[t].max[axis] > high) {
      clipConvex(piece_, scratch_, {}, [&](const Vec3d& p) { return high - p[axis]; });
    }
  }
  return piece_;
}

void Divider::extendBy(const Piece& piece, const Box& box, Box& bounds) const {
  Box reached;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = reach(piece, axis);
    reached.min[axis] = std::max(roundedDown(low - slack_), box.min[axis]);
    reached.max[axis] = std::min(roundedUp(high + slack_), box.max[axis]);
  }
  if (!piece.empty() && !reached.empty()) {
    bounds.extend(reached);
  }
}

// The coordinates of corners, if they are few, and planes at equal distances.
Cuts Divider::cutsOf(const Node& node, int axis) const {
  Cuts cuts;
  const float low = node.box.min[axis], high = node.box.max[axis];
  // Adds a plane that lies within the box and is a new one; false if there are too many.
  const auto add = [&](float at) {
    const auto end = cuts.at.begin() + cuts.count;
    if (at <= low || at >= high || std::find(cuts.at.begin(), end, at) != end) {
      return true;
    }
    if (cuts.count == Cuts::kMost) {
      return false;
    }
    cuts.at[cuts.count++] = at;
    return true;
  };
  const bool few = std::all_of(node.triangles.begin(), node.triangles.end(), [&](std::uint32_t t) {
    return add(corner(t, 0)[axis]) && add(corner(t, 1)[axis]) && add(corner(t, 2)[axis]);
  });
  cuts = few ? cuts : Cuts();
  const std::uint32_t more = Cuts::kMost - cuts.count;
  for (std::uint32_t i = 1; i <= more; ++i) {
    add(static_cast<float>(low + (double{high} - low) * i / (more + 1)));
  }
  std::sort(cuts.at.begin(), cuts.at.begin() + cuts.count);
  return cuts;
}

void Divider::addTo(AxisSlabs& slabs, int axis, const Piece& piece) {
  const auto [low, high] = reach(piece, axis);
  const Cuts& cuts = slabs.cuts;
  const std::uint32_t only = cuts.slabOf(low);
  if (low == high && only < cuts.count && low == cuts.at[only]) {
    for (const Corner& corner : piece) {
      slabs.in_plane[only].extend(corner.position);
    }
    return;
  }
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Vec3d* a = &piece[i].position;
    const Vec3d* b = &piece[i + 1 < piece.size() ? i + 1 : 0].position;
    if ((*a)[axis] > (*b)[axis]) {
      std::swap(a, b);
    }
    const double from = (*a)[axis], to = (*b)[axis];
    std::uint32_t slab = cuts.slabOf(from);
    if (slab < cuts.count && from == cuts.at[slab]) {
      if (to == from) {
        continue;  // the edges at its ends say on which sides of the plane the piece lies
      }
      ++slab;  // what begins in a plane has nothing below it
    }
    slabs.between[slab].extend(*a);
    for (; slab < cuts.count && to > cuts.at[slab]; ++slab) {
      const Vec3d crossing = *a + (*b - *a) * ((cuts.at[slab] - from) / (to - from));
      slabs.between[slab].extend(crossing);
      slabs.between[slab + 1].extend(crossing);
    }
    slabs.between[slab].extend(*b);
  }
}

void Divider::fillSlabs(const Node& node, std::array<AxisSlabs, 3>& slabs) {
  for (int axis = 0; axis < 3; ++axis) {
    slabs[axis].cuts = cutsOf(node, axis);
  }
  for (const std::uint32_t t : node.triangles) {
    const Box& bounds = bounds_[t];
    const bool inside = contains(node.box, bounds);
    std::array<bool, 3> several{};  // by axis: it is cut by the box or by a plane
    for (int axis = 0; axis < 3; ++axis) {
      const Cuts& cuts = slabs[axis].cuts;
      const std::uint32_t slab = cuts.slabOf(bounds.min[axis]);
      several[axis] = !inside || (slab < cuts.count && bounds.max[axis] > cuts.at[slab]);
      if (!several[axis]) {
        const bool planar = slab < cuts.count && bounds.min[axis] == cuts.at[slab];
        (planar ? slabs[axis].in_plane : slabs[axis].between)[slab].extend(Bounds(bounds));
      }
    }
    if (several[0] || several[1] || several[2]) {
      const Piece& piece = pieceIn(node.box, t);
      for (int axis = 0; axis < 3; ++axis) {
        if (several[axis]) {
          addTo(slabs[axis], axis, piece);
        }
      }
    }
  }
}

Divider::Division Divider::bestDivision(const Node& node) {
  std::array<AxisSlabs, 3> slabs;
  fillSlabs(node, slabs);
  Division best;
  const double whole = volume(Bounds(node.box));
  for (int axis = 0; axis < 3; ++axis) {
    const double low = node.box.min[axis], high = node.box.max[axis];
    const auto& [cuts, between, in_plane] = slabs[axis];
    const std::uint32_t count = cuts.count;
    std::array<Bounds, Cuts::kMost + 1> from = between;  // a slab and all above it
    for (std::uint32_t slab = count; slab-- > 0;) {
      from[slab].extend(from[slab + 1]);
      from[slab].extend(in_plane[slab]);
    }
    Bounds below;
    for (std::uint32_t slab = 0; slab < count; ++slab) {
      below.extend(between[slab]);
      const Bounds both = around(below, in_plane[slab]);
      const double in_first = volume(both) + volume(from[slab + 1]);
      const double in_second = volume(below) + volume(around(from[slab + 1], in_plane[slab]));
      const double off_centre = std::abs((cuts.at[slab] - low) - (high - cuts.at[slab])) / (high - low);
      const double rank = std::min(in_first, in_second) + kOffCentre * whole * off_centre;
      if (rank < best.rank) {
        best = {rank, axis, cuts.at[slab], in_first <= in_second};
      }
      below = both;
    }
  }
  return best;
}

void Divider::addHalves(std::uint32_t n, const Division& division) {
  const int axis = division.axis;
  Node& node = nodes_[n];
  std::array<Box, 2> halves{node.box, node.box};
  halves[0].max[axis] = division.at;
  halves[1].min[axis] = division.at;
  const std::uint32_t first = node_count_;
  std::uint32_t filled = 0;
  for (std::uint32_t h = 0; h < 2; ++h) {
    Node& child = nodes_[first + filled];
    child.box = {};
    child.triangles.clear();
    child.first_half = 0;
    for (const std::uint32_t t : node.triangles) {
      // What touches the plane from the other side does not belong here.
      const float low = bounds_[t].min[axis], high = bounds_[t].max[axis];
      const bool in_plane = low == division.at && high == division.at;
      const bool elsewhere = in_plane ? division.planar_in_first == (h == 1)
                             : h == 0 ? low >= division.at
                                      : high <= division.at;
      if (elsewhere) {
        continue;
      }
      Box reached = bounds_[t];
      if (!contains(halves[h], reached)) {
        reached = {};
        extendBy(pieceIn(halves[h], t), halves[h], reached);
      }
      if (!reached.empty()) {
        child.box.extend(reached);
        child.triangles.push_back(t);
      }
    }
    filled += child.triangles.empty() ? 0 : 1;
  }
  if (filled == 2) {
    node.first_half = first;
    node_count_ += 2;
  }
}

// Precondition: that of the halves has been found.
void Divider::findMinVolumes(Node& node) const {
  node.min_volume.fill(volume(Bounds(node.box)));
  node.in_first.fill(0);
  for (std::uint32_t count = 2; node.first_half != 0 && count <= max_boxes_; ++count) {
    node.min_volume[count] = node.min_volume[count - 1];
    node.in_first[count] = node.in_first[count - 1];
    for (std::uint32_t first = 1; first < count; ++first) {
      const double sum =
          nodes_[node.first_half].min_volume[first] + nodes_[node.first_half + 1].min_volume[count - first];
      if (sum < node.min_volume[count]) {
        node.min_volume[count] = sum;
        node.in_first[count] = static_cast<std::uint8_t>(first);
      }
    }
  }
}

void Divider::append(std::uint32_t n, std::uint32_t count, std::vector<Box>& out) const {
  const Node& node = nodes_[n];
  const std::uint32_t in_first = node.in_first[count];
  if (in_first == 0) {
    out.push_back(node.box);
    return;
  }
  append(node.first_half, in_first, out);
  append(node.first_half + 1, count - in_first, out);
}

void Divider::divide(const SceneView& scene, const Object& object, std::vector<Box>& out) {
  scene_ = scene;
  indices_ = scene.indicesOf(object);
  if (max_boxes_ < 2 || !object.bounds.wellFormed()) {
    return;
  }
  Node& root = nodes_[0];
  root.box = {};
  root.triangles.clear();
  root.first_half = 0;
  bounds_.assign(object.triangleCount(), {});
  for (std::uint32_t t = 0; t < object.triangleCount(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!isFinite(corner(t, k))) {
        return;
      }
      bounds_[t].extend(corner(t, k));
    }
    root.box.extend(bounds_[t]);
    root.triangles.push_back(t);
  }
  if (fillsItsBox()) {
    return;
  }
  const Vec3d extent(Vec3d(root.box.max) - Vec3d(root.box.min));
  slack_ = std::ldexp(maxComponent(max(abs(Vec3d(root.box.min)), abs(Vec3d(root.box.max)))), -44);
  thickness_ = maxComponent(extent) / 16.0;
  const double price = min_saving_ * volume(Bounds(root.box));
  node_count_ = 1;
  for (std::uint32_t n = 0; n < node_count_ && n < kMaxDivided; ++n) {
    if (volume(Bounds(nodes_[n].box)) <= price) {
      continue;  // cannot save as much as a box costs
    }
    const Division division = bestDivision(nodes_[n]);
    if (std::isfinite(division.rank)) {
      addHalves(n, division);
    }
  }
  for (std::uint32_t n = node_count_; n-- > 0;) {
    findMinVolumes(nodes_[n]);
  }
  std::uint32_t best = 1;
  for (std::uint32_t count = 2; count <= max_boxes_; ++count) {
    const bool saves = root.min_volume[count] + price * (count - best) < root.min_volume[best];
    best = saves ? count : best;
  }
  if (best > 1) {
    append(0, best, out);
  }
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
  parallel_for(count, [&](std::uint32_t begin, std::uint32_t end) {
    Divider divider(settings);
    for (std::uint32_t i = begin; i < end; ++i) {
      divider.divide(scene, scene.objects[i], of_object[i]);
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
