#include "oracle/eye_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline {
namespace {

constexpr int kProjections = 200;  // onto each side in turn, to find a point of the region

Vec3d clampTo(const EyeRegion& region, const Vec3d& p) {
  return {std::clamp(p.x, region.min.x, region.max.x), std::clamp(p.y, region.min.y, region.max.y),
          std::clamp(p.z, region.min.z, region.max.z)};
}

}  // namespace

bool EyeRegion::contains(const Vec3d& p) const {
  return p.x >= min.x && p.y >= min.y && p.z >= min.z && p.x <= max.x && p.y <= max.y && p.z <= max.z &&
         std::all_of(sides.begin(), sides.end(),
                     [&](const HalfSpace& side) { return dot(side.normal, p) >= side.offset; });
}

EyePlaces::EyePlaces(EyeRegion region) : region_(std::move(region)) {
  empty_ = !findInner();
}

// Projects onto the sides, which are moved inwards as far as possible.
bool EyePlaces::findInner() {
  const Vec3d extent = region_.max - region_.min;
  const double size = length(extent);
  for (const double share : {0.1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0}) {
    const Vec3d margin = extent * (0.5 * share);
    const EyeRegion shrunk{region_.min + margin, region_.max - margin, {}};
    inner_ = (region_.min + region_.max) * 0.5;
    for (int i = 0; i < kProjections && (i == 0 || !region_.contains(inner_)); ++i) {
      for (const HalfSpace& side : region_.sides) {
        const double missing = side.offset + share * size - dot(side.normal, inner_);
        inner_ += side.normal * std::max(missing, 0.0);
      }
      inner_ = clampTo(shrunk, inner_);
    }
    if (region_.contains(inner_)) {
      return true;
    }
  }
  return false;
}

Vec3d EyePlaces::inside(const Vec3d& point) const {
  const Vec3d clamped = clampTo(region_, point);
  for (const double share : {0.0, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3}) {
    const Vec3d moved = clampTo(region_, clamped + (inner_ - clamped) * share);
    if (region_.contains(moved)) {
      return moved;
    }
  }
  return inner_;
}

Vec3d EyePlaces::point(SplitMix& random) const {
  const std::uint32_t on_faces = random.below(4);  // 0: anywhere, 3: a corner of the box
  const std::uint32_t first = random.below(3);
  Vec3d p;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>((first + i) % 3);
    const double low = region_.min[axis], high = region_.max[axis];
    p[axis] =
        i < on_faces ? (random.below(2) == 0 ? low : high) : std::clamp(random.in(low, high), low, high);
  }
  return towards(p);
}

Vec3d EyePlaces::corner(std::uint32_t i) const {
  return towards({(i & 1) != 0 ? region_.max.x : region_.min.x, (i & 2) != 0 ? region_.max.y : region_.min.y,
                  (i & 4) != 0 ? region_.max.z : region_.min.z});
}

Vec3d EyePlaces::towards(const Vec3d& point) const {
  double enter = 0.0, leave = 1.0;
  if (!region_.contains(point) && interval(inner_, point - inner_, enter, leave)) {
    return inside(inner_ + (point - inner_) * std::min(leave, 1.0));
  }
  return inside(point);
}

bool EyePlaces::interval(const Vec3d& origin, const Vec3d& direction, double& enter, double& leave) const {
  enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
  for (const HalfSpace& face : faces()) {
    const double along = dot(face.normal, direction), above = dot(face.normal, origin) - face.offset;
    if (along > 0.0) {
      enter = std::max(enter, -above / along);
    } else if (along < 0.0) {
      leave = std::min(leave, -above / along);
    } else if (above < 0.0) {
      return false;
    }
  }
  return enter <= leave;
}

std::vector<HalfSpace> EyePlaces::faces() const {
  std::vector<HalfSpace> all = region_.sides;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d normal{};
    normal[axis] = 1.0;
    all.push_back({normal, region_.min[axis]});
    all.push_back({-normal, -region_.max[axis]});
  }
  return all;
}

}  // namespace sightline
