#include "src/drawing/feature_edges_build.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "src/occluders/near_line.h"

namespace sightline::drawing {
namespace {

// Corners are rounded to single precision by up to 2^-24 of their largest coordinate, so the distance between
// an edge and a corner on it is off by some 2^-22.
constexpr double kPlaceRounding = 0x1p-21;

// A key that is equal for equal places (-0 counts as 0) and that orders NaN too.
std::array<std::uint32_t, 3> placeKey(const Vec3f& p) {
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

}  // namespace

EdgeBuilder::EdgeBuilder(const SceneView& scene) : scene_(scene), stands_for_(scene.positions.size()) {}

bool EdgeBuilder::before(const HalfEdge& x, const HalfEdge& y) {
  return std::tie(x.a, x.b, x.first_index, x.along) < std::tie(y.a, y.b, y.first_index, y.along);
}

void EdgeBuilder::add(const Object& object, FeatureEdges& edges) {
  weld(scene_.indicesOf(object));
  gather(object);
  std::sort(half_edges_.begin(), half_edges_.end(), before);
  cutAtCorners();
  store(edges);
}

// Merges corners at the same place: sets stands_for_, corners_ and tolerance_.
void EdgeBuilder::weld(std::span<const std::uint32_t> indices) {
  corners_.assign(indices.begin(), indices.end());
  std::sort(corners_.begin(), corners_.end());
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  const auto key = [this](std::uint32_t corner) { return placeKey(scene_.positions[corner]); };
  std::stable_sort(corners_.begin(), corners_.end(),
                   [&](std::uint32_t p, std::uint32_t q) { return key(p) < key(q); });
  double size = 0.0;
  std::size_t kept = 0;
  for (const std::uint32_t corner : corners_) {
    if (kept == 0 || key(corners_[kept - 1]) != key(corner)) {
      corners_[kept++] = corner;
    }
    stands_for_[corner] = corners_[kept - 1];
    if (isFinite(scene_.positions[corner])) {
      size = std::max(size, maxComponent(abs(at(corner))));
    }
  }
  corners_.resize(kept);
  std::erase_if(corners_, [this](std::uint32_t corner) { return !isFinite(scene_.positions[corner]); });
  tolerance_ = kPlaceRounding * size;
}

void EdgeBuilder::gather(const Object& object) {
  half_edges_.clear();
  const std::span<const std::uint32_t> indices = scene_.indicesOf(object);
  for (std::uint32_t i = 0; i + 2 < indices.size(); i += 3) {
    const std::array<std::uint32_t, 3> corners{stands_for_[indices[i]], stands_for_[indices[i + 1]],
                                               stands_for_[indices[i + 2]]};
    for (int k = 0; k < 3 && hasArea(corners); ++k) {
      addHalfEdge(corners[static_cast<std::size_t>(k)], corners[static_cast<std::size_t>((k + 1) % 3)],
                  object.first_index + i);
    }
  }
}

void EdgeBuilder::addHalfEdge(std::uint32_t from, std::uint32_t to, std::uint32_t first_index) {
  half_edges_.push_back({std::min(from, to), std::max(from, to), first_index, from < to});
}

// Whether a triangle is thicker than the rounding of its corners; a thinner one has no plane. If it is left
// out, its neighbours form a T-junction.
bool EdgeBuilder::hasArea(const std::array<std::uint32_t, 3>& corners) const {
  const Vec3d a = at(corners[0]);
  const Vec3d b = at(corners[1]);
  const Vec3d c = at(corners[2]);
  const double longest = std::max({length(b - a), length(c - b), length(a - c)});
  return length(cross(b - a, c - a)) > tolerance_ * longest;
}

// Cuts edges that belong to one face alone at the corners that lie on them.
void EdgeBuilder::cutAtCorners() {
  const auto alone = [this](std::size_t i) {
    const auto same = [&](const HalfEdge& other) {
      return other.a == half_edges_[i].a && other.b == half_edges_[i].b;
    };
    return !(i > 0 && same(half_edges_[i - 1])) && !(i + 1 < half_edges_.size() && same(half_edges_[i + 1]));
  };
  boxes_.reset();
  cut_.clear();
  for (std::size_t i = 0; i < half_edges_.size(); ++i) {
    on_edge_.clear();
    if (alone(i)) {
      findCornersOn(half_edges_[i]);
    }
    if (on_edge_.empty()) {
      cut_.push_back(half_edges_[i]);
      continue;
    }
    const HalfEdge& edge = half_edges_[i];
    on_edge_.push_back({1.0, edge.b});
    std::uint32_t from = edge.a;
    for (const OnEdge& next : on_edge_) {
      const bool up = from < next.corner;
      cut_.push_back(
          {std::min(from, next.corner), std::max(from, next.corner), edge.first_index, up == edge.along});
      from = next.corner;
    }
  }
  if (cut_.size() != half_edges_.size()) {
    half_edges_.swap(cut_);
    std::sort(half_edges_.begin(), half_edges_.end(), before);
  }
}

// Sets on_edge_ to the corners that lie on the edge, from a to b.
void EdgeBuilder::findCornersOn(const HalfEdge& edge) {
  if (!boxes_) {
    std::vector<Box> boxes;
    for (const std::uint32_t corner : corners_) {
      boxes.push_back({scene_.positions[corner], scene_.positions[corner]});
    }
    boxes_.emplace(boxes, corners_);
  }
  const Vec3d a = at(edge.a);
  const Vec3d b = at(edge.b);
  const Vec3d ab = b - a;
  const double length_ab = length(ab);
  const occluders::NearLine line(a, b, 2.0 * tolerance_);
  const auto addIfOnEdge = [&](std::uint32_t corner) {
    const Vec3d ac = at(corner) - a;
    const double along = dot(ac, ab) / length_ab;
    const bool between = along > tolerance_ && along < length_ab - tolerance_;
    if (between && length(cross(ac, ab)) <= tolerance_ * length_ab) {
      on_edge_.push_back({along / length_ab, corner});
    }
  };
  boxes_->forMeeting(
      occluders::grownBox(min(a, b), max(a, b), tolerance_),
      [&line](const Box& box) { return line.mayMeet(box); }, addIfOnEdge);
  std::sort(on_edge_.begin(), on_edge_.end(), [](const OnEdge& p, const OnEdge& q) {
    return std::tie(p.share, p.corner) < std::tie(q.share, q.corner);
  });
}

void EdgeBuilder::store(FeatureEdges& edges) const {
  for (const HalfEdge& half : half_edges_) {
    const bool goes_on = !edges.edges_.empty() && edges.edges_.size() > edges.first_edge_.back() &&
                         edges.edges_.back().a == half.a && edges.edges_.back().b == half.b;
    if (!goes_on) {
      edges.edges_.push_back({half.a, half.b, static_cast<std::uint32_t>(edges.sides_.size()), 0});
    }
    edges.sides_.push_back({half.first_index, half.along});
    ++edges.edges_.back().side_count;
  }
}

}  // namespace sightline::drawing
