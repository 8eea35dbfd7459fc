#include "src/occlusion/surfaces/chain_edges.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "src/geometry/exact_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/chain_edges.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Does what PixelView and ChainEdges::pixelOf() do, with the same bits, and a point in each lane.
class PointProjection {
 public:
  using Doubles = hn::CappedTag<double, kMostLanes>;
  using DoublesV = hn::Vec<Doubles>;

  HWY_INLINE PointProjection(const scene::PixelView& view, double clip_depth)
      : view_(view), clip_depth_(clip_depth) {}

  // Returns whether none of the points is nearer than the clip depth.
  // camera: null, or receives them in camera space, from number `at` on.
  HWY_INLINE bool project(const float* x, const float* y, const float* z, std::size_t count, double* pixel_x,
                          double* pixel_y, CameraPoints* camera, std::size_t at) const {
    const DoublesV from_eye[3] = {load(x, view_.eye.x), load(y, view_.eye.y), load(z, view_.eye.z)};
    const DoublesV depth = along(view_.forward, from_eye);
    const DoublesV right = along(view_.right, from_eye), up = along(view_.up, from_eye);
    const DoublesV inverse = view_.orthographic ? set(1.0) : hn::Div(set(1.0), depth);
    hn::StoreU(place(right, inverse, view_.scale_x, view_.middle_x), kDoubles, pixel_x);
    hn::StoreU(place(up, inverse, view_.scale_y, view_.middle_y), kDoubles, pixel_y);
    if (camera != nullptr) {
      hn::StoreU(right, kDoubles, camera->x.data() + at);
      hn::StoreU(up, kDoubles, camera->y.data() + at);
      hn::StoreU(depth, kDoubles, camera->z.data() + at);
    }
    return hn::AllTrue(kDoubles,
                       hn::Or(hn::Ge(depth, set(clip_depth_)), hn::Not(hn::FirstN(kDoubles, count))));
  }

 private:
  static HWY_INLINE DoublesV set(double v) { return hn::Set(kDoubles, v); }
  static HWY_INLINE DoublesV load(const float* from, double eye) {
    const hn::Rebind<float, Doubles> floats;
    return hn::Sub(hn::PromoteTo(kDoubles, hn::LoadU(floats, from)), set(eye));
  }
  static HWY_INLINE DoublesV along(const Vec3d& axis, const DoublesV (&v)[3]) {
    return hn::Add(hn::Add(hn::Mul(set(axis.x), v[0]), hn::Mul(set(axis.y), v[1])),
                   hn::Mul(set(axis.z), v[2]));
  }
  static HWY_INLINE DoublesV place(DoublesV camera, DoublesV inverse, double scale, double middle) {
    const DoublesV pixel = hn::Add(set(middle), hn::Mul(hn::Mul(set(scale), camera), inverse));
    const DoublesV whole = set(kToWhole);
    return hn::Sub(hn::Add(hn::Mul(pixel, set(kGridStep)), whole), whole);
  }

  static constexpr Doubles kDoubles{};
  const scene::PixelView& view_;
  double clip_depth_;
};

// ends: as in ChainEdges. Returns whether none of them is nearer than the clip depth; the lines of those that
// are have no meaning.
// camera: null, or receives the same lines in camera space.
bool projectEnds(const scene::PixelView& view, double clip_depth, const float* const* ends, std::size_t count,
                 GridLines& lines, CameraLines* camera) {
  const PointProjection projection(view, clip_depth);
  const std::size_t lanes = hn::Lanes(PointProjection::Doubles());
  bool all = true;
  for (std::size_t i = 0; i < count; i += lanes) {
    const std::size_t used = std::min(lanes, count - i);
    all &= projection.project(ends[0] + i, ends[1] + i, ends[2] + i, used, lines.from_x.data() + i,
                              lines.from_y.data() + i, camera != nullptr ? &camera->from : nullptr, i);
    all &= projection.project(ends[3] + i, ends[4] + i, ends[5] + i, used, lines.to_x.data() + i,
                              lines.to_y.data() + i, camera != nullptr ? &camera->to : nullptr, i);
  }
  return all;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

// These bound the lines that closeCut() adds: their values, and how many ends they may link, for each end is
// compared with all others.
constexpr std::int64_t kMostLinked = std::int64_t{1} << 30;
constexpr std::size_t kMostOpen = 64;

}  // namespace

HWY_EXPORT(projectEnds);

void ChainEdges::begin(const SurfaceSet& set, const scene::PixelView& view, double clip_depth,
                       const EdgeBuffer& buffer) {
  set_ = &set;
  view_ = view;
  clip_depth_ = clip_depth;
  buffer_ = buffer;
  several_viewers_ = view.viewers.several();
  forgetGroup();
  forget();
}

void ChainEdges::forgetGroup() {
  chains_.clear();
  cuts_.clear();
  cut_ends_.clear();
  count_ = 0;
}

void ChainEdges::makeRoom(std::size_t more) {
  if (ends_[0].size() < count_ + more + kMostLanes) {
    for (std::vector<float>& list : ends_) {
      list.resize(2 * (count_ + more) + kMostLanes);
    }
  }
}

void ChainEdges::add(std::uint32_t chain, std::int32_t value) {
  const std::span<const Vec3f> vertices = set_->verticesOf(set_->chains[chain]);
  makeRoom(vertices.size());
  const std::uint32_t first = count_;
  for (std::size_t i = 1; i < vertices.size(); ++i, ++count_) {
    const Vec3f &from = vertices[i - 1], &to = vertices[i];
    const std::array<float, kCoordinates> coordinates{from.x, from.y, from.z, to.x, to.y, to.z};
    for (std::size_t k = 0; k < kCoordinates; ++k) {
      ends_[k][count_] = coordinates[k];
    }
  }
  chains_.push_back({first, count_ - first, value});
}

GridPoint ChainEdges::pixelOf(const Vec3d& camera) const {
  const double inverse = view_.inverseDepth(camera);
  const auto nearestWhole = [](double v) { return (v + kToWhole) - kToWhole; };
  return {nearestWhole(view_.pixelX(camera, inverse) * kGridStep),
          nearestWhole(view_.pixelY(camera, inverse) * kGridStep)};
}

// Notes that a line of this value ends where an edge crosses the clip plane, and returns that point: the same
// one from both sides. What begins there has the value with the other sign.
Vec3d ChainEdges::addCutEnd(const Vec3f& a, const Vec3f& b, std::int32_t value) {
  const bool ascending = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  const Vec3f &low = ascending ? a : b, &high = ascending ? b : a;
  const Vec3d from = toCamera(low), to = toCamera(high);
  const double t = (clip_depth_ - from.z) / (to.z - from.z);
  Vec3d point = from + (to - from) * t;
  point.z = clip_depth_;
  cut_ends_.push_back({low, high, point, value});
  return point;
}

void ChainEdges::addCut(std::span<const std::uint32_t, 3> triangle, std::int32_t value) {
  bool shows[3];
  for (std::size_t k = 0; k < 3; ++k) {
    shows[k] = toCamera(set_->vertices[triangle[k]]).z >= clip_depth_;
  }
  if (shows[0] == shows[1] && shows[1] == shows[2]) {
    return;
  }
  // From where the border of the triangle leaves to where it comes back.
  Vec3d from, to;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (shows[k] != shows[next]) {
      (shows[k] ? from : to) =
          addCutEnd(set_->vertices[triangle[k]], set_->vertices[triangle[next]], shows[k] ? -value : value);
    }
  }
  makeRoom(1);
  chains_.push_back({count_, 1, value});
  cuts_.push_back({count_++, from, to});
}

// Clips the edges of all chains but those of cuts.
void ChainEdges::clipAll() {
  auto cut = cuts_.begin();
  for (const BoundaryChain& chain : chains_) {
    if (cut != cuts_.end() && chain.count == 1 && cut->edge == chain.first) {
      ++cut;
      continue;
    }
    for (std::uint32_t edge = chain.first; edge < chain.first + chain.count; ++edge) {
      clip(edge, chain.value);
    }
  }
}

// Sets an edge's line to what is left of it beyond the clip depth.
void ChainEdges::clip(std::uint32_t edge, std::int32_t value) {
  const Vec3f a(ends_[0][edge], ends_[1][edge], ends_[2][edge]),
      b(ends_[3][edge], ends_[4][edge], ends_[5][edge]);
  const Vec3d from = toCamera(a), to = toCamera(b);
  const bool from_shows = from.z >= clip_depth_, to_shows = to.z >= clip_depth_;
  if (from_shows && to_shows) {
    setLine(edge, from, to);
  } else if (from_shows) {
    setLine(edge, from, addCutEnd(a, b, value));
  } else if (to_shows) {
    setLine(edge, addCutEnd(a, b, -value), to);
  } else {
    // To the right of the buffer, where no edge matters.
    constexpr GridPoint kNowhere{kLargestGrid, 0.0};
    lines_.set(edge, kNowhere, kNowhere);
    if (several_viewers_) {
      constexpr double kFarAway = 1e30;
      camera_lines_.set(edge, {kFarAway, 0.0, 1.0}, {kFarAway, 0.0, 1.0});
    }
  }
}

// Triangles side by side may divide a line into several edges where a chain has a single one. Rounding may
// then let the clip plane cut the line at one point of theirs and at another of the chain's. What lies
// between the two points, on the line, is added. So on each line the boundary ends as often as it begins, as
// that of the surface does there. Returns whether all of it is closed now.
bool ChainEdges::closeCut() {
  std::sort(cut_ends_.begin(), cut_ends_.end(), [](const CutEnd& p, const CutEnd& q) {
    return std::tie(p.a.x, p.a.y, p.a.z, p.b.x, p.b.y, p.b.z) <
           std::tie(q.a.x, q.a.y, q.a.z, q.b.x, q.b.y, q.b.z);
  });
  // Ends at the same edge are one. Most cancel.
  std::size_t open = 0;
  for (std::size_t first = 0; first < cut_ends_.size();) {
    CutEnd all = cut_ends_[first];
    for (++first; first < cut_ends_.size() && cut_ends_[first].a == all.a && cut_ends_[first].b == all.b;
         ++first) {
      all.value += cut_ends_[first].value;
    }
    if (all.value != 0) {
      cut_ends_[open++] = all;
    }
  }
  cut_ends_.resize(open);
  if (open > kMostOpen) {
    return false;
  }
  for (std::size_t i = 0; i < open; ++i) {
    for (std::size_t j = i + 1; j < open && cut_ends_[i].value != 0; ++j) {
      if (!link(cut_ends_[i], cut_ends_[j])) {
        return false;
      }
    }
  }
  return std::all_of(cut_ends_.begin(), cut_ends_.end(), [](const CutEnd& end) { return end.value == 0; });
}

// Adds a line between two ends, if their edges are on one line, from the one at which more lines end to the
// one at which more begin. False if the line's value would be too large.
bool ChainEdges::link(CutEnd& p, CutEnd& q) {
  if (p.value == 0 || q.value == 0 || (p.value > 0) == (q.value > 0) ||
      !geometry::areOnOneLine(p.a, p.b, q.a) || !geometry::areOnOneLine(p.a, p.b, q.b)) {
    return true;
  }
  CutEnd &from = p.value > 0 ? p : q, &to = p.value > 0 ? q : p;
  const std::int64_t value = std::min(from.value, -to.value);
  if (value > kMostLinked) {
    return false;
  }
  lines_.reserve(count_ + 1);
  if (several_viewers_) {
    camera_lines_.reserve(count_ + 1);
  }
  chains_.push_back({count_, 1, static_cast<std::int32_t>(value)});
  setLine(count_++, from.at, to.at);
  from.value -= value;
  to.value += value;
  return true;
}

// from, to: camera space, not nearer than the clip depth.
void ChainEdges::setLine(std::uint32_t edge, const Vec3d& from, const Vec3d& to) {
  lines_.set(edge, pixelOf(from), pixelOf(to));
  if (several_viewers_) {
    camera_lines_.set(edge, from, to);
  }
}

// An edge that gets much nearer to the viewers at one end than at the other is swept much farther there. So
// it is divided, and the pieces are chains of their own.
void ChainEdges::divideSwept() {
  const std::size_t chains = chains_.size();
  for (std::size_t chain = 0; chain < chains; ++chain) {
    const BoundaryChain whole = chains_[chain];
    for (std::uint32_t edge = whole.first; edge < whole.first + whole.count; ++edge) {
      divideSwept(chain, edge);
    }
  }
}

void ChainEdges::divideSwept(std::size_t chain, std::uint32_t edge) {
  constexpr double kRatio = 3.0;        // of depths beyond all viewers
  constexpr double kLeastDepth = 0.05;  // what is nearer is not told apart; of the clip depth
  constexpr std::uint32_t kMostPieces = 7;
  const ViewerRegion& viewers = view_.viewers;
  const double reach = viewers.radius + std::max({0.0, viewers.offsets[0].z, viewers.offsets[1].z});
  const Vec3d from = camera_lines_.from.point(edge), to = camera_lines_.to.point(edge);
  const double least = std::max(std::min(from.z, to.z) - reach, kLeastDepth * clip_depth_);
  double depth = std::max(from.z, to.z) - reach;
  if (!(depth > kRatio * least)) {
    return;
  }
  lines_.reserve(count_ + kMostPieces);
  camera_lines_.reserve(count_ + kMostPieces);
  const bool ascending = to.z > from.z;
  const Vec3d far_end = ascending ? to : from, near_end = ascending ? from : to;
  const std::uint32_t first = count_;
  Vec3d end = far_end;
  while (depth > kRatio * least && count_ < first + kMostPieces) {
    depth /= kRatio;
    const Vec3d next =
        near_end + (far_end - near_end) * ((depth + reach - near_end.z) / (far_end.z - near_end.z));
    setLine(count_++, ascending ? next : end, ascending ? end : next);
    end = next;
  }
  setLine(edge, ascending ? near_end : end, ascending ? end : near_end);
  chains_.push_back({first, count_ - first, chains_[chain].value});
}

std::uint32_t ChainEdges::endGroup(std::vector<BoundaryChain>& boundary) {
  lines_.reserve(count_);
  if (several_viewers_) {
    camera_lines_.reserve(count_);
  }
  const std::array<const float*, kCoordinates> ends{ends_[0].data(), ends_[1].data(), ends_[2].data(),
                                                    ends_[3].data(), ends_[4].data(), ends_[5].data()};
  CameraLines* const camera = several_viewers_ ? &camera_lines_ : nullptr;
  if (!HWY_DYNAMIC_DISPATCH(projectEnds)(view_, clip_depth_, ends.data(), count_, lines_, camera)) {
    clipAll();
  }
  for (const Cut& cut : cuts_) {
    setLine(cut.edge, cut.from, cut.to);
  }
  if (!closeCut()) {
    forgetGroup();
    return 0;
  }
  if (several_viewers_) {
    divideSwept();
    findSweeps(view_, clip_depth_, camera_lines_, lines_, count_, sweeps_);
  }
  prepared_.resize(std::max<std::size_t>(prepared_.size(), count_));
  prepareEdges(lines_, several_viewers_ ? &sweeps_ : nullptr, buffer_, std::span(prepared_).first(count_));
  const auto before = static_cast<std::uint32_t>(edges_.size());
  for (const BoundaryChain& chain : chains_) {
    const auto first = static_cast<std::uint32_t>(edges_.size());
    for (std::uint32_t edge = chain.first; edge < chain.first + chain.count; ++edge) {
      if (prepared_[edge].matters) {
        edges_.push_back(prepared_[edge]);
      }
    }
    if (edges_.size() > first) {
      boundary.push_back({first, static_cast<std::uint32_t>(edges_.size()) - first, chain.value});
    }
  }
  forgetGroup();
  return static_cast<std::uint32_t>(edges_.size()) - before;
}

}  // namespace sightline::occlusion
#endif
