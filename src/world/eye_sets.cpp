#include "src/world/eye_sets.h"

#include <algorithm>

namespace sightline::world {

void EyeSets::use(SetsId id, VisibleSets* sets) {
  std::erase_if(used_, [&](const Used& used) { return used.id == id; });
  if (sets != nullptr) {
    used_.push_back({.id = id, .sets = sets, .boxes = hashOfBoxes(sets->boxes()), .marks = {}});
  }
}

// A set that names a tombstone says nothing: what the object hid can be seen now.
void EyeSets::mark(const BakedObjects& baked, const VisibleSet& set, Used& used) {
  const BoxTreeView boxes = used.sets->boxes();
  used.marks.assign(baked.instances.size(), 0);
  for (const std::uint32_t node : set.nodes) {
    for (const ObjectId object : boxes.objectsBelow(node)) {
      used.marks[object.value] = 1;
    }
  }
  used.everything = std::any_of(baked.tombstones.begin(), baked.tombstones.end(),
                                [&](ObjectId object) { return used.marks[object.value] != 0; });
}

void EyeSets::find(const WorldData& data, const View& view, std::uint32_t groups) {
  restricts_ = false;
  for (Used& used : used_) {
    const bool there = used.id.value < data.sets.size() && data.sets[used.id.value].there;
    const BakedObjects* const baked = there ? &data.sets[used.id.value] : nullptr;
    // Sets hold for viewpoints, and the rays of an orthographic view do not start at its eye. They take all
    // objects to be drawn, and are of no use if they are of other boxes.
    if (baked == nullptr || view.orthographic || (baked->groups & groups) == 0 ||
        used.boxes != baked->boxes) {
      used.everything = true;
      used.set = VisibleSet::kEverything;
      continue;
    }
    const VisibleSet set = used.sets->find(view.eye - baked->origin, nearDistance(view));
    if (set.id == VisibleSet::kEverything) {
      used.everything = true;
    } else if (set.id != used.set || used.version != baked->version) {
      mark(*baked, set, used);
    }
    used.set = set.id;
    used.version = baked->version;
    restricts_ = restricts_ || !used.everything;
  }
}

void EyeSets::restrict(const WorldData& data, IdBits& instances) const {
  if (!restricts_) {
    return;
  }
  instances.removeIf([&](std::uint32_t id) {
    const InstanceExtra& own = data.extras[id];
    return data.instances[id].baked && std::any_of(used_.begin(), used_.end(), [&](const Used& used) {
             return used.id.value == own.sets && !used.everything && used.marks[own.object] == 0;
           });
  });
}

}  // namespace sightline::world
