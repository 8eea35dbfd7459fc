#include "src/occlusion/planes/eye_planes.h"

#include "sightline/geometry/tolerance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/planes/eye_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// No fused operations: they would round differently from one instruction set to another.
std::size_t testAllAgainstEyePlanes(std::span<const EyeShape> shapes, std::span<const EyeQuad> quads,
                                    std::span<const std::uint32_t> list, const EyeBox& box,
                                    std::span<EyePlaneTest> tests) {
  const hn::CappedTag<double, 4> d;
  const auto low_x = hn::Set(d, box.min.x), low_y = hn::Set(d, box.min.y), low_z = hn::Set(d, box.min.z);
  const auto high_x = hn::Set(d, box.max.x), high_y = hn::Set(d, box.max.y), high_z = hn::Set(d, box.max.z);
  const double farthest_corner = box.farthest();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const EyeShape& shape = shapes[list[i]];
    EyePlaneTest& test = tests[i];
    test = {};
    const Vec3d at_low(shape.normal.x * box.min.x, shape.normal.y * box.min.y, shape.normal.z * box.min.z);
    const Vec3d at_high(shape.normal.x * box.max.x, shape.normal.y * box.max.y, shape.normal.z * box.max.z);
    const Vec3d nearest = max(at_low, at_high), farthest = min(at_low, at_high);
    const double margin = shape.depth_margin + kDepthMargin * (farthest_corner + shape.reach);
    if (!(farthest.x + farthest.y + farthest.z + shape.offset < -margin)) {
      continue;
    }
    const auto tolerance = hn::Set(d, -kEyePlane * (farthest_corner + shape.reach));
    test.touches = true;
    for (std::uint32_t first = 0; first < shape.plane_count; first += 4) {
      const EyeQuad& quad = quads[shape.first_quad + first / 4];
      for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
        const auto x = hn::LoadU(d, quad.x + lane), y = hn::LoadU(d, quad.y + lane);
        const auto z = hn::LoadU(d, quad.z + lane), offset = hn::LoadU(d, quad.offset + lane);
        const auto x0 = hn::Mul(x, low_x), x1 = hn::Mul(x, high_x);
        const auto y0 = hn::Mul(y, low_y), y1 = hn::Mul(y, high_y);
        const auto z0 = hn::Mul(z, low_z), z1 = hn::Mul(z, high_z);
        const auto min = hn::Add(hn::Add(hn::Add(hn::Min(x0, x1), hn::Min(y0, y1)), hn::Min(z0, z1)), offset);
        const auto max = hn::Add(hn::Add(hn::Add(hn::Max(x0, x1), hn::Max(y0, y1)), hn::Max(z0, z1)), offset);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Not(hn::Lt(max, tolerance)), bits);
        test.failing |= std::uint64_t{bits[0]} << (first + lane);
        test.touches = test.touches && hn::AllTrue(d, hn::Lt(min, tolerance));
      }
    }
    test.behind = nearest.x + nearest.y + nearest.z + shape.offset < -margin;
    if (test.hidden()) {
      return i + 1;
    }
  }
  return list.size();
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(testAllAgainstEyePlanes);

std::size_t testAgainstEyePlanes(std::span<const EyeShape> shapes, std::span<const EyeQuad> quads,
                                 std::span<const std::uint32_t> list, const EyeBox& box,
                                 std::span<EyePlaneTest> tests) {
  return HWY_DYNAMIC_DISPATCH(testAllAgainstEyePlanes)(shapes, quads, list, box, tests);
}

}  // namespace sightline::occlusion
#endif
