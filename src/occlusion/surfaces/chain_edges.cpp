#include "src/occlusion/surfaces/chain_edges.h"

#include <algorithm>
#include <tuple>

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

HWY_EXPORT(projectEnds);

void ChainEdges::begin(const SurfaceSet& set, const scene::PixelView& view, double clip_depth,
                       const EdgeBuffer& buffer) {
  set_ = &set;
  view_ = view;
  clip_depth_ = clip_depth;
  buffer_ = buffer;
  several_viewers_ = view.viewers.several();
  chains_.clear();
  cuts_.clear();
  count_ = 0;
  forget();
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

// Where an edge crosses the clip plane; the same from both sides.
Vec3d ChainEdges::cutPoint(const Vec3f& a, const Vec3f& b) const {
  const bool ascending = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  const Vec3d from = toCamera(ascending ? a : b), to = toCamera(ascending ? b : a);
  const double t = (clip_depth_ - from.z) / (to.z - from.z);
  Vec3d point = from + (to - from) * t;
  point.z = clip_depth_;
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
      (shows[k] ? from : to) = cutPoint(set_->vertices[triangle[k]], set_->vertices[triangle[next]]);
    }
  }
  makeRoom(1);
  chains_.push_back({count_, 1, value});
  cuts_.push_back({count_++, from, to});
}

// Sets an edge's line to what is left of it beyond the clip depth.
void ChainEdges::clip(std::uint32_t edge) {
  const Vec3f a(ends_[0][edge], ends_[1][edge], ends_[2][edge]),
      b(ends_[3][edge], ends_[4][edge], ends_[5][edge]);
  const Vec3d from = toCamera(a), to = toCamera(b);
  const bool from_shows = from.z >= clip_depth_, to_shows = to.z >= clip_depth_;
  if (from_shows || to_shows) {
    setLine(edge, from_shows ? from : cutPoint(a, b), to_shows ? to : cutPoint(a, b));
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
    for (std::uint32_t edge = 0; edge < count_; ++edge) {
      clip(edge);
    }
  }
  for (const Cut& cut : cuts_) {
    setLine(cut.edge, cut.from, cut.to);
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
  chains_.clear();
  cuts_.clear();
  count_ = 0;
  return static_cast<std::uint32_t>(edges_.size()) - before;
}

}  // namespace sightline::occlusion
#endif
