#include "oracle/region_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "oracle/ray_scene.h"
#include "oracle/triangle_tree.h"

namespace sightline {
namespace {

// Bounds of rounding, as fractions of the sizes that go into a result; each is far above what IEEE
// arithmetic can lose in so few operations.
constexpr double kProduct = 0x1p-46;        // of a dot product of a vector and a difference of points
constexpr double kSideMargin = 0x1p-42;     // of a region's sides, of the coordinates
constexpr double kFarthest = 0x1p200;       // coordinates whose products cannot overflow, metres
constexpr std::size_t kLines = 3;           // whose crossings are counted
constexpr std::size_t kMostFaces = 256;     // of a body
constexpr std::size_t kMostMembers = 1024;  // of a surface
constexpr std::size_t kMostCandidates = 24;
constexpr std::array<double, kLines> kLinePlaces{0.5087, 0.2713, 0.7391};
constexpr std::uint32_t kNoSheet = std::numeric_limits<std::uint32_t>::max();

struct Sign {
  double value = 0.0, doubt = 0.0;
  bool positive() const { return value > doubt; }
  bool negative() const { return value < -doubt; }
};

double sizeOf(const Vec3d& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

// dot(n, a - b), where n may have any value.
Sign along(const Vec3d& n, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = a - b;
  return {dot(n, d), kProduct * sizeOf(n) * (sizeOf(d) + 0x1p-6 * (sizeOf(a) + sizeOf(b)))};
}

struct Corners {
  Vec3d a, b, c;
};

// Six times the volume of the triangle and the point: positive in front of it.
Sign sideOf(const Corners& t, const Vec3d& p) {
  const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
  const double la = sizeOf(a), lb = sizeOf(b), lc = sizeOf(c);
  const double shift = 0x1p-50 * (sizeOf(p) + std::max({sizeOf(t.a), sizeOf(t.b), sizeOf(t.c)}));
  return {-dot(a, cross(b, c)), kProduct * la * lb * lc + 4.0 * shift * (la * lb + lb * lc + lc * la)};
}

// How a segment meets a triangle: 1 from its front, -1 from its back, 0 not at all; nothing if in doubt.
std::optional<int> crossing(const Corners& t, const Vec3d& from, const Vec3d& to) {
  const Sign start = sideOf(t, from), end = sideOf(t, to);
  if ((start.positive() && end.positive()) || (start.negative() && end.negative())) {
    return 0;
  }
  const std::array<Sign, 3> edges{sideOf({from, t.a, t.b}, to), sideOf({from, t.b, t.c}, to),
                                  sideOf({from, t.c, t.a}, to)};
  int plus = 0, minus = 0;
  for (const Sign& edge : edges) {
    plus += edge.positive() ? 1 : 0;
    minus += edge.negative() ? 1 : 0;
  }
  if (plus > 0 && minus > 0) {
    return 0;
  }
  if (plus + minus < 3 || !(start.positive() || start.negative()) || !(end.positive() || end.negative())) {
    return std::nullopt;
  }
  return start.positive() ? 1 : -1;
}

struct DoubleBox {
  Vec3d min, max;
  Vec3d corner(std::uint32_t i) const {
    return {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z};
  }
};

DoubleBox boxOf(const Corners& t) {
  return {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
}

// True if the boxes are farther apart than the distance, for sure. At 0 they must not touch.
bool apart(const DoubleBox& a, const DoubleBox& b, double distance) {
  const Vec3d gap = max(max(b.min - a.max, a.min - b.max), Vec3d{});
  return std::sqrt(dot(gap, gap)) > distance * (1.0 + 1e-9) + 0x1p-50 * (sizeOf(a.min) + sizeOf(b.max));
}

// Points whose convex hull holds every eye of the region. A point on an edge of the box is moved outwards by
// more than rounding.
std::vector<Vec3d> hullOf(const EyeRegion& region) {
  std::vector<Vec3d> points;
  const DoubleBox box{region.min, region.max};
  if (region.sides.size() != 1) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      points.push_back(box.corner(i));  // more sides than one only make the region smaller
    }
    return points;
  }
  const HalfSpace& side = region.sides[0];
  const double margin = kSideMargin * (sizeOf(box.min) + sizeOf(box.max) + std::abs(side.offset));
  const auto above = [&](std::uint32_t i) {
    return dot(side.normal, box.corner(i)) - (side.offset - margin);
  };
  for (std::uint32_t i = 0; i < 8; ++i) {
    if (above(i) < 0.0) {
      continue;  // and not where it is not a number: only then is the point surely without eyes
    }
    points.push_back(box.corner(i));
    for (const std::uint32_t axis : {1u, 2u, 4u}) {
      const std::uint32_t other = i ^ axis;
      if (above(other) < 0.0) {
        const double share = std::min(1.0, (above(i) + margin) / (above(i) - above(other)));
        points.push_back(box.corner(i) + (box.corner(other) - box.corner(i)) * share);
      }
    }
  }
  return points;
}

// Points of a hull at which lines of sight start: means of its corners, with weights that have no pattern, so
// that lines rarely meet edges.
std::array<Vec3d, kLines> startsIn(const std::vector<Vec3d>& hull) {
  std::array<Vec3d, kLines> starts{};
  for (std::size_t line = 0; line < kLines; ++line) {
    double sum = 0.0;
    Vec3d moved{};
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const double weight = kLinePlaces[(line + i) % kLines] + kLinePlaces[(line * i) % kLines];
      sum += weight;
      moved = moved + (hull[i] - hull[0]) * weight;
    }
    starts[line] = hull[0] + moved * (1.0 / sum);
  }
  return starts;
}

// False for coordinates that are not finite, too.
bool isNear(const Vec3d& p) {
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

}  // namespace

// A triangle is given by its number; a sheet by twice that, plus 1 if it is seen from its back.
struct RegionProof::Impl {
  explicit Impl(const SceneView& s) : scene(s), tree(s) { gather(); }

  void gather() {
    std::map<std::array<float, 3>, std::uint32_t> numbers;
    first_of.assign(scene.objects.size() + 1, 0);
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      first_of[o] = static_cast<std::uint32_t>(triangles.size());
      if (!occludes(scene, object)) {
        continue;
      }
      const std::span<const std::uint32_t> indices = scene.indicesOf(object);
      const bool both = scene.materialOf(object).double_sided;
      for (std::uint32_t i = 0; i + 2 < indices.size(); i += 3) {
        Triangle t{.object = o, .double_sided = both};
        bool finite = true;
        for (std::uint32_t k = 0; k < 3; ++k) {
          const Vec3f p = scene.positions[indices[i + k]];
          finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
          // Adding 0 turns -0 into 0.
          const std::array<float, 3> key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
          t.vertex[k] =
              finite ? numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second : 0;
          (k == 0 ? t.at.a : k == 1 ? t.at.b : t.at.c) = Vec3d(p);
        }
        if (finite && t.vertex[0] != t.vertex[1] && t.vertex[1] != t.vertex[2] &&
            t.vertex[2] != t.vertex[0]) {
          number_of.emplace(object.first_index + i, static_cast<std::uint32_t>(triangles.size()));
          triangles.push_back(t);
        }
      }
    }
    first_of.back() = static_cast<std::uint32_t>(triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        edges[edgeOf(triangles[i].vertex[k], triangles[i].vertex[(k + 1) % 3])].push_back(i);
      }
    }
    findBodies();
  }

  // Of each object, what is connected over edges, and whether its directed edges cancel.
  void findBodies() {
    body_of.assign(triangles.size(), kNoSheet);
    for (std::uint32_t start = 0; start < triangles.size(); ++start) {
      if (body_of[start] != kNoSheet) {
        continue;
      }
      const auto number = static_cast<std::uint32_t>(bodies.size());
      Body body{{start}, true};
      body_of[start] = number;
      for (std::size_t i = 0; i < body.triangles.size(); ++i) {
        const Triangle& t = triangles[body.triangles[i]];
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t from = t.vertex[k], to = t.vertex[(k + 1) % 3];
          int sum = 0;
          for (const std::uint32_t other : edges.at(edgeOf(from, to))) {
            if (triangles[other].object != t.object) {
              continue;
            }
            sum += runs(triangles[other], from, to) ? 1 : -1;
            if (body_of[other] == kNoSheet) {
              body_of[other] = number;
              body.triangles.push_back(other);
            }
          }
          body.closed = body.closed && sum == 0;
        }
      }
      bodies.push_back(std::move(body));
    }
  }

  struct Triangle {
    std::uint32_t object = 0;
    bool double_sided = false;
    std::array<std::uint32_t, 3> vertex{};
    Corners at{};
  };
  struct Body {
    std::vector<std::uint32_t> triangles;
    bool closed = false;
  };

  static std::uint64_t edgeOf(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }
  static bool runs(const Triangle& t, std::uint32_t from, std::uint32_t to) {
    return (t.vertex[0] == from && t.vertex[1] == to) || (t.vertex[1] == from && t.vertex[2] == to) ||
           (t.vertex[2] == from && t.vertex[0] == to);
  }
  Corners cornersOf(std::uint32_t sheet) const {
    const Corners& t = triangles[sheet / 2].at;
    return sheet % 2 == 0 ? t : Corners{t.a, t.c, t.b};
  }
  std::array<std::uint32_t, 3> verticesOf(std::uint32_t sheet) const {
    const auto& v = triangles[sheet / 2].vertex;
    return sheet % 2 == 0 ? v : std::array<std::uint32_t, 3>{v[0], v[2], v[1]};
  }
  // The sheet that is joined with this one at its edge, without the left-out object; kNoSheet if there is
  // none. Joining is mutual, so that joined edges cancel, whatever the choice.
  std::uint32_t partnerOf(std::uint32_t sheet, std::uint32_t from, std::uint32_t to,
                          std::uint32_t left_out) const {
    std::vector<std::uint32_t> there, back;
    const std::uint32_t low = std::min(from, to), high = std::max(from, to);
    for (const std::uint32_t t : edges.at(edgeOf(from, to))) {
      if (triangles[t].object == left_out) {
        continue;
      }
      const bool runs_up = runs(triangles[t], low, high);
      (runs_up ? there : back).push_back(2 * t);
      if (triangles[t].double_sided) {
        (runs_up ? back : there).push_back(2 * t + 1);
      }
    }
    for (const std::uint32_t one : there) {
      const auto score = [&](std::uint32_t other) {
        const Corners a = cornersOf(one), b = cornersOf(other);
        const Vec3d n = cross(a.b - a.a, a.c - a.a), m = cross(b.b - b.a, b.c - b.a);
        const double alike = dot(n, m) / std::max(1e-300, length(n) * length(m));
        return alike + (triangles[one / 2].object == triangles[other / 2].object ? 0.1 : 0.0);
      };
      const auto best = std::max_element(
          back.begin(), back.end(), [&](std::uint32_t a, std::uint32_t b) { return score(a) < score(b); });
      if (best == back.end()) {
        return kNoSheet;
      }
      if (one == sheet || *best == sheet) {
        return one == sheet ? *best : one;
      }
      back.erase(best);
    }
    return kNoSheet;
  }

  SceneView scene;
  TriangleTree tree;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> first_of;                         // by object: its first triangle
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;  // by first index in the scene
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> edges;
  std::vector<Body> bodies;
  std::vector<std::uint32_t> body_of;
};

// One claim.
class RegionProof::Attempt {
 public:
  Attempt(const Impl& impl, const RegionClaim& claim)
      : impl_(impl), claim_(claim), eyes_(hullOf(claim.region)) {
    const Box& bounds = impl.scene.objects[claim.target.value].bounds;
    target_ = {Vec3d(bounds.min), Vec3d(bounds.max)};
    if (eyes_.empty()) {
      return;
    }
    starts_ = startsIn(eyes_);
    // Rounding may put a start a little outside of the hull, so what is proved is for a hull that has it.
    eyes_.insert(eyes_.end(), starts_.begin(), starts_.end());
    around_ = {eyes_[0], eyes_[0]};
    for (const Vec3d& eye : eyes_) {
      around_ = {min(around_.min, eye), max(around_.max, eye)};
    }
  }

  bool run() {
    if (eyes_.empty()) {
      return true;  // there is no eye
    }
    if (!std::all_of(eyes_.begin(), eyes_.end(), isNear) ||
        !impl_.scene.objects[claim_.target.value].bounds.wellFormed() || !apart(around_, target_, 0.0)) {
      return false;
    }
    findCandidates();
    std::vector<std::uint32_t> bodies;
    for (const std::uint32_t t : candidates_) {
      const std::uint32_t body = impl_.body_of[t];
      if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) {
        bodies.push_back(body);
        if (bodyHides(impl_.bodies[body])) {
          return true;
        }
      }
    }
    if (candidates_.empty()) {
      return false;
    }
    makeShaft();
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [&](std::uint32_t t) { return surfaceHides(t); });
  }

  bool refuted() const {
    const auto clear = [&](const Vec3d& eye, const Vec3d& end) {
      for (std::uint32_t t = impl_.first_of[claim_.by.value]; t < impl_.first_of[claim_.by.value + 1]; ++t) {
        if (crossing(impl_.triangles[t].at, eye, end) != 0) {
          return false;
        }
      }
      return true;
    };
    // Only points of the box and of what the claim's region surely holds: the corners of a whole cell.
    if (!claim_.region.sides.empty() || !std::all_of(eyes_.begin(), eyes_.end(), isNear)) {
      return false;
    }
    const DoubleBox cell{claim_.region.min, claim_.region.max};
    for (std::uint32_t eye = 0; eye < 8; ++eye) {
      for (std::uint32_t i = 0; i < 8; ++i) {
        if (clear(cell.corner(eye), target_.corner(i))) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  // Where a line that starts in starts_ ends: in the target's box.
  Vec3d endOf(std::size_t line) const {
    const std::size_t i = 2 * line;
    const Vec3d e = target_.max - target_.min;
    return {target_.min.x + e.x * kLinePlaces[i % kLines],
            target_.min.y + e.y * kLinePlaces[(i + 1) % kLines],
            target_.min.z + e.z * kLinePlaces[(i + i / kLines) % kLines]};
  }

  void findCandidates() {
    for (std::size_t line = 0; line < kLines; ++line) {
      const Vec3d from = starts_[line], to = endOf(line);
      impl_.tree.alongRay(from, to - from, [&](const TriangleTree::Node& leaf) {
        const auto found = impl_.number_of.find(leaf.first_index);
        if (found == impl_.number_of.end() || leaf.object == claim_.target ||
            (claim_.by.valid() && leaf.object != claim_.by)) {
          return;
        }
        if (candidates_.size() < kMostCandidates &&
            crossing(impl_.triangles[found->second].at, from, to) != 0 &&
            std::find(candidates_.begin(), candidates_.end(), found->second) == candidates_.end()) {
          candidates_.push_back(found->second);
        }
      });
    }
  }

  // True if the whole body is behind a plane, and all eyes are before it by more than the near distance.
  bool separated(const Impl::Body& body) const {
    DoubleBox box = boxOf(impl_.triangles[body.triangles[0]].at);
    for (const std::uint32_t t : body.triangles) {
      const DoubleBox more = boxOf(impl_.triangles[t].at);
      box = {min(box.min, more.min), max(box.max, more.max)};
    }
    if (apart(box, around_, claim_.near_distance)) {
      return true;
    }
    return std::any_of(body.triangles.begin(), body.triangles.end(), [&](std::uint32_t number) {
      const Corners& face = impl_.triangles[number].at;
      const Vec3d n = cross(face.b - face.a, face.c - face.a);
      const double near = claim_.near_distance * length(n) * (1.0 + 1e-9);
      double farthest = -std::numeric_limits<double>::infinity();
      for (const std::uint32_t t : body.triangles) {
        for (const Vec3d& p : {impl_.triangles[t].at.a, impl_.triangles[t].at.b, impl_.triangles[t].at.c}) {
          const Sign s = along(n, p, face.a);
          farthest = std::max(farthest, s.value + s.doubt);
        }
      }
      return std::all_of(eyes_.begin(), eyes_.end(), [&](const Vec3d& eye) {
        const Sign s = along(n, eye, face.a);
        return s.value - s.doubt - farthest > near;
      });
    });
  }

  bool bodyHides(const Impl::Body& body) const {
    if (!body.closed || body.triangles.size() > kMostFaces || !separated(body)) {
      return false;
    }
    const std::size_t faces = body.triangles.size();
    const std::size_t ends = eyes_.size() + 8;
    std::vector<Sign> sides(faces * ends);
    for (std::size_t f = 0; f < faces; ++f) {
      for (std::size_t e = 0; e < ends; ++e) {
        const Vec3d p =
            e < eyes_.size() ? eyes_[e] : target_.corner(static_cast<std::uint32_t>(e - eyes_.size()));
        sides[f * ends + e] = sideOf(impl_.triangles[body.triangles[f]].at, p);
      }
    }
    for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
      for (std::size_t end = eyes_.size(); end < ends; ++end) {
        // The places on the segment that are surely behind all planes, from 0 to 1.
        double low = 0.0, high = 1.0;
        for (std::size_t f = 0; f < faces; ++f) {
          const Sign& a = sides[f * ends + eye];
          const Sign& b = sides[f * ends + end];
          const double a_most = a.value + a.doubt, b_most = b.value + b.doubt;
          const bool a_behind = a_most < 0.0, b_behind = b_most < 0.0;
          if (!a_behind && !b_behind) {
            return false;
          }
          if (a_behind && b_behind) {
            continue;
          }
          // The greatest that the linear function may be is behind up to, or from, this place.
          const double place = a_most / (a_most - b_most);
          if (!std::isfinite(place)) {
            return false;
          }
          if (a_behind) {
            high = std::min(high, place - 0x1p-50);
          } else {
            low = std::max(low, place + 0x1p-50);
          }
        }
        if (!(low < high)) {
          return false;
        }
      }
    }
    return true;
  }

  // Sides of the shaft: all of it has dot(normal, x) <= level.
  struct Side {
    Vec3d normal;
    Vec3d top;  // a point of the hull at which it is greatest, but for rounding
  };

  void addSide(const Vec3d& normal) {
    if (sizeOf(normal) == 0.0) {
      return;
    }
    const Vec3d* top = &hull_[0];
    for (const Vec3d& p : hull_) {
      top = dot(normal, p - *top) > 0.0 ? &p : top;
    }
    shaft_.push_back({normal, *top});
  }

  void makeShaft() {
    hull_ = eyes_;
    for (std::uint32_t i = 0; i < 8; ++i) {
      hull_.push_back(target_.corner(i));
    }
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d unit{};
      unit[axis] = 1.0;
      addSide(unit);
      addSide(-unit);
      for (const Vec3d& eye : eyes_) {
        for (std::uint32_t i = 0; i < 8; ++i) {
          const Vec3d normal = cross(unit, target_.corner(i) - eye);
          for (const Vec3d& n : {normal, -normal}) {
            // Only where both points support it.
            const double size =
                0x1p-40 * sizeOf(n) * (sizeOf(eye) + sizeOf(target_.max) + sizeOf(target_.min));
            if (std::all_of(hull_.begin(), hull_.end(),
                            [&](const Vec3d& p) { return dot(n, p - eye) <= size; })) {
              addSide(n);
            }
          }
        }
      }
    }
  }

  bool beyond(const Vec3d& normal, const Vec3d& p, const Vec3d& q) const {
    return std::all_of(hull_.begin(), hull_.end(), [&](const Vec3d& h) {
      return along(normal, p, h).positive() && along(normal, q, h).positive();
    });
  }

  // True only if the segment misses the shaft.
  bool missesShaft(const Vec3d& p, const Vec3d& q) const {
    for (const Side& side : shaft_) {
      if (along(side.normal, p, side.top).positive() && along(side.normal, q, side.top).positive() &&
          beyond(side.normal, p, q)) {
        return true;
      }
    }
    return false;
  }

  bool missesShaft(const Corners& t) const {
    return std::any_of(shaft_.begin(), shaft_.end(), [&](const Side& side) {
      return beyond(side.normal, t.a, t.b) && beyond(side.normal, t.c, t.c);
    });
  }

  bool allOn(const Corners& t, bool front, bool eyes) const {
    for (std::size_t i = 0; i < (eyes ? eyes_.size() : 8); ++i) {
      const Sign s = sideOf(t, eyes ? eyes_[i] : target_.corner(static_cast<std::uint32_t>(i)));
      if (!(front ? s.positive() : s.negative())) {
        return false;
      }
    }
    return true;
  }

  // True if all eyes are in front of the triangle's plane by more than the near distance.
  bool allFarBefore(const Corners& t) const {
    const double near = claim_.near_distance * length(cross(t.b - t.a, t.c - t.a)) * (1.0 + 1e-9);
    return std::all_of(eyes_.begin(), eyes_.end(), [&](const Vec3d& eye) {
      const Sign s = sideOf(t, eye);
      return s.value - s.doubt > near;
    });
  }

  // True if no end of a segment can pass through the triangle's front, nor through it in the box.
  bool clearOfEnds(const Corners& t) const {
    const DoubleBox box = boxOf(t);
    const bool from_eyes =
        apart(box, around_, claim_.near_distance) || allOn(t, false, true) || allFarBefore(t);
    return from_eyes && (apart(box, target_, 0.0) || allOn(t, true, false) || allOn(t, false, false));
  }

  bool surfaceHides(std::uint32_t triangle) const {
    const Impl::Triangle& t = impl_.triangles[triangle];
    std::uint32_t start = 2 * triangle;
    if (sideOf(t.at, starts_[0]).negative()) {
      if (!t.double_sided) {
        return false;
      }
      start += 1;
    }
    std::vector<std::uint32_t> members{start};
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Corners at = impl_.cornersOf(members[i]);
      const std::array<Vec3d, 3> p{at.a, at.b, at.c};
      const std::array<std::uint32_t, 3> vertices = impl_.verticesOf(members[i]);
      if (members.size() > kMostMembers || (!clearOfEnds(at) && !missesShaft(at))) {
        return false;
      }
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (missesShaft(p[k], p[(k + 1) % 3])) {
          continue;
        }
        const std::uint32_t partner =
            impl_.partnerOf(members[i], vertices[k], vertices[(k + 1) % 3], claim_.target.value);
        if (partner == kNoSheet) {
          return false;
        }
        if (std::find(members.begin(), members.end(), partner) == members.end()) {
          members.push_back(partner);
        }
      }
    }
    for (std::size_t line = 0; line < kLines; ++line) {
      int sum = 0;
      bool sure = true;
      for (const std::uint32_t sheet : members) {
        const std::optional<int> once =
            crossing(impl_.cornersOf(sheet), starts_[line], endOf(line));
        sure = sure && once.has_value();
        sum += once.value_or(0);
      }
      if (sure) {
        return sum > 0;
      }
    }
    return false;
  }

  const Impl& impl_;
  const RegionClaim& claim_;
  std::vector<Vec3d> eyes_, hull_;
  std::array<Vec3d, kLines> starts_{};
  DoubleBox target_, around_;
  std::vector<std::uint32_t> candidates_;
  std::vector<Side> shaft_;
};

RegionProof::RegionProof(const SceneView& scene) : impl_(std::make_unique<Impl>(scene)) {}
RegionProof::~RegionProof() = default;
RegionProof::RegionProof(RegionProof&&) noexcept = default;
RegionProof& RegionProof::operator=(RegionProof&&) noexcept = default;

bool RegionProof::isEmpty(const EyeRegion& region) {
  return hullOf(region).empty();
}

bool RegionProof::proves(const RegionClaim& claim) const {
  return Attempt(*impl_, claim).run();
}

bool RegionProof::refutesObject(const RegionClaim& claim) const {
  return Attempt(*impl_, claim).refuted();
}

bool RegionProof::misses(const Vec3d& from, const Vec3d& to, ObjectId object) const {
  for (std::uint32_t t = impl_->first_of[object.value]; t < impl_->first_of[object.value + 1]; ++t) {
    if (crossing(impl_->triangles[t].at, from, to) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace sightline
