#include "sightline/world/world_culler.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "src/scene/usable_view.h"
#include "src/world/culler_impl.h"

namespace sightline {

using namespace world;

WorldCuller::WorldCuller(const WorldCullerSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
WorldCuller::~WorldCuller() = default;
WorldCuller::WorldCuller(WorldCuller&&) noexcept = default;
WorldCuller& WorldCuller::operator=(WorldCuller&&) noexcept = default;

// Returns false if one of the views is not usable.
bool WorldCuller::Impl::takeViews(std::span<const View> given) {
  views.assign(given.begin(), given.end());
  for (View& view : views) {
    if (const char* const fault = scene::makeUsable(view)) {
      counts.view_fault = fault;
      return false;
    }
  }
  while (eyes.size() < views.size()) {
    eyes.emplace_back(settings);
    eyes.back().clipBy(clip_plane);
    for (const auto& [id, own] : sets) {
      eyes.back().sets().use(id, own);
    }
  }
  return true;
}

void WorldCuller::Impl::keepEverything(const WorldData& data) {
  addAll(data.settled, data.settled.root(), kept);
  addAll(data.moving, data.moving.root(), kept);
  kept.removeIf([&](std::uint32_t id) { return (data.instances[id].groups & settings.groups) == 0; });
  for (WorldEye& eye : eyes) {
    eye.forget();
  }
}

void WorldCuller::Impl::cull(const WorldData& data, std::span<const View> given) {
  has_culled = true;
  counts = {};
  std::swap(kept, last_kept);
  kept.clear(data.instances.size());
  if (takeViews(given)) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      eyes[i].cull(data, views[i], visible, last_kept, kept, counts);
    }
  } else {
    keepEverything(data);
  }
  for (const InstanceId id : data.unbounded) {
    if ((data.instances[id.value].groups & settings.groups) != 0) {
      kept.insert(id.value);
      counts.unplaced += 1;
    }
  }
  visible.clear();
  kept.list(visible);
  appeared.clear();
  for (const InstanceId id : visible) {
    if (!last_kept.has(id.value) || data.instances[id.value].born > last_version) {
      appeared.push_back(id);
    }
  }
  disappeared.clear();
  last_kept.listWithout(kept, disappeared);
  // Instances whose id another one has now are gone as well.
  const auto reused = [&](InstanceId id) {
    return last_kept.has(id.value) && data.instances[id.value].born > last_version;
  };
  std::copy_if(visible.begin(), visible.end(), std::back_inserter(disappeared), reused);
  std::sort(disappeared.begin(), disappeared.end());
  last_version = data.version;
}

void WorldCuller::cull(const World& world, const View& view) {
  impl_->cull(*world.data_, {&view, 1});
}
void WorldCuller::cull(const World& world, std::span<const View> views) {
  impl_->cull(*world.data_, views);
}

void WorldCuller::reset() {
  const std::unique_ptr<Impl> old = std::exchange(impl_, std::make_unique<Impl>(impl_->settings));
  setClipPlane(old->clip_plane);
  for (const auto& [id, sets] : old->sets) {
    useSets(id, sets);
  }
}

void WorldCuller::setClipPlane(const Plane& plane) {
  impl_->clip_plane = plane;
  for (WorldEye& eye : impl_->eyes) {
    eye.clipBy(plane);
  }
}
void WorldCuller::useSets(SetsId id, VisibleSets* sets) {
  std::erase_if(impl_->sets, [&](const auto& used) { return used.first == id; });
  if (sets != nullptr) {
    impl_->sets.emplace_back(id, sets);
  }
  for (WorldEye& eye : impl_->eyes) {
    eye.sets().use(id, sets);
  }
}

std::span<const InstanceId> WorldCuller::visible() const {
  return impl_->visible;
}
std::span<const std::uint64_t> WorldCuller::visibleBits() const {
  return impl_->kept.words();
}
bool WorldCuller::isVisible(InstanceId instance) const {
  return impl_->kept.has(instance.value);
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
  return impl_->eyes[0].pyramid().depthBuffer();
}

Visibility WorldCuller::classify(const Box& box_from_origin) const {
  if (!impl_->has_culled || impl_->counts.view_fault != nullptr) {
    return Visibility::kPartial;
  }
  Visibility best = Visibility::kHidden;
  for (std::size_t i = 0; i < impl_->views.size(); ++i) {
    best = std::max(best, impl_->eyes[i].classify(box_from_origin));
  }
  return best;
}

}  // namespace sightline
