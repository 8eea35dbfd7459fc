#include "src/world/world_eye.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "sightline/math/frustum.h"

namespace sightline::world {

using hierarchy::DynamicTree;

namespace {

constexpr double kMinGain = 0.3;  // pixels that must become nearer for each unit of work
constexpr std::uint32_t kLongestDelay = 15;
// A join is not drawn either where rounding moves a member by more than this part of its distance.
constexpr double kDepthRounding = 0x1p-21;

double microsecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

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
  return metres * (1.0 + slope) * scale / std::max(nearest, view.near);
}

}  // namespace

int sideOf(const Plane& plane, const Box& box, double offset_rounding) {
  const Vec3d middle = center(box), half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  const Vec3d size = abs(plane.normal);
  const double at = plane.evaluate(middle), reach = dot(size, half);
  const double rounding =
      0x1p-48 * (dot(size, abs(middle) + half) + std::abs(plane.offset)) + offset_rounding;
  return at - reach >= rounding ? 1 : at + reach < -rounding ? -1 : 0;
}

void addAll(const DynamicTree& tree, std::uint32_t number, IdBits& kept) {
  if (number == DynamicTree::kNone) {
    return;
  }
  const DynamicTree::Node node = tree.node(number);
  for (const std::uint32_t child : node.children) {
    if (node.leaf) {
      kept.insert(child);
    } else {
      addAll(tree, child, kept);
    }
  }
}

View WorldEye::begin(const WorldData& data, const View& view_world) {
  View view = view_world;
  view.eye = view.eye - data.origin;
  // The two parts of the offset may be much larger than their sum.
  clip_ = {clip_world_.normal, clip_world_.evaluate(data.origin)};
  clip_rounding_ = 0x1p-48 * (dot(abs(clip_world_.normal), abs(data.origin)) + std::abs(clip_world_.offset));
  pyramid_.begin(view);
  return view;
}

void WorldEye::cull(const WorldData& data, const View& view_world, std::span<const InstanceId> last,
                    const IdBits& last_set, IdBits& kept, WorldCullStats& stats) {
  const auto start = std::chrono::steady_clock::now();
  const bool jumped = last_view_.jumpsTo(view_world);
  ++frame_;
  counts_ = {};
  const View view = begin(data, view_world);
  sets_.find(data, view_world, clip_world_ == Plane() ? settings_.groups : 0);
  if (settings_.occlusion && jumped) {
    test(data, true);
    listed_.clear();
    found_.list(listed_);
    draw(data, view, listed_, ViewStep::kJump);
  } else if (settings_.occlusion) {
    draw(data, view, last, ViewStep::kNext);
  }
  pyramid_.finish();
  stats.draw_us += microsecondsSince(start);
  const auto drawn = std::chrono::steady_clock::now();
  test(data, false);
  if (settings_.occlusion && !jumped) {
    listed_.clear();
    found_.listWithout(last_set, listed_);
    if (culling::changesFast(listed_.size(), last.size())) {
      draw(data, view, listed_, ViewStep::kSame);
      pyramid_.finish();
      test(data, false);
    }
  }
  stats.test_us += microsecondsSince(drawn);
  stats.occluders += counts_.occluders;
  stats.edges += counts_.edges;
  stats.nodes_tested += counts_.nodes_tested;
  stats.boxes_tested += counts_.boxes_tested;
  kept.add(found_);
}

// Sets found_ to what may be seen, of all or by the view's volume alone.
void WorldEye::test(const WorldData& data, bool view_only) {
  found_.clear(data.instances.size());
  test(data.settled, view_only);
  test(data.moving, view_only);
  if (settings_.groups != 0xffffffffu || !(clip_ == Plane())) {
    found_.removeIf([&](std::uint32_t id) {
      const InstanceData& own = data.instances[id];
      return !isDrawn(own) || sideOf(clip_, data.boxOf(id), clip_rounding_) < 0;
    });
  }
  sets_.restrict(data, found_);
}

void WorldEye::test(const DynamicTree& tree, bool view_only) {
  stack_.clear();
  if (tree.root() != DynamicTree::kNone) {
    stack_.push_back({tree.root(), view_only});
  }
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    const DynamicTree::Node node = tree.node(entry.node);
    const std::span<BoxAnswer> answers = std::span(answers_).first(node.boxes.size());
    if (entry.view_only) {
      pyramid_.classifyInView(node.boxes, answers);
    } else {
      pyramid_.classify(node.boxes, answers, {.plain_from = node.leaf ? 0 : node.boxes.size()});
    }
    ++counts_.nodes_tested;
    counts_.boxes_tested += static_cast<std::uint32_t>(node.boxes.size());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const Visibility visibility = answers[i].visibility;
      if (visibility == Visibility::kHidden) {
        continue;
      }
      const bool sees_all = entry.view_only || visibility == Visibility::kVisible;
      if (node.leaf) {
        found_.insert(node.children[i]);
      } else if (sees_all && answers[i].within_view) {
        addAll(tree, node.children[i], found_);
      } else {
        stack_.push_back({node.children[i], sees_all});
      }
    }
  }
}

// Whether the surfaces of a join are wholly drawn in the view.
bool WorldEye::isJoined(const WorldData& data, const Joined& joined) const {
  if ((joined.groups & settings_.groups) == 0) {
    return false;
  }
  if (clip_ == Plane()) {
    return true;
  }
  const Vec3d to_origin = data.origin - joined.join.origin;
  const double rounding = clip_rounding_ + 0x1p-48 * dot(abs(clip_.normal), abs(to_origin));
  return sideOf({clip_.normal, clip_.evaluate(-to_origin)}, joined.join.surfaces.bounds, rounding) > 0;
}

// Sets of_join_ and alone_. The candidates may have been removed, hidden or moved since they were kept.
void WorldEye::takeCandidates(const WorldData& data, const View& view,
                              std::span<const InstanceId> candidates) {
  of_join_.resize(std::max(of_join_.size(), data.joins.size()));
  for (std::vector<ObjectId>& members : of_join_) {
    members.clear();
  }
  alone_.clear();
  const bool clips = !(clip_ == Plane());
  for (const InstanceId id : candidates) {
    if (id.value >= data.instances.size() || !data.hides(id.value)) {
      continue;
    }
    const InstanceData& own = data.instances[id.value];
    if (!isDrawn(own) || (clips && sideOf(clip_, data.boxOf(id.value), clip_rounding_) <= 0)) {
      continue;
    }
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
           join.rounding > kDepthRounding * std::max(nearest, view.near);
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

void WorldEye::draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates,
                    ViewStep step) {
  takeCandidates(data, view, candidates);
  SurfaceDrawing drawing = usual_work_.limited(settings_.drawing, step == ViewStep::kJump);
  drawing.step = step;
  const std::uint32_t budget = drawing.budget;
  drawJoins(data, drawing);
  drawAlone(data, view, drawing);
  if (step != ViewStep::kSame) {
    usual_work_.frame(budget - drawing.budget);
  }
}

// Takes what it draws from drawing.budget, as does drawAlone().
void WorldEye::drawJoins(const WorldData& data, SurfaceDrawing& drawing) {
  for (std::uint32_t join = 0; join < data.joins.size() && drawing.budget > 0; ++join) {
    if (of_join_[join].empty()) {
      continue;
    }
    const WorldJoin& joined = data.joins[join].join;
    MovingSurfaces placed{&joined.surfaces, {}};
    for (int axis = 0; axis < 3; ++axis) {
      placed.scene_from_surfaces(axis, 3) = joined.origin[axis] - data.origin[axis];
    }
    const SurfaceStats drawn = pyramid_.draw(placed, of_join_[join], drawing);
    counts_.occluders += drawn.groups > 0 ? 1 : 0;
    counts_.edges += drawn.edges;
    drawing.budget -= std::min(drawing.budget, drawn.work);
  }
}

// Sets near_first_ to those of alone_ that are large enough and whose retest delay is over.
void WorldEye::listNearFirst(const WorldData& data, const View& view, const SurfaceDrawing& drawing) {
  boxes_.clear();
  for (const std::uint32_t id : alone_) {
    boxes_.push_back(data.boxOf(id));
  }
  images_.resize(std::max(images_.size(), boxes_.size()));
  const DepthBufferView buffer = pyramid_.depthBuffer();
  occlusion::projectBoxes(PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height, boxes_,
                          images_);
  near_first_.clear();
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    const occlusion::PixelBox& image = images_[i];
    const bool near = image.place == occlusion::BoxPlace::kUnbounded;
    const double pixels = static_cast<double>(image.x1 - image.x0 + 1) * (image.y1 - image.y0 + 1);
    const RetestDelay& delay = retest_delays_[alone_[i]];
    const bool waits = drawing.step == ViewStep::kNext && delay.until > frame_ &&
                       delay.born == data.instances[alone_[i]].born;
    // Through the hole that the near plane cuts into a drawn mesh one sees past what hides in its place.
    const bool open = near && data.meshes[data.instances[alone_[i]].mesh].mesh.has_occluder;
    if (image.place != occlusion::BoxPlace::kOutside && !open && !waits &&
        (near || pixels >= drawing.min_pixels)) {
      near_first_.push_back({alone_[i], near ? std::numeric_limits<float>::infinity() : image.nearest});
    }
  }
  std::sort(near_first_.begin(), near_first_.end(), [](const Candidate& a, const Candidate& b) {
    return a.nearest != b.nearest ? a.nearest > b.nearest : a.id < b.id;
  });
}

void WorldEye::drawAlone(const WorldData& data, const View& view, SurfaceDrawing& drawing) {
  // A world that grows within what was reserved makes this vector copy nothing either.
  retest_delays_.reserve(data.instances.capacity());
  retest_delays_.resize(std::max(retest_delays_.size(), data.instances.size()));
  listNearFirst(data, view, drawing);
  for (const Candidate& candidate : near_first_) {
    if (drawing.budget == 0) {
      break;
    }
    const InstanceData& own = data.instances[candidate.id];
    const SurfaceStats drawn = pyramid_.draw(
        MovingSurfaces{&data.meshes[own.mesh].mesh.surfaces, data.originFromMesh(candidate.id)}, drawing);
    counts_.occluders += drawn.groups > 0 ? 1 : 0;
    counts_.edges += drawn.edges;
    drawing.budget -= std::min(drawing.budget, drawn.work);
    RetestDelay& delay = retest_delays_[candidate.id];
    if (drawn.groups == 0 || drawn.gain < kMinGain * drawn.work) {
      // Instances whose delay begins in the same frame are drawn again in different ones.
      const std::uint32_t last = delay.born == own.born ? delay.length : 0;
      const std::uint32_t length = std::min(2 * last + 1, kLongestDelay);
      delay = {own.born, frame_ + 1 + length + candidate.id % (length / 2 + 1), length};
    } else {
      delay = {own.born, 0, 0};
    }
  }
}

Visibility WorldEye::classify(const Box& box) const {
  return box.wellFormed() && sideOf(clip_, box, clip_rounding_) < 0 ? Visibility::kHidden
                                                                    : pyramid_.classify(box);
}

Visibility WorldEye::look(const WorldData& data, const View& view_world, const Box& box,
                          std::span<const InstanceId> ignored) {
  ++frame_;
  counts_ = {};
  const View view = begin(data, view_world);
  test(data, true);
  for (const InstanceId id : ignored) {
    found_.remove(id.value);
  }
  listed_.clear();
  found_.list(listed_);
  takeCandidates(data, view, listed_);
  // What an ignored member of a join hides is not known apart from what the others do.
  for (std::uint32_t join = 0; join < of_join_.size(); ++join) {
    const auto of_this = [&](InstanceId id) {
      return id.value < data.instances.size() && data.instances[id.value].join == join;
    };
    if (!of_join_[join].empty() && std::any_of(ignored.begin(), ignored.end(), of_this)) {
      separate(data, join);
    }
  }
  SurfaceDrawing drawing = settings_.drawing;
  drawing.step = ViewStep::kJump;
  const bool nothing_between = listed_.empty() && data.unbounded.empty();
  drawJoins(data, drawing);
  drawAlone(data, view, drawing);
  pyramid_.finish();
  const Visibility visibility = pyramid_.classify(box);
  return visibility == Visibility::kVisible && !nothing_between ? Visibility::kPartial : visibility;
}

}  // namespace sightline::world
