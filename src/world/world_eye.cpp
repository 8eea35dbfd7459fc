#include "src/world/world_eye.h"

#include <algorithm>
#include <cmath>

#include "src/base/stopwatch.h"

namespace sightline::world {

using hierarchy::DynamicTree;

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
  const View view = data.fromOrigin(view_world);
  // The two parts of the offset may be much larger than their sum.
  clip_ = {clip_world_.normal, clip_world_.evaluate(data.origin)};
  clip_rounding_ = 0x1p-48 * (dot(abs(clip_world_.normal), abs(data.origin)) + std::abs(clip_world_.offset));
  pyramid_.begin(view);
  return view;
}

void WorldEye::cull(const WorldData& data, const View& view_world, std::span<const InstanceId> last,
                    const IdBits& last_set, IdBits& kept, WorldCullStats& stats) {
  base::Stopwatch watch;
  const bool jumped = last_view_.jumpsTo(view_world);
  ++frame_;
  counts_ = {};
  const View view = begin(data, view_world);
  sets_.find(data, view_world, clip_world_ == Plane() ? settings_.groups : 0);
  if (settings_.occlusion) {
    drawFirst(data, view, last, jumped);
  }
  pyramid_.finish();
  stats.draw_us += watch.lap();
  hidden_.begin(data);
  test(data, false);
  if (settings_.occlusion) {
    drawFound(data, view, jumped, last_set);
    usual_work_.frame(work_);
    version_ = data.version;
  }
  stats.test_us += watch.lap();
  stats.occluders += counts_.occluders;
  stats.edges += counts_.edges;
  stats.nodes_tested += counts_.nodes_tested;
  stats.boxes_tested += counts_.boxes_tested;
  kept.add(found_);
}

// Draws what is known to hide something before anything is tested: what did so in the last frame, for boxes
// that are to be hidden again, and where there are none, all that the last frame kept; after a jump all that
// is in the view's volume.
void WorldEye::drawFirst(const WorldData& data, const View& view, std::span<const InstanceId> last,
                         bool jumped) {
  makeRoom(data);
  aims_.grow(data.instances.size(), data.instances.capacity());
  aims_.beginView(jumped);
  useful_before_.swap(useful_);
  useful_.clear();
  work_ = 0;
  if (jumped) {
    test(data, true);
    shown_.clear();
    found_.list(shown_);
    work_ = draw(data, view, shown_, whatIsLeft(ViewStep::kJump));
    return;
  }
  hidden_boxes_.clear();
  hidden_.append(
      data, aims_.kMaxHiddenBoxes, frame_,
      [&](std::uint32_t id) {
        return isDrawn(data.instances[id]) && sideOf(clip_, data.boxOf(id), clip_rounding_) >= 0;
      },
      hidden_boxes_);
  aims_.aimAtHidden(hidden_boxes_, {}, [&](InstanceId id) { return data.boxOf(id.value); });
  SurfaceDrawing drawing = whatIsLeft(ViewStep::kNext);
  drawing.targets = aims_.boxes();
  drawing.useful_only = !drawing.targets.empty();
  work_ = draw(data, view, last, drawing);
}

// Draws what may hide some of what is found not to be hidden, and tests that once more; where nothing is
// known of that, the surfaces of what is new, if it is much.
void WorldEye::drawFound(const WorldData& data, const View& view, bool jumped, const IdBits& last_set) {
  shown_.clear();
  found_.list(shown_);
  news_.clear();
  for (const InstanceId id : shown_) {
    if (!last_set.has(id.value) || data.instances[id.value].born > version_) {
      news_.push_back(id);
    }
  }
  if (!jumped) {
    SurfaceDrawing drawing = whatIsLeft(ViewStep::kSame);
    drawing.draw_resting = culling::mostIsNew(news_.size(), shown_.size());
    if (!aims_.boxes().empty()) {
      drawing.limits.budget = aims_.aimAtShown(shown_, news_, work_, drawing.limits.budget,
                                               [&](InstanceId id) { return data.boxOf(id.value); });
      drawing.targets = aims_.boxes();
      if (drawing.limits.budget > 0) {
        if (const std::uint32_t work = draw(data, view, shown_, drawing); work > 0) {
          work_ += work;
          pyramid_.finish();
          testAimedAt();
        }
      }
    } else if (culling::changesFast(news_.size(), shown_.size())) {
      // What comes into view is not counted in the budget.
      drawing.limits.budget = settings_.drawing.budget;
      draw(data, view, news_, drawing);
      pyramid_.finish();
      hidden_.begin(data);
      test(data, false);
    }
  }
  std::erase_if(news_, [&](InstanceId id) { return !found_.has(id.value); });
  aims_.endView(shown_, news_);
}

// A world that grows within what was reserved makes this vector copy nothing either.
void WorldEye::makeRoom(const WorldData& data) {
  pasts_.reserve(data.instances.capacity());
  pasts_.resize(std::max(pasts_.size(), data.instances.size()));
}

// How surfaces are drawn with what is left of the frame's budget.
SurfaceDrawing WorldEye::whatIsLeft(ViewStep step) const {
  SurfaceLimits limits = usual_work_.limited(settings_.drawing, step == ViewStep::kJump);
  limits.budget -= std::min(limits.budget, work_);
  return {.limits = limits, .step = step};
}

// Sets found_ to what may be seen, of all or by the view's volume alone.
void WorldEye::test(const WorldData& data, bool view_only) {
  found_.clear(data.instances.size());
  test(data.settled, view_only);
  test(data.moving, view_only);
  if (settings_.groups != 0xffffffffu || data.in_no_group > 0 || !(clip_ == Plane())) {
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
        if (!entry.view_only) {
          noteHidden(node, i, answers[i]);
        }
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

// What lies beside the view is not hidden by the buffer.
void WorldEye::noteHidden(const DynamicTree::Node& node, std::size_t child, const BoxAnswer& answer) {
  if (!answer.on_buffer) {
    return;
  }
  if (node.leaf) {
    hidden_.addInstance(node.children[child]);
  } else {
    hidden_.addNode(node.boxes[child]);
  }
}

// Tests what was aimed at once more, and takes what is hidden out of found_ and shown_.
void WorldEye::testAimedAt() {
  const std::span<const InstanceId> aimed_at = aims_.aimedAt();
  aimed_at_answers_.resize(std::max(aimed_at_answers_.size(), aimed_at.size()));
  const std::span<BoxAnswer> answers = std::span(aimed_at_answers_).first(aimed_at.size());
  pyramid_.classify(aims_.boxes(), answers, {.plain_from = 0});
  counts_.boxes_tested += static_cast<std::uint32_t>(aimed_at.size());
  for (std::size_t i = 0; i < aimed_at.size(); ++i) {
    if (answers[i].visibility == Visibility::kHidden) {
      found_.remove(aimed_at[i].value);
      hidden_.addInstance(aimed_at[i].value);
    }
  }
  std::erase_if(shown_, [&](InstanceId id) { return !found_.has(id.value); });
}

Visibility WorldEye::classify(const Box& box) const {
  return box.wellFormed() && sideOf(clip_, box, clip_rounding_) < 0 ? Visibility::kHidden
                                                                    : pyramid_.classify(box);
}

Visibility WorldEye::look(const WorldData& data, const View& view_world, const Box& box,
                          std::span<const InstanceId> ignored) {
  ++frame_;
  counts_ = {};
  makeRoom(data);
  useful_.clear();
  const View view = begin(data, view_world);
  test(data, true);
  for (const InstanceId id : ignored) {
    found_.remove(id.value);
  }
  shown_.clear();
  found_.list(shown_);
  takeCandidates(data, view, shown_);
  // What an ignored member of a join hides is not known apart from what the others do.
  for (std::uint32_t join = 0; join < of_join_.size(); ++join) {
    const auto of_this = [&](InstanceId id) {
      return id.value < data.instances.size() && data.instances[id.value].join == join;
    };
    if (!of_join_[join].empty() && std::any_of(ignored.begin(), ignored.end(), of_this)) {
      separate(data, join);
    }
  }
  const bool nothing_between = shown_.empty() && data.unbounded.empty();
  drawInOrder(data, view, {.limits = settings_.drawing, .step = ViewStep::kJump});
  pyramid_.finish();
  const Visibility visibility = pyramid_.classify(box);
  return visibility == Visibility::kVisible && !nothing_between ? Visibility::kPartial : visibility;
}

}  // namespace sightline::world
