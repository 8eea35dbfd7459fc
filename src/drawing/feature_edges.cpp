#include "sightline/drawing/feature_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "src/drawing/feature_edges_build.h"
#include "src/drawing/triangle_side.h"

namespace sightline {

using namespace drawing;

namespace {

// Corners are rounded to single precision: by up to 2^-24 of their largest coordinate in each axis.
constexpr double kCornerRounding = 0x1p-22;
constexpr double kCreaseSlackDeg = 1e-9;

double angleBetween(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

// A face at an edge, turned as if it were wound from a to b: two faces of one flat surface, on either side of
// the edge, have opposite normals, and two that lie on one another have the same normal.
struct Wing {
  Vec3d normal;           // unit
  double tilt_rad = 0.0;  // the angle by which rounding may have turned the normal
  int side = 0;           // the face's side of the edge in the picture: 1 left, -1 right, 0 edge on
  bool drawn = false;
};

// The faces of an edge, with those that lie on one another merged.
class Fan {
 public:
  void add(const Wing& wing) {
    drawn_ = drawn_ || wing.drawn;
    left_ = left_ || wing.side > 0;
    right_ = right_ || wing.side < 0;
    const auto same = [&](const Wing& other) {
      return angleBetween(wing.normal, other.normal) <= wing.tilt_rad + other.tilt_rad;
    };
    if (std::none_of(wings_.begin(), wings_.begin() + count_, same) && count_ < kMax) {
      wings_[static_cast<std::size_t>(count_++)] = wing;
    }
  }

  std::optional<LineKind> kind(const FeatureSettings& settings) const {
    if (!drawn_ || flatSharedEdge()) {
      return std::nullopt;
    }
    if (count_ != 2 && settings.boundaries) {
      return LineKind::kBoundary;
    }
    if (count_ >= 2 && settings.silhouettes && !(left_ && right_)) {
      return LineKind::kSilhouette;
    }
    if (settings.creases &&
        sharpestFold() * (180.0 / std::numbers::pi) >= settings.crease_deg - kCreaseSlackDeg) {
      return LineKind::kCrease;
    }
    return std::nullopt;
  }

 private:
  static constexpr int kMax = 8;  // more directions than these add nothing to the answer

  bool flatSharedEdge() const {
    return count_ == 2 &&
           angleBetween(wings_[0].normal, -wings_[1].normal) <= wings_[0].tilt_rad + wings_[1].tilt_rad;
  }
  // The largest angle by which two of the faces differ from lying flat; negative if there is one face only.
  double sharpestFold() const {
    double sharpest = -1e9;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        sharpest = std::max(sharpest, angleBetween(wings_[i].normal, -wings_[j].normal));
      }
    }
    return sharpest;
  }

  std::array<Wing, kMax> wings_;
  int count_ = 0;
  bool drawn_ = false, left_ = false, right_ = false;
};

struct Faces {
  const SceneView& scene;
  TriangleSides sides;
  bool double_sided = false;

  std::optional<Wing> wing(std::uint32_t first_index, bool along) const {
    const Vec3f& a = scene.positions[scene.indices[first_index]];
    const Vec3f& b = scene.positions[scene.indices[first_index + 1]];
    const Vec3f& c = scene.positions[scene.indices[first_index + 2]];
    const Vec3d ab = Vec3d(b) - Vec3d(a);
    const Vec3d ac = Vec3d(c) - Vec3d(a);
    const Vec3d normal = cross(ab, ac);
    const double area = length(normal);
    if (!(area > 0.0) || !std::isfinite(area)) {
      return std::nullopt;
    }
    const double longest = std::max({length(ab), length(ac), length(ac - ab)});
    const double size =
        std::max({maxComponent(abs(Vec3d(a))), maxComponent(abs(Vec3d(b))), maxComponent(abs(Vec3d(c)))});
    const int side = sides.seen(a, b, c);
    Wing wing;
    wing.normal = normal * ((along ? 1.0 : -1.0) / area);
    wing.tilt_rad = kCornerRounding * size * longest / area;
    wing.side = along ? side : -side;
    wing.drawn = side > 0 || (side < 0 && double_sided);
    return wing;
  }
};

}  // namespace

FeatureEdges::FeatureEdges(const SceneView& scene) {
  EdgeBuilder builder(scene);
  first_edge_.push_back(0);
  for (const Object& object : scene.objects) {
    builder.add(object, *this);
    first_edge_.push_back(static_cast<std::uint32_t>(edges_.size()));
  }
}

void FeatureEdges::select(const SceneView& scene, ObjectId object, const View& view,
                          const FeatureSettings& settings, std::vector<FeatureLine>& lines) const {
  lines.clear();
  const Faces faces{scene, TriangleSides(view), scene.materialOf(scene.objects[object.value]).double_sided};
  for (std::uint32_t i = first_edge_[object.value]; i < first_edge_[object.value + 1]; ++i) {
    const Edge& edge = edges_[i];
    const Vec3f& a = scene.positions[edge.a];
    const Vec3f& b = scene.positions[edge.b];
    if (!isFinite(a) || !isFinite(b) || a == b) {
      continue;
    }
    Fan fan;
    for (std::uint32_t s = edge.first_side; s < edge.first_side + edge.side_count; ++s) {
      if (const std::optional<Wing> wing = faces.wing(sides_[s].first_index, sides_[s].along)) {
        fan.add(*wing);
      }
    }
    if (const std::optional<LineKind> kind = fan.kind(settings)) {
      lines.push_back({edge.a, edge.b, *kind});
    }
  }
}

}  // namespace sightline
