#include "sightline/world/world_culler.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"
#include "src/culling/last_view.h"
#include "src/culling/usual_work.h"
#include "src/occlusion/pixel_boxes.h"
#include "src/scene/usable_view.h"
#include "src/world/world_data.h"

namespace sightline {

using namespace world;
using hierarchy::DynamicTree;

namespace {

double microsecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

// An instance whose own surfaces may be drawn.
struct Candidate {
  std::uint32_t id = 0;
  float nearest = 0.0f;  // reciprocal depth
};

// What is not worth its cost is left out for some frames.
struct Rest {
  std::uint64_t born = 0;    // of the instance for which it holds
  std::uint32_t until = 0;   // number of the frame in which it is drawn again
  std::uint32_t length = 0;  // frames
};

constexpr double kMinGain = 0.3;  // pixels that must become nearer for each unit of work
constexpr std::uint32_t kLongestRest = 15;
// Where more than one of so many instances that were kept is new, the view changes fast, and what the last
// frame kept is not enough to hide what is behind the new ones.
constexpr std::size_t kCalm = 16;

}  // namespace

struct WorldCuller::Impl {
  explicit Impl(const WorldCullerSettings& given) : settings(given), pyramid({given.raster}) {}

  void cull(const World& world, const View& given);
  void draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates, ViewStep step);
  void drawJoins(const WorldData& data, SurfaceDrawing& drawing);
  void drawAlone(const WorldData& data, const View& view, SurfaceDrawing& drawing);
  void test(const WorldData& data, bool view_only);
  void testTree(const DynamicTree& tree, bool view_only);
  void keepAll(const DynamicTree& tree, std::uint32_t node);
  void keep(std::uint32_t id) { bits[id / 64] |= std::uint64_t{1} << (id % 64); }
  void clear(const WorldData& data) { bits.assign((data.instances.size() + 63) / 64, 0); }
  void list();
  void compare(const WorldData& data);

  struct Entry {
    std::uint32_t node;
    bool view_only;  // nothing that was drawn hides any of it
  };

  WorldCullerSettings settings;
  DepthPyramid pyramid;
  culling::LastView last_view;
  WorldCullStats counts;
  culling::UsualWork usual_work;
  std::uint32_t frame = 0;

  std::vector<std::uint64_t> bits, last_bits;
  std::vector<InstanceId> visible, appeared, disappeared;
  std::uint64_t last_version = 0;  // of the world

  std::vector<Entry> stack;
  std::vector<BoxAnswer> answers = std::vector<BoxAnswer>(DynamicTree::kChildren);
  std::vector<std::uint32_t> all_below;  // scratch of keepAll()

  std::vector<std::vector<ObjectId>> of_join;  // by JoinId: candidates among its members
  std::vector<Box> boxes;
  std::vector<occlusion::PixelBox> images;
  std::vector<std::uint32_t> alone;
  std::vector<Candidate> near_first;
  std::vector<Rest> rests;  // by InstanceId
};

WorldCuller::WorldCuller(const WorldCullerSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
WorldCuller::~WorldCuller() = default;
WorldCuller::WorldCuller(WorldCuller&&) noexcept = default;
WorldCuller& WorldCuller::operator=(WorldCuller&&) noexcept = default;

void WorldCuller::Impl::cull(const World& world, const View& given) {
  const WorldData& data = world.data();
  View view = given;
  counts = {};
  counts.view_fault = makeUsable(view);
  std::swap(bits, last_bits);
  clear(data);
  ++frame;
  if (counts.view_fault != nullptr) {
    last_view.forget();
    keepAll(data.settled, data.settled.root());
    keepAll(data.moving, data.moving.root());
  } else {
    const bool jumped = last_view.jumpsTo(view);
    const auto start = std::chrono::steady_clock::now();
    pyramid.begin(view);
    if (settings.occlusion) {
      if (jumped) {
        test(data, true);
        list();
        clear(data);
      }
      draw(data, view, visible, jumped ? ViewStep::kJump : ViewStep::kNext);
    }
    pyramid.finish();
    counts.draw_us = microsecondsSince(start);
    const auto drawn = std::chrono::steady_clock::now();
    test(data, false);
    counts.test_us = microsecondsSince(drawn);
    list();
    compare(data);
    if (settings.occlusion && !jumped && appeared.size() * kCalm > visible.size()) {
      const auto again = std::chrono::steady_clock::now();
      draw(data, view, appeared, ViewStep::kSame);
      pyramid.finish();
      clear(data);
      test(data, false);
      counts.draw_us += microsecondsSince(again);
    }
  }
  for (const InstanceId id : data.unbounded) {
    keep(id.value);
  }
  list();
  compare(data);
  last_version = data.version;
}

// Lists what was kept.
void WorldCuller::Impl::list() {
  visible.clear();
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t rest = bits[word]; rest != 0; rest &= rest - 1) {
      visible.emplace_back(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
    }
  }
}

// Finds what has changed since the last frame.
void WorldCuller::Impl::compare(const WorldData& data) {
  appeared.clear();
  disappeared.clear();
  for (const InstanceId id : visible) {
    const bool before =
        id.value / 64 < last_bits.size() && (last_bits[id.value / 64] >> (id.value % 64) & 1) != 0;
    if (!before || data.instances[id.value].born > last_version) {
      appeared.push_back(id);
    }
  }
  for (std::size_t word = 0; word < last_bits.size(); ++word) {
    const std::uint64_t now = word < bits.size() ? bits[word] : 0;
    for (std::uint64_t rest = last_bits[word] & ~now; rest != 0; rest &= rest - 1) {
      disappeared.emplace_back(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
    }
  }
}

void WorldCuller::Impl::test(const WorldData& data, bool view_only) {
  testTree(data.settled, view_only);
  testTree(data.moving, view_only);
}

void WorldCuller::Impl::testTree(const DynamicTree& tree, bool view_only) {
  stack.clear();
  if (tree.root() != DynamicTree::kNone) {
    stack.push_back({tree.root(), view_only});
  }
  while (!stack.empty()) {
    const Entry entry = stack.back();
    stack.pop_back();
    const DynamicTree::Node node = tree.node(entry.node);
    const std::span<BoxAnswer> found = std::span(answers).first(node.boxes.size());
    if (entry.view_only) {
      pyramid.classifyInView(node.boxes, found);
    } else {
      pyramid.classify(node.boxes, found, {.plain_from = node.leaf ? 0 : node.boxes.size()});
    }
    ++counts.nodes_tested;
    counts.boxes_tested += static_cast<std::uint32_t>(node.boxes.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i].visibility == Visibility::kHidden) {
        continue;
      }
      const std::uint32_t child = node.children[i];
      const bool sees_all = entry.view_only || found[i].visibility == Visibility::kVisible;
      if (node.leaf) {
        keep(child);
      } else if (sees_all && found[i].within_view) {
        keepAll(tree, child);
      } else {
        stack.push_back({child, sees_all});
      }
    }
  }
}

void WorldCuller::Impl::keepAll(const DynamicTree& tree, std::uint32_t root) {
  all_below.clear();
  if (root != DynamicTree::kNone) {
    all_below.push_back(root);
  }
  while (!all_below.empty()) {
    const DynamicTree::Node node = tree.node(all_below.back());
    all_below.pop_back();
    for (const std::uint32_t child : node.children) {
      if (node.leaf) {
        keep(child);
      } else {
        all_below.push_back(child);
      }
    }
  }
}

// Draws the surfaces of these instances, which may have been removed, hidden or moved since they were kept.
void WorldCuller::Impl::draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates,
                             ViewStep step) {
  of_join.resize(std::max(of_join.size(), data.joins.size()));
  for (std::vector<ObjectId>& members : of_join) {
    members.clear();
  }
  alone.clear();
  for (const InstanceId id : candidates) {
    if (id.value >= data.instances.size() || !data.hides(id.value)) {
      continue;
    }
    const InstanceData& own = data.instances[id.value];
    if (own.join != InstanceData::kNone) {
      of_join[own.join].emplace_back(own.object);
    }
    if (own.alone) {
      alone.push_back(id.value);
    }
  }
  SurfaceDrawing drawing = usual_work.limited(settings.drawing, step == ViewStep::kJump);
  drawing.step = step;
  const std::uint32_t budget = drawing.budget;
  drawJoins(data, drawing);
  drawAlone(data, view, drawing);
  if (step != ViewStep::kSame) {
    usual_work.frame(budget - drawing.budget);
  }
}

// Takes what it drew from drawing.budget, as does drawAlone().
void WorldCuller::Impl::drawJoins(const WorldData& data, SurfaceDrawing& drawing) {
  for (std::uint32_t join = 0; join < data.joins.size() && drawing.budget > 0; ++join) {
    if (of_join[join].empty()) {
      continue;
    }
    const WorldJoin& joined = data.joins[join].join;
    MovingSurfaces placed{&joined.surfaces, {}};
    for (int axis = 0; axis < 3; ++axis) {
      placed.scene_from_surfaces(axis, 3) = joined.origin[axis];
    }
    const SurfaceStats drawn = pyramid.draw(placed, of_join[join], drawing);
    counts.occluders += drawn.groups > 0 ? 1 : 0;
    counts.edges += drawn.edges;
    drawing.budget -= std::min(drawing.budget, drawn.work);
  }
}

void WorldCuller::Impl::drawAlone(const WorldData& data, const View& view, SurfaceDrawing& drawing) {
  boxes.clear();
  for (const std::uint32_t id : alone) {
    boxes.push_back(data.boxOf(id));
  }
  images.resize(std::max(images.size(), boxes.size()));
  const DepthBufferView buffer = pyramid.depthBuffer();
  occlusion::projectBoxes(PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height, boxes,
                          images);
  rests.resize(std::max(rests.size(), data.instances.size()));
  near_first.clear();
  for (std::size_t i = 0; i < alone.size(); ++i) {
    const occlusion::PixelBox& image = images[i];
    const bool reaches_the_eye = image.place == occlusion::BoxPlace::kUnbounded;
    const double pixels = static_cast<double>(image.x1 - image.x0 + 1) * (image.y1 - image.y0 + 1);
    const Rest& rest = rests[alone[i]];
    const bool rests_now =
        drawing.step == ViewStep::kNext && rest.until > frame && rest.born == data.instances[alone[i]].born;
    if (image.place != occlusion::BoxPlace::kOutside && !rests_now &&
        (reaches_the_eye || pixels >= settings.drawing.min_pixels)) {
      near_first.push_back(
          {alone[i], reaches_the_eye ? std::numeric_limits<float>::infinity() : image.nearest});
    }
  }
  std::sort(near_first.begin(), near_first.end(), [](const Candidate& a, const Candidate& b) {
    return a.nearest != b.nearest ? a.nearest > b.nearest : a.id < b.id;
  });
  for (const Candidate& candidate : near_first) {
    if (drawing.budget == 0) {
      break;
    }
    const InstanceData& own = data.instances[candidate.id];
    const SurfaceStats drawn = pyramid.draw(
        MovingSurfaces{&data.meshes[own.mesh].mesh.surfaces, data.world_from_mesh[candidate.id]}, drawing);
    counts.occluders += drawn.groups > 0 ? 1 : 0;
    counts.edges += drawn.edges;
    drawing.budget -= std::min(drawing.budget, drawn.work);
    Rest& rest = rests[candidate.id];
    if (drawn.gain < kMinGain * drawn.work || drawn.groups == 0) {
      // Those that begin to rest in the same frame come back in different ones.
      const std::uint32_t last = rest.born == own.born ? rest.length : 0;
      const std::uint32_t length = std::min(2 * last + 1, kLongestRest);
      rest = {own.born, frame + 1 + length + candidate.id % (length / 2 + 1), length};
    } else {
      rest = {own.born, 0, 0};
    }
  }
}

void WorldCuller::cull(const World& world, const View& view) {
  impl_->cull(world, view);
}

void WorldCuller::reset() {
  *this = WorldCuller(impl_->settings);
}

std::span<const InstanceId> WorldCuller::visible() const {
  return impl_->visible;
}
std::span<const std::uint64_t> WorldCuller::visibleBits() const {
  return impl_->bits;
}
std::span<const InstanceId> WorldCuller::appeared() const {
  return impl_->appeared;
}
std::span<const InstanceId> WorldCuller::disappeared() const {
  return impl_->disappeared;
}
const WorldCullStats& WorldCuller::stats() const {
  return impl_->counts;
}
DepthBufferView WorldCuller::depthBuffer() const {
  return impl_->pyramid.depthBuffer();
}

Visibility WorldCuller::classify(const Box& box) const {
  return impl_->counts.view_fault != nullptr ? Visibility::kPartial : impl_->pyramid.classify(box);
}

}  // namespace sightline
