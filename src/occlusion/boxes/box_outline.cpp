// All is computed in double precision, relative to the eye.
//
// A ray through the place (X, Y) of the buffer has the direction r = tx right + ty up + forward, where
// tx = (X - middle_x) / scale_x, ty likewise; right, up and forward are PixelView's unit_x, unit_y, unit_z.
//
//   Edge along the axis e through the corner a:  the plane through the eye has the normal n = a x e, which
//     takes no subtraction; the box is where n . r >= 0. Orthographic: n = forward x e, and n . (tx right +
//     ty up - a) >= 0.
//   Face at l metres from the eye along the axis e:  1 / depth = (e . r) / l. Orthographic:
//     -depth = (e . (tx right + ty up) - l) / (e . forward).
//
// Each is f.x tx + f.y ty + f.z, a sum of three terms, with a few roundings in every one. The coordinates of
// f are sums of two products: an edge's normal has two coordinates that are not 0, a face has 1 / l alone.
// Two edges along each axis may belong to the outline. So each function has a slot of its own, the same for
// all boxes, and a vector has all edges of a box.

#include "src/occlusion/boxes/box_outline.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "src/geometry/box_tangents.h"
#include "src/occlusion/eye_box.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/boxes/box_outline.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SIGHTLINE_BOX_OUTLINE_ONCE
#define SIGHTLINE_BOX_OUTLINE_ONCE
namespace sightline::occlusion {

// The functions of one box before they are multiplied out.
struct OutlineFactors {
  static constexpr std::uint32_t kSlots = BoxOutline::kStored;

  alignas(64) double p[kSlots], q[kSlots];  // of first and second; 0 in empty slots
  // Orthographic views alone: the third coordinate has factors of its own, and this bounds the sum of the
  // terms in each of the three.
  alignas(64) double third_p[kSlots], third_q[kSlots], size[kSlots];
  double tx = 0.0, ty = 0.0;  // at the origin of the functions
  double reach = 0.0;         // pixels from there
  double extent = 0.0;        // a bound of |tx| + |ty| + 1 within reach
};

}  // namespace sightline::occlusion
#endif

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void multiplyOut(const OutlineView& view, const OutlineFactors& factors, BoxOutline& outline) {
  constexpr double kWideRounding = 0x1p-48;    // of the terms in double precision, with a factor of 8
  constexpr double kSingleRounding = 0x1p-21;  // of coefficients, products and sums in single precision: 5 u
  constexpr double kTooLarge = 1e30;           // functions beyond this say nothing
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  const bool orthographic = view.view.orthographic;
  outline.has_faces = false;
  for (std::size_t slot = 0; slot < BoxOutline::kSlots; slot += hn::Lanes(d)) {
    const bool faces = slot >= BoxOutline::kFirstFace;
    const auto p = hn::Load(d, factors.p + slot), q = hn::Load(d, factors.q + slot);
    const auto sum = [&](const double* first, const double* second) HWY_ATTR {
      return hn::Add(hn::Mul(p, hn::Load(d, first + slot)), hn::Mul(q, hn::Load(d, second + slot)));
    };
    const auto x = sum(view.first[0], view.second[0]), y = sum(view.first[1], view.second[1]);
    const auto z = orthographic ? sum(factors.third_p, factors.third_q) : sum(view.first[2], view.second[2]);
    const auto size = orthographic ? hn::Load(d, factors.size + slot)
                      : faces      ? hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z))
                                   : hn::Add(hn::Abs(p), hn::Abs(q));
    const auto along_x = hn::Mul(x, hn::Set(d, view.per_x)), along_y = hn::Mul(y, hn::Set(d, view.per_y));
    const auto at_origin =
        hn::Add(hn::Add(hn::Mul(x, hn::Set(d, factors.tx)), hn::Mul(y, hn::Set(d, factors.ty))), z);
    const auto wide = hn::Mul(size, hn::Set(d, factors.extent));
    const auto along = hn::Add(hn::Abs(along_x), hn::Abs(along_y));
    const auto single = hn::Add(hn::Mul(along, hn::Set(d, factors.reach)), hn::Abs(at_origin));
    const auto too_large = hn::Set(d, kTooLarge);
    auto says = hn::And(hn::Lt(wide, too_large), hn::Lt(single, too_large));
    if (faces) {
      says = hn::And(says, hn::Ne(p, hn::Zero(d)));
      outline.has_faces = outline.has_faces || !hn::AllFalse(d, says);
    }
    const auto rounding =
        hn::Add(hn::Mul(hn::Set(d, kWideRounding), wide), hn::Mul(hn::Set(d, kSingleRounding), single));
    // The smallest numbers of single precision are coarse; they are far below any of a scene.
    const auto raised = hn::Add(hn::Add(at_origin, rounding), hn::Set(d, 0x1p-120));
    const auto nothing = hn::Set(d, faces ? double{std::numeric_limits<float>::max()} : 1.0);
    const auto store = [&](auto value, float* to)
                           HWY_ATTR { hn::Store(hn::DemoteTo(df, value), df, to + slot); };
    store(hn::IfThenElseZero(says, along_x), outline.along_x);
    store(hn::IfThenElseZero(says, along_y), outline.along_y);
    store(hn::IfThenElse(says, raised, nothing), outline.at_origin);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(multiplyOut);

// The axes across the edge of a slot, in ascending order.
constexpr int firstAxis(std::uint32_t slot) {
  return slot / 2 == 0 ? 1 : 0;
}
constexpr int secondAxis(std::uint32_t slot) {
  return slot / 2 == 2 ? 1 : 2;
}

// A box relative to the eye: its minimal x, y, z, then its maximal ones.
using Bounds = std::array<double, 6>;

// An edge of the outline.
struct OutlineEdge {
  // A corner of it, in Bounds: its coordinates along the axes across the edge, and along the edge.
  std::uint8_t first = 0, second = 0, along = 0;
  // The normal v x e has v[second] along the first axis and -v[first] along the second one, or both the other
  // way round. 0: the slot is empty.
  double sign = 0.0;
};
using OutlineEdges = std::array<OutlineEdge, BoxOutline::kEdges>;

// The outlines of boxes that the eye sees from each of the regions, by slot.
std::array<OutlineEdges, geometry::kRegions> edgesOfRegions() {
  std::array<OutlineEdges, geometry::kRegions> table{};
  for (int region = 0; region < geometry::kRegions; ++region) {
    const geometry::Silhouette& loop = geometry::silhouetteFrom(region);
    for (int i = 0; i < loop.count; ++i) {
      const auto from = loop.corners[static_cast<std::size_t>(i)];
      const auto to = loop.corners[static_cast<std::size_t>(i + 1 < loop.count ? i + 1 : 0)];
      const auto axis = static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(from ^ to)));
      OutlineEdges& edges = table[static_cast<std::size_t>(region)];
      const std::uint32_t slot = edges[2 * axis].sign == 0.0 ? 2 * axis : 2 * axis + 1;
      const auto inBounds = [&](int of) { return static_cast<std::uint8_t>(of + 3 * (from >> of & 1)); };
      const double turned = axis == 1 ? -1.0 : 1.0;
      edges[slot] = {inBounds(firstAxis(slot)), inBounds(secondAxis(slot)), inBounds(static_cast<int>(axis)),
                     to > from ? turned : -turned};
    }
  }
  return table;
}

int regionOfEye(const scene::PixelView& view, const EyeBox& box) {
  if (!view.orthographic) {
    return geometry::regionOfOrigin(box.min, box.max);
  }
  // An eye infinitely far behind.
  const auto digit = [](double forward) { return forward > 0.0 ? 1 : forward < 0.0 ? 2 : 0; };
  return digit(view.unit_z.x) + 3 * digit(view.unit_z.y) + 9 * digit(view.unit_z.z);
}

void setEdges(const scene::PixelView& view, const EyeBox& box, int region, OutlineFactors& factors) {
  static const std::array<OutlineEdges, geometry::kRegions> kEdges = edgesOfRegions();
  const OutlineEdges& edges = kEdges[static_cast<std::size_t>(region)];
  const Bounds bounds{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
  for (std::uint32_t slot = 0; slot < BoxOutline::kEdges; ++slot) {
    const OutlineEdge& edge = edges[slot];
    if (!view.orthographic) {
      factors.p[slot] = bounds[edge.second] * edge.sign;
      factors.q[slot] = -bounds[edge.first] * edge.sign;
      continue;
    }
    factors.p[slot] = view.unit_z[secondAxis(slot)] * edge.sign;
    factors.q[slot] = -view.unit_z[firstAxis(slot)] * edge.sign;
    factors.third_p[slot] = -bounds[edge.first];
    factors.third_q[slot] = -bounds[edge.second];
    // The axes are as good as unit vectors. What they are off by counts by the distance from the eye, however
    // short the normal is.
    const double distance =
        std::abs(bounds[edge.first]) + std::abs(bounds[edge.second]) + std::abs(bounds[edge.along]);
    factors.size[slot] = 2.0 * (1.0 + distance);
  }
}

void setFaces(const scene::PixelView& view, const EyeBox& box, int region, OutlineFactors& factors) {
  for (int axis = 0; axis < 3; ++axis, region /= 3) {
    if (region % 3 == 0) {
      continue;
    }
    const std::size_t slot = BoxOutline::kFirstFace + static_cast<std::size_t>(axis);
    const double distance = region % 3 == 1 ? box.min[axis] : box.max[axis];
    factors.p[slot] = 1.0 / (view.orthographic ? view.unit_z[axis] : distance);
    if (view.orthographic) {
      factors.third_p[slot] = -distance;
      factors.size[slot] = std::abs(factors.p[slot]) * (1.0 + box.farthest());
    }
  }
}

}  // namespace

OutlineView::OutlineView(const scene::PixelView& pixel_view)
    : view(pixel_view),
      sane(pixel_view.sane()),
      per_x(1.0 / pixel_view.scale_x),
      per_y(1.0 / pixel_view.scale_y) {
  const Vec3d* axes[3] = {&view.unit_x, &view.unit_y, &view.unit_z};
  for (int c = 0; c < 3; ++c) {
    for (std::uint32_t slot = 0; slot < BoxOutline::kEdges; ++slot) {
      first[c][slot] = (*axes[c])[firstAxis(slot)];
      second[c][slot] = (*axes[c])[secondAxis(slot)];
    }
    for (int axis = 0; axis < 3; ++axis) {
      first[c][BoxOutline::kFirstFace + static_cast<std::size_t>(axis)] = (*axes[c])[axis];
    }
  }
}

BoxOutline outlineOf(const OutlineView& view, const Box& box, std::uint32_t x, std::uint32_t y,
                     double reach) {
  const EyeBox eye_box = EyeBox::of(box, view.view.eye);
  OutlineFactors factors;
  factors.tx = (x - view.view.middle_x) * view.per_x;
  factors.ty = (y - view.view.middle_y) * view.per_y;
  factors.reach = reach;
  factors.extent = std::abs(factors.tx) + std::abs(factors.ty) + (view.per_x + view.per_y) * reach + 1.0;
  // Slots without an edge or a face.
  std::fill(factors.p + BoxOutline::kEdges, std::end(factors.p), 0.0);
  std::fill(factors.q + BoxOutline::kEdges, std::end(factors.q), 0.0);
  if (view.view.orthographic) {
    for (double* list : {factors.third_p, factors.third_q, factors.size}) {
      std::fill_n(list, OutlineFactors::kSlots, 0.0);
    }
  }
  const int region = regionOfEye(view.view, eye_box);
  setEdges(view.view, eye_box, region, factors);
  setFaces(view.view, eye_box, region, factors);
  BoxOutline outline;
  HWY_DYNAMIC_DISPATCH(multiplyOut)(view, factors, outline);
  return outline;
}

}  // namespace sightline::occlusion
#endif
