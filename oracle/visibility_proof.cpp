#include "oracle/visibility_proof.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace sightline {
namespace {

struct PositionHash {
  std::size_t operator()(const Vec3f& p) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(p[axis] + 0.0f)) * 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
  }
};

}  // namespace

ProofScene::ProofScene(const SceneView& scene_) : scene(scene_), tree(scene_) {
  std::unordered_map<Vec3f, std::uint32_t, PositionHash> first;
  same_position.resize(scene.positions.size());
  for (std::uint32_t i = 0; i < same_position.size(); ++i) {
    const Vec3f& p = scene.positions[i];
    if (isFinite(p)) {
      same_position[i] = first.emplace(p, i).first->second;
      lowest_exponent = std::min(lowest_exponent, lowestExponent(Vec3d(p)));
    }
  }
  for (const Object& object : scene.objects) {
    if (object.bounds.wellFormed()) {
      lowest_exponent = std::min({lowest_exponent, lowestExponent(Vec3d(object.bounds.min)),
                                  lowestExponent(Vec3d(object.bounds.max))});
    }
  }
}

ImageTriangle ProofScene::corners(std::uint32_t first_index) const {
  const auto position = [&](std::uint32_t i) { return same_position[scene.indices[first_index + i]]; };
  return {position(0), position(1), position(2)};
}

VisibilityProof::VisibilityProof(const ProofScene& scene, const RayScene& rays, const View& view)
    : scene_(scene),
      rays_(rays),
      space_(view, scene.scene.positions, scene.lowest_exponent, box_corners_),
      figures_(space_) {}

void VisibilityProof::beginFigures() {
  figures_.clear();
  appearances_.clear();
  pieces_.clear();
  picture_ = rectangle(figures_, space_.picture());
  near_ = figures_.depthGiven(space_.view().z_near);
  far_ = figures_.depthGiven(std::isfinite(space_.view().z_far) ? space_.view().z_far : 1.0);
}

VisibilityProof::Appearance& VisibilityProof::appearance(const Triangle& triangle) {
  const auto [entry, is_new] = appearances_.try_emplace(triangleKey(triangle.object, triangle.first_index));
  Appearance& appearance = entry->second;
  if (!is_new) {
    return appearance;
  }
  const ImageTriangle t = scene_.corners(triangle.first_index);
  const Object& of = scene_.scene.objects[triangle.object.value];
  const int orientation = figures_.orientation(t);
  appearance.occludes = occludes(scene_.scene, of);
  appearance.shown = orientation < 0 || (orientation > 0 && scene_.scene.materialOf(of).double_sided);
  if (!appearance.shown) {
    return appearance;
  }
  const bool turned = orientation < 0;
  appearance.region.lines = {figures_.lineThrough(t.a, t.b, turned), figures_.lineThrough(t.b, t.c, turned),
                             figures_.lineThrough(t.c, t.a, turned)};
  appearance.depth = figures_.depthOf(t);
  cutAtNear(appearance.region, appearance.depth);
  return appearance;
}

// Leaves of a plane what is not before the near plane.
void VisibilityProof::cutAtNear(ImageRegion& region, Depth depth) {
  if (space_.view().z_near > 0.0 || space_.view().orthographic) {
    const Line beyond_near = figures_.lineWhereNearer(near_, depth);
    if (!figures_.dividesNothing(beyond_near)) {
      region.lines.push_back(beyond_near);
    }
  }
}

// The directions in which a triangle is nearer than the target. On the last of the lines both are at the same
// distance, and the triangle hides nothing. All figures are of one target.
const ImageRegion& VisibilityProof::hiddenBy(const Triangle& blocker, const Target& target) {
  Appearance& shown = appearance(blocker);
  if (shown.hides.lines.empty()) {
    shown.hides = shown.region;
    shown.hides.lines.push_back(figures_.lineWhereNearer(shown.depth, target.depth));
  }
  return shown.hides;
}

bool VisibilityProof::contains(const ImageRegion& region, Corner direction) {
  return std::all_of(region.lines.begin(), region.lines.end(),
                     [&](Line line) { return figures_.side(line, direction) >= 0; });
}

void VisibilityProof::begin(std::uint32_t max_steps) {
  steps_ = 0;
  max_steps_ = max_steps;
  witness_.reset();
}

Decision VisibilityProof::decide(ObjectId object, std::uint32_t max_steps) {
  begin(max_steps);
  std::vector<std::uint32_t> open;
  if (const std::uint32_t root = scene_.tree.rootOf(object); root != TriangleTree::kNoNode) {
    open.push_back(root);
  }
  bool undecided = false;
  while (!open.empty()) {
    const TriangleTree::Node& node = scene_.tree.node(open.back());
    open.pop_back();
    const Cover cover =
        node.isLeaf() ? coverTriangle({node.first_index, node.object}) : coverBox(node.box, object);
    if (cover == Cover::kSeen) {
      return {Verdict::kVisible, *witness_};
    }
    if (cover == Cover::kOpen && !node.isLeaf() && steps_ < max_steps_) {
      open.insert(open.end(), {node.left, node.right});
    } else if (cover == Cover::kOpen) {
      undecided = true;
    }
  }
  return {undecided ? Verdict::kUndecided : Verdict::kHidden, {object, {}}};
}

VisibilityProof::Cover VisibilityProof::coverTriangle(const Triangle& triangle) {
  beginFigures();
  const Appearance& shown = appearance(triangle);
  if (!shown.shown) {
    return Cover::kHidden;
  }
  return coverImage({.kind = TargetKind::kTriangle,
                     .object = triangle.object,
                     .depth = shown.depth,
                     .first_index = triangle.first_index,
                     .plane = scene_.corners(triangle.first_index)},
                    shown.region);
}

// Covers what the picture shows of a target in a region that begins at the near plane.
VisibilityProof::Cover VisibilityProof::coverImage(const Target& target, ImageRegion region) {
  if (std::isfinite(space_.view().z_far)) {
    const Line before_far = figures_.lineWhereNearer(target.depth, far_);
    if (!figures_.dividesNothing(before_far)) {
      region.lines.push_back(before_far);
    }
  }
  ImagePolygon image = clipped(figures_, picture_, region);
  if (image.empty()) {
    return coverBorder(target, region);
  }
  pieces_.push_back(std::move(image));
  return coverPolygons(target);
}

// The corners of what the picture shows of a region, some of them several times.
std::vector<VisibilityProof::Corner> VisibilityProof::cornersInPicture(ImageRegion region) {
  region.lines.insert(region.lines.end(), picture_.edges.begin(), picture_.edges.end());
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < region.lines.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Corner corner = figures_.intersection(region.lines[i], region.lines[j]);
      if (figures_.isBeforeTheEye(corner) && contains(region, corner)) {
        corners.push_back(corner);
      }
    }
  }
  return corners;
}

// Covers an image without area: that of a triangle that touches the view volume from outside. It is empty, a
// point or a part of a line.
VisibilityProof::Cover VisibilityProof::coverBorder(const Target& target, ImageRegion image) {
  const std::vector<Corner> ends = cornersInPicture(image);
  image.lines.insert(image.lines.end(), picture_.edges.begin(), picture_.edges.end());
  if (const Cover cover = coverPoints(target, ends); cover != Cover::kHidden) {
    return cover;
  }
  const auto along = std::find_if(image.lines.begin(), image.lines.end(), [&](Line line) {
    return std::all_of(ends.begin(), ends.end(), [&](Corner end) { return figures_.side(line, end) == 0; });
  });
  for (std::size_t i = 0; i < ends.size() && along != image.lines.end(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (const Cover cover = coverTie(target, ends[i], ends[j], *along); cover != Cover::kHidden) {
        return cover;
      }
    }
  }
  return Cover::kHidden;
}

VisibilityProof::Cover VisibilityProof::coverPolygons(const Target& target) {
  while (!pieces_.empty()) {
    if (++steps_ > max_steps_) {
      return Cover::kOpen;
    }
    const ImagePolygon piece = std::move(pieces_.back());
    pieces_.pop_back();
    if (const Cover cover = coverPiece(target, piece); cover != Cover::kHidden) {
      return cover;
    }
  }
  return Cover::kHidden;
}

// Casts rays through the inside of the piece; hits_ are what they show.
void VisibilityProof::castRays(const ImagePolygon& piece) {
  const auto inPlane = [&](Corner corner) {
    const Vec3d d = figures_.direction(corner);
    return d / dot(d, space_.forward());
  };
  const std::size_t count = piece.corners.size();
  Vec3d middle{};
  for (const Corner corner : piece.corners) {
    middle += inPlane(corner) / static_cast<double>(count);
  }
  directions_.assign(1, middle);
  for (std::size_t i = 0; i < count && directions_.size() + 2 <= RayScene::kBatch; ++i) {
    const Vec3d a = inPlane(piece.corners[i]), b = inPlane(piece.corners[(i + 1) % count]);
    directions_.push_back(a * 0.9 + middle * 0.1);
    directions_.push_back((a + b) * 0.4 + middle * 0.2);
  }
  RayScene::Batch batch;
  const auto length = static_cast<float>(space_.view().z_far - space_.view().z_near);
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const ViewRay ray = space_.ray(directions_[i]);
    batch[i] = {Vec3f(ray.origin), Vec3f(ray.direction), length};
  }
  hits_.clear();
  rays_.trace(batch, static_cast<std::uint32_t>(directions_.size()), false, hits_);
}

// Appends what nearer triangles leave of the piece to pieces_.
VisibilityProof::Cover VisibilityProof::coverPiece(const Target& target, const ImagePolygon& piece) {
  castRays(piece);
  if (const Cover cover = findBlockers(target, piece); cover != Cover::kHidden) {
    return cover;
  }
  bool progress = false;
  parts_.assign(1, piece);
  for (const Triangle& blocker : blockers_) {
    if (!appearance(blocker).shown) {
      continue;
    }
    const ImageRegion hidden = hiddenBy(blocker, target);
    next_parts_.clear();
    for (ImagePolygon& part : parts_) {
      const ImagePolygon inside = subtract(figures_, part, hidden, next_parts_);
      if (inside.empty()) {
        next_parts_.push_back(std::move(part));
        continue;
      }
      progress = true;
      if (const Cover cover = coverTies(target, inside, hidden.lines.back()); cover != Cover::kHidden) {
        return cover;
      }
    }
    std::swap(parts_, next_parts_);
  }
  if (!progress) {
    return target.kind == TargetKind::kDirections ? Cover::kOpen : coverOutOfRaysReach(target, piece);
  }
  std::move(parts_.begin(), parts_.end(), std::back_inserter(pieces_));
  return Cover::kHidden;
}

// Sets blockers_ to the nearer triangles that the rays hit. Directions are given up where a ray reaches the
// depth.
VisibilityProof::Cover VisibilityProof::findBlockers(const Target& target, const ImagePolygon& piece) {
  blockers_.clear();
  std::array<bool, RayScene::kBatch> blocked{};
  for (const RayHit& hit : hits_) {
    if (hit.object == target.object && seen(hit.object, figures_.cornerGiven(directions_[hit.ray]))) {
      return Cover::kSeen;
    }
    if (hit.opaque && isBefore(hit, target)) {
      blocked[hit.ray] = true;
      addBlocker({hit.first_index, hit.object});
    }
  }
  if (target.kind == TargetKind::kSide) {
    return lookPastBlockers(target, piece, blocked);
  }
  const auto rays = static_cast<std::ptrdiff_t>(directions_.size());
  const bool reached = std::count(blocked.begin(), blocked.begin() + rays, true) < rays;
  return target.kind == TargetKind::kDirections && reached ? Cover::kOpen : Cover::kHidden;
}

// Whether what the ray hit may hide the target, as far as single precision tells. Rays hit the triangles of
// the scene, so the first hit is before a triangle unless it is that triangle.
bool VisibilityProof::isBefore(const RayHit& hit, const Target& target) const {
  if (target.kind == TargetKind::kTriangle) {
    return hit.first_index != target.first_index;  // also of another object with the same corners: a tie
  }
  const View& view = space_.view();
  const double depth = view.z_near + static_cast<double>(hit.t);
  return depth < (target.kind == TargetKind::kDirections
                      ? target.nearest
                      : depthOf(view, pointOnPlane(target.plane, directions_[hit.ray])));
}

void VisibilityProof::addBlocker(const Triangle& blocker) {
  if (std::find(blockers_.begin(), blockers_.end(), blocker) == blockers_.end()) {
    blockers_.push_back(blocker);
  }
}

// Looks along the rays that nothing seems to block. What blocks them after all is a blocker as well.
VisibilityProof::Cover VisibilityProof::lookPastBlockers(const Target& target, const ImagePolygon& piece,
                                                         const std::array<bool, RayScene::kBatch>& blocked) {
  for (std::size_t ray = 0; ray < directions_.size(); ++ray) {
    if (blocked[ray]) {
      continue;
    }
    const Corner direction = figures_.cornerGiven(directions_[ray]);
    if (!isInside(piece, direction)) {
      continue;
    }
    const std::optional<Triangle> blocker = blockerOf(target, direction);
    if (!blocker) {
      return seenAt(target, direction);
    }
    addBlocker(*blocker);
  }
  return Cover::kHidden;
}

// True if the direction is strictly inside the piece, exactly.
bool VisibilityProof::isInside(const ImagePolygon& piece, Corner direction) {
  return std::all_of(piece.edges.begin(), piece.edges.end(), [&](Line edge) {
    for (const Corner corner : piece.corners) {
      if (const int side = figures_.side(edge, corner); side != 0) {
        return side == figures_.side(edge, direction);
      }
    }
    return false;
  });
}

// A direction strictly inside the piece, exactly.
VisibilityProof::Corner VisibilityProof::inside(const ImagePolygon& piece) {
  const Corner middle = figures_.cornerGiven(directions_.front());
  return isInside(piece, middle) ? middle : figures_.cornerBetween(piece.corners);
}

// Rays in single precision found no triangle to subtract: searches without them.
VisibilityProof::Cover VisibilityProof::coverOutOfRaysReach(const Target& target, const ImagePolygon& piece) {
  const Corner direction = inside(piece);
  const std::optional<Triangle> blocker = blockerOf(target, direction);
  if (!blocker) {
    return seenAt(target, direction);
  }
  const ImageRegion hidden = hiddenBy(*blocker, target);
  const ImagePolygon covered = subtract(figures_, piece, hidden, pieces_);
  if (!covered.empty()) {
    return coverTies(target, covered, hidden.lines.back());
  }
  // The near plane leaves no area of this blocker. It is in the way no more if the piece ends there.
  for (const Line line : hidden.lines) {
    if (figures_.side(line, direction) == 0) {
      DividedPolygon parts = divide(figures_, piece, line);
      pieces_.push_back(std::move(parts.positive));
      pieces_.push_back(std::move(parts.negative));
      return Cover::kHidden;
    }
  }
  return Cover::kOpen;
}

// Where the blocker touches the target, it does not hide it: another triangle must.
VisibilityProof::Cover VisibilityProof::coverTies(const Target& target, const ImagePolygon& inside,
                                                  Line tie) {
  if (target.kind == TargetKind::kDirections) {
    return Cover::kHidden;  // the depth lies before all that is in it
  }
  std::vector<Corner> touching;
  for (const Corner corner : inside.corners) {
    if (figures_.side(tie, corner) == 0) {
      touching.push_back(corner);
    }
  }
  if (const Cover cover = coverPoints(target, touching); cover != Cover::kHidden) {
    return cover;
  }
  return touching.size() == 2 ? coverTie(target, touching[0], touching[1], tie) : Cover::kHidden;
}

VisibilityProof::Cover VisibilityProof::coverPoints(const Target& target, std::span<const Corner> points) {
  for (const Corner point : points) {
    if (++steps_ > max_steps_) {
      return Cover::kOpen;
    }
    if (!blockerOf(target, point)) {
      return seenAt(target, point);
    }
  }
  return Cover::kHidden;
}

// Covers the directions between two, of which both are hidden, along the line `tie`.
VisibilityProof::Cover VisibilityProof::coverTie(const Target& target, Corner from, Corner to, Line tie) {
  std::vector<std::pair<Corner, Corner>> open{{from, to}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    if (++steps_ > max_steps_) {
      return Cover::kOpen;
    }
    const std::array<Corner, 2> ends{begin, end};
    const Corner middle = figures_.cornerBetween(ends);
    const std::optional<Triangle> blocker = blockerOf(target, middle);
    if (!blocker) {
      return seenAt(target, middle);
    }
    const ImageRegion hidden = hiddenBy(*blocker, target);
    Corner low = begin, high = end;  // of the part that the blocker hides
    for (const Line line : hidden.lines) {
      const int at_low = figures_.side(line, low), at_high = figures_.side(line, high);
      if (at_low >= 0 && at_high >= 0) {
        continue;
      }
      (at_low < 0 ? low : high) = figures_.intersection(tie, line);
    }
    for (const Corner border : {low, high}) {
      if (border != begin && border != end && figures_.side(hidden.lines.back(), border) == 0 &&
          !blockerOf(target, border)) {
        return seenAt(target, border);
      }
    }
    if (low != begin) {
      open.emplace_back(begin, low);
    }
    if (high != end) {
      open.emplace_back(high, end);
    }
  }
  return Cover::kHidden;
}

// A triangle that hides the target's point in this direction.
std::optional<VisibilityProof::Triangle> VisibilityProof::blockerOf(const Target& target, Corner direction) {
  std::optional<Triangle> found;
  const ViewRay line = space_.lineOfSight(figures_.direction(direction));
  scene_.tree.alongRay(
      line.origin, line.direction, space_.originSlack(), [&](const TriangleTree::Node& leaf) {
        const Triangle blocker{leaf.first_index, leaf.object};
        if (found || leaf.first_index == target.first_index || !appearance(blocker).shown ||
            !appearance(blocker).occludes || !contains(appearance(blocker).region, direction)) {
          return;
        }
        if (figures_.side(hiddenBy(blocker, target).lines.back(), direction) > 0) {
          found = blocker;
        }
      });
  return found;
}

VisibilityProof::Cover VisibilityProof::seenAt(const Target& target, Corner direction) {
  witness_ = SeenPoint{target.object, pointAt(target.plane, direction)};
  return Cover::kSeen;
}

// True if a triangle of the object is reached before any opaque surface. Sets the witness.
bool VisibilityProof::seen(ObjectId object, Corner direction) {
  const bool in_picture = std::all_of(picture_.edges.begin(), picture_.edges.end(),
                                      [&](Line edge) { return figures_.side(edge, direction) >= 0; });
  if (!in_picture) {
    return false;
  }
  std::vector<std::uint32_t> own;
  std::vector<Depth> opaque;
  const ViewRay line = space_.lineOfSight(figures_.direction(direction));
  scene_.tree.alongRay(line.origin, line.direction, space_.originSlack(),
                       [&](const TriangleTree::Node& leaf) {
                         const Appearance& shown = appearance({leaf.first_index, leaf.object});
                         if (shown.shown && contains(shown.region, direction)) {
                           if (leaf.object == object) {
                             own.push_back(leaf.first_index);
                           }
                           if (shown.occludes) {
                             opaque.push_back(shown.depth);
                           }
                         }
                       });
  const bool has_far = std::isfinite(space_.view().z_far);
  for (const std::uint32_t first_index : own) {
    const Depth depth = appearances_.at(triangleKey(object, first_index)).depth;
    const bool in_view = !has_far || figures_.side(figures_.lineWhereNearer(depth, far_), direction) >= 0;
    const bool hidden = std::any_of(opaque.begin(), opaque.end(), [&](Depth blocker) {
      return blocker != depth && figures_.side(figures_.lineWhereNearer(blocker, depth), direction) > 0;
    });
    if (in_view && !hidden) {
      witness_ = SeenPoint{object, pointAt(scene_.corners(first_index), direction)};
      return true;
    }
  }
  return false;
}

bool VisibilityProof::reaches(const Vec3d& point, ObjectId object) {
  beginFigures();
  return isFinite(point) && depthOf(space_.view(), point) > 0.0 && seen(object, figures_.cornerOf(point));
}

// The point of the plane in this direction, rounded.
Vec3d VisibilityProof::pointAt(const ImageTriangle& plane, Corner direction) const {
  return pointOnPlane(plane, figures_.direction(direction));
}

Vec3d VisibilityProof::pointOnPlane(const ImageTriangle& plane, const Vec3d& direction) const {
  const Vec3d a = space_.position(plane.a);
  const ViewRay ray = space_.lineOfSight(direction);
  const Vec3d normal = cross(space_.position(plane.b) - a, space_.position(plane.c) - a);
  return ray.origin + ray.direction * (dot(a - ray.origin, normal) / dot(ray.direction, normal));
}

}  // namespace sightline
