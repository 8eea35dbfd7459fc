// Based on: Snyder, Lengyel. MSR-TR-97-11, Figure 15.
// Differs from the paper in: all steps are run for a few hundred pixels at a time, whose registers stay in
// the L1 cache; Rover is the target itself.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

#include "sightline/layers/shaped_image.h"

namespace sightline {
namespace {

ShapedPixel times(const ShapedPixel& p, float factor) {
  return {p.red * factor, p.green * factor, p.blue * factor, p.alpha * factor};
}
ShapedPixel plus(const ShapedPixel& p, const ShapedPixel& q) {
  return {p.red + q.red, p.green + q.green, p.blue + q.blue, p.alpha + q.alpha};
}
ShapedPixel in(const ShapedPixel& p, const ShapedPixel& q) {
  return times(p, q.alpha);
}
ShapedPixel out(const ShapedPixel& p, const ShapedPixel& q) {
  return times(p, 1.0f - q.alpha);
}
ShapedPixel over(const ShapedPixel& p, const ShapedPixel& q) {
  return plus(p, out(q, p));
}

// A pixel is one vector of four floats. The compiler's code is as fast as wider vectors, which wait for
// memory.
template <typename Combine>
void forPixels(ShapedPixel* __restrict to, const ShapedPixel* __restrict from, std::size_t pixels,
               Combine combine) {
  for (std::size_t i = 0; i < pixels; ++i) {
    to[i] = combine(to[i], from[i]);
  }
}

void combinePixels(CompositingOp op, ShapedPixel* to, const ShapedPixel* from, std::size_t pixels) {
  using Pixel = const ShapedPixel&;
  switch (op) {
    case CompositingOp::kIn:
      return forPixels(to, from, pixels, [](Pixel r, Pixel s) { return in(r, s); });
    case CompositingOp::kOut:
      return forPixels(to, from, pixels, [](Pixel r, Pixel s) { return out(r, s); });
    case CompositingOp::kAdd:
      return forPixels(to, from, pixels, [](Pixel r, Pixel s) { return plus(r, s); });
    case CompositingOp::kOver:
      return forPixels(to, from, pixels, [](Pixel r, Pixel s) { return over(r, s); });
    case CompositingOp::kLoad:
    case CompositingOp::kStartSum:
    case CompositingOp::kStartImage:
      std::memcpy(to, from, pixels * sizeof(ShapedPixel));
      return;
  }
}

// A stretch of pixels of a row in all images, and the registers for it.
struct Stretch {
  std::span<const ShapedImage> images;
  std::size_t x = 0, y = 0, pixels = 0;
  ShapedPixel *star = nullptr, *sum = nullptr, *image = nullptr;

  ShapedPixel* written(CompositingOp op) const {
    if (op == CompositingOp::kOver || op == CompositingOp::kStartImage) {
      return image;
    }
    return op == CompositingOp::kAdd || op == CompositingOp::kStartSum ? sum : star;
  }
  // Returns the operand of a step, or null for a transparent one.
  const ShapedPixel* operand(const CompositingStep& step) const {
    if (step.layer.valid()) {
      const ShapedImage& layer = images[step.layer.value];
      return layer.pixels == nullptr ? nullptr : layer.pixels + y * layer.stride + x;
    }
    return written(step.op) == image ? sum : star;
  }
};

// Runs a step with a transparent operand.
void combineWithNothing(CompositingOp op, ShapedPixel* to, std::size_t pixels) {
  if (op != CompositingOp::kOut && op != CompositingOp::kAdd && op != CompositingOp::kOver) {
    std::fill_n(to, pixels, ShapedPixel{});
  }
}

void evaluateStretch(std::span<const CompositingStep> steps, const Stretch& stretch) {
  if (steps.empty()) {
    std::fill_n(stretch.image, stretch.pixels, ShapedPixel{});
  }
  for (const CompositingStep& step : steps) {
    ShapedPixel* to = stretch.written(step.op);
    if (const ShapedPixel* from = stretch.operand(step)) {
      combinePixels(step.op, to, from, stretch.pixels);
    } else {
      combineWithNothing(step.op, to, stretch.pixels);
    }
  }
}

Status checkSizes(const CompositingProgram& program, std::span<const ShapedImage> images,
                  const ShapedTarget& target, std::span<const ShapedPixel> scratch) {
  if (images.size() < program.layers) {
    return Error{"evaluate: fewer images than the program has layers"};
  }
  if (scratch.size() < 2) {
    return Error{"evaluate: less than 2 pixels of scratch"};
  }
  const bool has_target = target.pixels != nullptr && target.stride >= target.width;
  if (target.width != 0 && target.height != 0 && !has_target) {
    return Error{"evaluate: the target has no pixels, or its stride is below its width"};
  }
  for (const ShapedImage& image : images.first(program.layers)) {
    const bool same = image.width == target.width && image.height == target.height;
    if (image.pixels != nullptr && (!same || image.stride < image.width)) {
      return Error{"evaluate: an image has another size than the target, or a stride below its width"};
    }
  }
  return Success{};
}

}  // namespace

Status evaluate(const CompositingProgram& program, std::span<const ShapedImage> images, ShapedTarget target,
                std::span<ShapedPixel> scratch) {
  if (auto status = checkSizes(program, images, target, scratch); !status) {
    return status;
  }
  if (auto status = checkProgram(program.steps, program.layers); !status) {
    return status;
  }
  const std::size_t stretch_pixels = scratch.size() / 2, width = target.width;
  for (std::size_t y = 0; y < target.height; ++y) {
    for (std::size_t x = 0; x < width; x += stretch_pixels) {
      evaluateStretch(program.steps, {.images = images,
                                      .x = x,
                                      .y = y,
                                      .pixels = std::min(stretch_pixels, width - x),
                                      .star = scratch.data(),
                                      .sum = scratch.data() + stretch_pixels,
                                      .image = target.pixels + y * target.stride + x});
    }
  }
  return Success{};
}

ShapedPixel evaluatePixel(const CompositingProgram& program, std::span<const ShapedPixel> layers) {
  ShapedPixel star, sum, image;
  for (const CompositingStep& step : program.steps) {
    const bool is_image = step.op == CompositingOp::kOver || step.op == CompositingOp::kStartImage;
    const bool is_sum = step.op == CompositingOp::kAdd || step.op == CompositingOp::kStartSum;
    const ShapedPixel operand = step.layer.valid() ? layers[step.layer.value] : is_image ? sum : star;
    combinePixels(step.op, is_image ? &image : is_sum ? &sum : &star, &operand, 1);
  }
  return image;
}

}  // namespace sightline
