// What of a World is drawn in a view, and in which order.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/math/frustum.h"
#include "src/occlusion/surfaces/surface_aims.h"
#include "src/world/world_eye.h"

namespace sightline::world {
namespace {

constexpr std::uint32_t kLongestDelay = 15;
// A join is not drawn either where rounding moves a member by more than this part of its distance.
constexpr double kDepthRounding = 0x1p-21;

// Metres: how far the nearest point of a box is from the eye's plane; negative behind it.
double nearestDepth(const Box& box, const View& view) {
  const Vec3d half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  return dot(view.forward, center(box) - view.eye) - dot(abs(view.forward), half);
}

// By how many pixels of a picture of this size, in x or in y, two points appear apart at most that are this
// far apart and at least this far from the eye's plane (metres).
double pixelsApart(double metres, double nearest, const View& view, const DepthBufferView& picture) {
  const double high = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  const double scale = 0.5 * std::max(picture.height / high, picture.width / (high * view.aspect));
  if (view.orthographic) {
    return metres * scale;
  }
  // What moves in depth moves by this part of it across the picture.
  const double slope =
      high * (std::max(view.aspect, 1.0)) * (1.0 + std::max(std::abs(view.shift_x), std::abs(view.shift_y)));
  return metres * (1.0 + slope) * scale / std::max(nearest, view.z_near);
}

}  // namespace

// Whether the surfaces of a join are wholly drawn in the view.
bool WorldEye::isJoined(const WorldData& data, const Joined& joined) const {
  if ((joined.groups & settings_.groups) == 0) {
    return false;
  }
  if (clip_ == Plane()) {
    return true;
  }
  const Vec3d to_origin = data.origin - joined.join.origin;
  // The members lie within join.rounding of where the join's surfaces are.
  const double rounding = clip_rounding_ + joined.join.rounding * length(clip_.normal) +
                          0x1p-48 * dot(abs(clip_.normal), abs(to_origin));
  return sideOf({clip_.normal, clip_.evaluate(-to_origin)}, joined.join.surfaces.bounds, rounding) > 0;
}

// Whether an instance hides, and all of it is drawn in the view.
bool WorldEye::hidesInView(const WorldData& data, std::uint32_t id) const {
  return data.hides(id) && isDrawn(data.instances[id]) &&
         (clip_ == Plane() || sideOf(clip_, data.boxOf(id), clip_rounding_) > 0);
}

// Sets of_join_ and alone_. The candidates may have been removed, hidden or moved since they were kept.
void WorldEye::takeCandidates(const WorldData& data, const View& view,
                              std::span<const InstanceId> candidates) {
  of_join_.resize(std::max(of_join_.size(), data.joins.size()));
  for (std::vector<ObjectId>& members : of_join_) {
    members.clear();
  }
  alone_.clear();
  for (const InstanceId id : candidates) {
    if (id.value >= data.instances.size() || !hidesInView(data, id.value)) {
      continue;
    }
    const InstanceData& own = data.instances[id.value];
    const bool joined = own.join != InstanceData::kNone && isJoined(data, data.joins[own.join]);
    if (joined) {
      of_join_[own.join].emplace_back(own.object);
    }
    if (own.alone || !joined) {
      alone_.push_back(id.value);
    }
  }
  for (std::uint32_t join = 0; join < of_join_.size(); ++join) {
    if (!of_join_[join].empty() && isBlurred(data, data.joins[join].join, view)) {
      separate(data, join);
    }
  }
}

// Whether the rounding of the positions of a join might show. All members count, candidates or not, as the
// surfaces of one may be found together with those of any other.
bool WorldEye::isBlurred(const WorldData& data, const WorldJoin& join, const View& view) const {
  if (join.rounding == 0.0) {
    return false;
  }
  if (!(settings_.join_rounding > 0.0)) {
    return true;
  }
  const auto shows = [&](const Box& box) {
    const double nearest = nearestDepth(box, view);
    return pixelsApart(join.rounding, nearest, view, pyramid_.depthBuffer()) > settings_.join_rounding ||
           join.rounding > kDepthRounding * std::max(nearest, view.z_near);
  };
  // Most joins end here: none of their members is so near.
  const Vec3d from_origin = join.origin - data.origin;
  const Vec3d margin = Vec3d{1.0, 1.0, 1.0} * (join.rounding + 0x1p-20 * length(from_origin));
  const Box all{Vec3f(Vec3d(join.surfaces.bounds.min) + from_origin - margin),
                Vec3f(Vec3d(join.surfaces.bounds.max) + from_origin + margin)};
  if (all.wellFormed() && !shows(all)) {
    return false;
  }
  const Frustum frustum = frustumOf(view);
  return std::any_of(join.instances.begin(), join.instances.end(), [&](InstanceId id) {
    if (!id.valid()) {
      return false;  // it has left, and its surfaces with it
    }
    if (!data.hides(id.value)) {
      return true;  // it has no box from this origin
    }
    const Box& box = data.boxOf(id.value);
    return shows(box) && std::none_of(frustum.planes.begin(), frustum.planes.end(), [&](const Plane& plane) {
             return sideOf(plane, box, join.rounding) < 0;
           });
  });
}

// Has the members of a join drawn by their own meshes.
void WorldEye::separate(const WorldData& data, std::uint32_t join) {
  for (const ObjectId object : of_join_[join]) {
    const InstanceId id = data.joins[join].join.instances[object.value];
    if (!data.instances[id.value].alone) {  // else it is drawn so already
      alone_.push_back(id.value);
    }
  }
  of_join_[join].clear();
}

// Returns the work.
std::uint32_t WorldEye::draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates,
                             const SurfaceDrawing& drawing) {
  if (!drawing.useful_only || !data.joins.empty()) {
    takeCandidates(data, view, candidates);
  }
  if (drawing.useful_only) {
    takeUseful(data);
  }
  return drawInOrder(data, view, drawing);
}

// Appends the joins that have members to be drawn to in_order_.
void WorldEye::listJoins(const WorldData& data, const View& view) {
  for (std::uint32_t join = 0; join < data.joins.size(); ++join) {
    const WorldJoin& joined = data.joins[join].join;
    View own = view;  // in the space of the join
    own.eye = view.eye + data.origin - joined.origin;
    double nearest = std::numeric_limits<double>::infinity();
    for (const ObjectId object : of_join_[join]) {
      nearest = std::min(nearest, nearestDepth(joined.surfaces.object_bounds[object.value], own));
    }
    if (!of_join_[join].empty()) {
      const bool before_eye = !view.orthographic && !(nearest > view.z_near);
      const double inverse = view.orthographic ? -nearest : 1.0 / nearest;
      in_order_.push_back(
          {join, true, before_eye ? std::numeric_limits<float>::infinity() : static_cast<float>(inverse)});
    }
  }
}

// Sets alone_ to the instances that paid in the frame before, the most useful ones first.
void WorldEye::takeUseful(const WorldData& data) {
  std::sort(useful_before_.begin(), useful_before_.end(), [](const Useful& a, const Useful& b) {
    return a.gain != b.gain ? a.gain > b.gain : a.id < b.id;
  });
  alone_.clear();
  for (const Useful& useful : useful_before_) {
    if (useful.id >= data.instances.size()) {
      continue;
    }
    const InstanceData& own = data.instances[useful.id];
    // What is drawn with a join need not be drawn alone.
    if (own.born == useful.born && hidesInView(data, useful.id) &&
        (own.alone || own.join == InstanceData::kNone || of_join_[own.join].empty())) {
      alone_.push_back(useful.id);
    }
  }
}

// Whether an instance is not drawn now, whatever it covers.
bool WorldEye::waits(const WorldData& data, std::uint32_t id, const SurfaceDrawing& drawing) const {
  const Past& past = pasts_[id];
  const bool rests = drawing.step != ViewStep::kJump && !drawing.draw_resting && past.until > frame_;
  return past.born == data.instances[id].born && (past.drawn_in == frame_ || rests);
}

// Appends those of alone_ that are large enough and do not wait to in_order_.
void WorldEye::listAlone(const WorldData& data, const View& view, const SurfaceDrawing& drawing) {
  std::erase_if(alone_, [&](std::uint32_t id) { return waits(data, id, drawing); });
  boxes_.clear();
  for (const std::uint32_t id : alone_) {
    boxes_.push_back(data.boxOf(id));
  }
  images_.resize(std::max(images_.size(), boxes_.size()));
  const DepthBufferView buffer = pyramid_.depthBuffer();
  occlusion::projectBoxes(scene::PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height,
                          boxes_, images_);
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    const occlusion::PixelBox& image = images_[i];
    const bool near = image.place == occlusion::BoxPlace::kUnbounded;
    const double pixels = static_cast<double>(image.x1 - image.x0 + 1) * (image.y1 - image.y0 + 1);
    // Through the hole that the near plane cuts into a drawn mesh one sees past what hides in its place.
    const bool open = near && data.meshes[data.instances[alone_[i]].mesh].mesh.has_occluder;
    if (image.place != occlusion::BoxPlace::kOutside && !open &&
        (near || pixels >= drawing.limits.min_pixels)) {
      in_order_.push_back({alone_[i], false, near ? std::numeric_limits<float>::infinity() : image.nearest});
    }
  }
}

// Draws joins, and instances alone: in the order of alone_ where what was useful is drawn, else the nearest
// ones first. Returns the work.
std::uint32_t WorldEye::drawInOrder(const WorldData& data, const View& view, SurfaceDrawing drawing) {
  const std::uint32_t budget = drawing.limits.budget;
  in_order_.clear();
  listJoins(data, view);
  listAlone(data, view, drawing);
  if (!drawing.useful_only) {
    std::sort(in_order_.begin(), in_order_.end(), [](const Candidate& a, const Candidate& b) {
      return a.nearest != b.nearest ? a.nearest > b.nearest : a.join != b.join ? a.join : a.number < b.number;
    });
  }
  for (const Candidate& candidate : in_order_) {
    if (drawing.limits.budget == 0) {
      break;
    }
    const SurfaceStats drawn = candidate.join ? drawJoin(data, candidate.number, drawing)
                                              : drawAlone(data, candidate.number, drawing);
    counts_.occluders += drawn.groups > 0 ? 1 : 0;
    counts_.edges += drawn.edges;
    drawing.limits.budget -= std::min(drawing.limits.budget, drawn.work);
  }
  return budget - drawing.limits.budget;
}

SurfaceStats WorldEye::drawJoin(const WorldData& data, std::uint32_t join, const SurfaceDrawing& drawing) {
  const WorldJoin& joined = data.joins[join].join;
  MovingSurfaces placed{&joined.surfaces, {}};
  for (int axis = 0; axis < 3; ++axis) {
    placed.scene_from_surfaces(axis, 3) = joined.origin[axis] - data.origin[axis];
  }
  return pyramid_.draw(placed, of_join_[join], drawing);
}

SurfaceStats WorldEye::drawAlone(const WorldData& data, std::uint32_t id, const SurfaceDrawing& drawing) {
  const MeshData& mesh = data.meshes[data.instances[id].mesh];
  const SurfaceStats drawn =
      pyramid_.draw(MovingSurfaces{&mesh.mesh.surfaces, data.originFromMesh(id)}, drawing);
  account(data, id, drawn, drawing);
  return drawn;
}

// What did not pay in a frame for which it was drawn because it had paid before is not drawn first in the
// next one; what did not pay otherwise rests. Nothing is learnt of what is not before a target.
void WorldEye::account(const WorldData& data, std::uint32_t id, const SurfaceStats& drawn,
                       const SurfaceDrawing& drawing) {
  const bool aims = !drawing.targets.empty();
  if (aims && drawn.groups == 0) {
    return;
  }
  const std::uint64_t born = data.instances[id].born;
  Past& past = pasts_[id];
  const std::uint32_t last = past.born == born ? past.length : 0;
  past = {.born = born, .drawn_in = frame_};
  if (drawn.groups > 0 && !(drawn.gain < occlusion::leastGain(aims) * drawn.work)) {
    useful_.push_back({id, drawn.gain, born});
  } else if (!drawing.useful_only) {
    // Instances that begin to rest in the same frame are drawn again in different ones.
    past.length = std::min(2 * last + 1, kLongestDelay);
    past.until = frame_ + 1 + past.length + id % (past.length / 2 + 1);
  }
}

}  // namespace sightline::world
