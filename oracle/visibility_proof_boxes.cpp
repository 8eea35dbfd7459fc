// The part of VisibilityProof that is about boxes: those around triangles, and bounding boxes of objects.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "oracle/visibility_proof.h"

namespace sightline {
namespace {

constexpr double kMargin = 1e-12;  // relative; a thousand times the rounding of a box's extents in the image

constexpr std::uint32_t kSides = 6;
// The corners of each side of a box, counter-clockwise as seen from outside. Bit 0 of a corner's number says
// that its x is the box's greatest, bit 1 its y, bit 2 its z.
constexpr std::uint32_t kSideCorners[kSides][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                   {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

Vec3f cornerOf(const Box& box, std::uint32_t corner) {
  return {(corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
          (corner & 4) != 0 ? box.max.z : box.min.z};
}

}  // namespace

// Rounded outwards.
VisibilityProof::BoxImage VisibilityProof::imageOf(const Box& box) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BoxImage image{{kInfinity, -kInfinity, kInfinity, -kInfinity}, true, kInfinity, -kInfinity};
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const Vec3d p(cornerOf(box, corner));
    const View& view = space_.view();
    const double margin = kMargin * length(p - view.eye), depth = depthOf(view, p);
    image.nearest = std::min(image.nearest, depth - margin);
    image.farthest = std::max(image.farthest, depth + margin);
    const Vec3d d = space_.directionOf(p);
    const double scale = dot(d, space_.forward());
    if (!(scale > 1e3 * margin)) {
      image.before_the_eye = false;
      continue;
    }
    const double x = dot(d, space_.right()) / scale, y = dot(d, space_.up()) / scale;
    const double widen = 4.0 * margin / scale;
    const double x_margin = widen * (1.0 + std::abs(x)), y_margin = widen * (1.0 + std::abs(y));
    image.extents = {std::min(image.extents.x_min, x - x_margin), std::max(image.extents.x_max, x + x_margin),
                     std::min(image.extents.y_min, y - y_margin),
                     std::max(image.extents.y_max, y + y_margin)};
  }
  return image;
}

VisibilityProof::Cover VisibilityProof::coverBox(const Box& box, ObjectId object) {
  const View& view = space_.view();
  const BoxImage image = imageOf(box);
  if (image.farthest < view.z_near || image.nearest > view.z_far) {
    return Cover::kHidden;
  }
  if (!image.before_the_eye || !(image.nearest > view.z_near)) {
    return Cover::kOpen;
  }
  const ImageRectangle &extents = image.extents, picture = space_.picture();
  const ImageRectangle shown{std::max(extents.x_min, picture.x_min), std::min(extents.x_max, picture.x_max),
                             std::max(extents.y_min, picture.y_min), std::min(extents.y_max, picture.y_max)};
  if (!(shown.x_min < shown.x_max && shown.y_min < shown.y_max)) {
    return Cover::kHidden;
  }
  beginFigures();
  pieces_.push_back(rectangle(figures_, shown));
  return coverPolygons({.kind = TargetKind::kDirections,
                        .object = object,
                        .depth = figures_.depthGiven(image.nearest),
                        .nearest = image.nearest});
}

Decision VisibilityProof::decideBox(ObjectId object, std::uint32_t max_steps) {
  begin(max_steps);
  const Box& box = scene_.scene.objects[object.value].bounds;
  if (scene_.tree.rootOf(object) == TriangleTree::kNoNode) {
    return {Verdict::kHidden, {object, {}}};
  }
  if (!box.wellFormed()) {
    return {Verdict::kVisible, {object, center(box)}};
  }
  for (std::uint32_t corner = 0; corner < box_corners_.size(); ++corner) {
    box_corners_[corner] = cornerOf(box, corner);
  }
  Cover cover = coverBox(box, object);
  if (cover == Cover::kOpen && !(imageOf(box).nearest > space_.view().z_near)) {
    if (const std::optional<Corner> direction = directionIntoBox()) {
      return {Verdict::kVisible, {object, space_.ray(figures_.direction(*direction)).origin}};
    }
  }
  if (cover == Cover::kOpen) {
    cover = coverSides(object);
  }
  switch (cover) {
    case Cover::kSeen:
      return {Verdict::kVisible, *witness_};
    case Cover::kHidden:
      return {Verdict::kHidden, {object, {}}};
    default:
      return {Verdict::kUndecided, {object, {}}};
  }
}

// Returns a side of the box whose corners are box_corners_. Points are numbered: the scene's positions come
// first, then these corners.
VisibilityProof::Side VisibilityProof::side(std::uint32_t number) {
  const auto first = static_cast<std::uint32_t>(scene_.scene.positions.size());
  const auto corner = [&](std::uint32_t i) { return first + kSideCorners[number][i % 4]; };
  Side side{.plane = {corner(0), corner(1), corner(2)}};
  const int orientation = figures_.orientation(side.plane);
  side.shown = orientation != 0;
  side.front = orientation < 0;
  if (side.shown) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      side.region.lines.push_back(figures_.lineThrough(corner(i), corner(i + 1), side.front));
    }
    side.depth = figures_.depthOf(side.plane);
    cutAtNear(side.region, side.depth);
  }
  return side;
}

// A direction in which a ray is inside the box where it starts on the near plane: it leaves the box through a
// side beyond that plane, and does not enter it there.
std::optional<VisibilityProof::Corner> VisibilityProof::directionIntoBox() {
  beginFigures();
  std::vector<ImageRegion> entered;
  std::vector<ImagePolygon> left;
  std::vector<Corner> touched;  // by a side that has no area in the picture
  for (std::uint32_t number = 0; number < kSides; ++number) {
    Side side = this->side(number);
    if (side.shown && side.front) {
      entered.push_back(std::move(side.region));
    } else if (side.shown) {
      left.push_back(clipped(figures_, picture_, side.region));
      if (left.back().empty()) {
        left.pop_back();
        const std::vector<Corner> corners = cornersInPicture(side.region);
        touched.insert(touched.end(), corners.begin(), corners.end());
      }
    }
  }
  for (const ImageRegion& region : entered) {
    std::vector<ImagePolygon> rest;
    for (ImagePolygon& part : left) {
      if (subtract(figures_, part, region, rest).empty()) {
        rest.push_back(std::move(part));
      }
    }
    left = std::move(rest);
  }
  if (!left.empty()) {
    return figures_.cornerBetween(left.front().corners);
  }
  const auto at = std::find_if(touched.begin(), touched.end(), [&](Corner corner) {
    return std::none_of(entered.begin(), entered.end(),
                        [&](const ImageRegion& region) { return contains(region, corner); });
  });
  return at != touched.end() ? std::optional(*at) : std::nullopt;
}

// Covers the sides of the box that show their front. They hide the others.
VisibilityProof::Cover VisibilityProof::coverSides(ObjectId object) {
  Cover all = Cover::kHidden;
  for (std::uint32_t number = 0; number < kSides; ++number) {
    beginFigures();
    const Side side = this->side(number);
    if (!side.shown || !side.front) {
      continue;
    }
    const Cover cover = coverImage(
        {.kind = TargetKind::kSide, .object = object, .depth = side.depth, .plane = side.plane}, side.region);
    if (cover == Cover::kSeen) {
      return cover;
    }
    all = cover == Cover::kOpen ? cover : all;
  }
  return all;
}

}  // namespace sightline
