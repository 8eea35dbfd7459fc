#include "src/pvs/bake/doors/door_groups.h"

#include <algorithm>

namespace sightline::pvs {

bool DoorGroups::isDoor(ObjectId object) const {
  return std::binary_search(all.begin(), all.end(), object);
}

bool DoorGroups::isWithin(std::uint32_t part, std::uint32_t whole) const {
  return std::includes(groups[whole].begin(), groups[whole].end(), groups[part].begin(), groups[part].end());
}

DoorGroups doorGroupsOf(std::span<const std::vector<ObjectId>> given) {
  DoorGroups doors;
  const auto makeSet = [](auto& items, const auto& before) {
    std::sort(items.begin(), items.end(), before);
    items.erase(std::unique(items.begin(), items.end()), items.end());
  };
  doors.groups.assign(given.begin(), given.end());
  for (std::vector<ObjectId>& group : doors.groups) {
    makeSet(group, std::less<>());
    doors.all.insert(doors.all.end(), group.begin(), group.end());
  }
  makeSet(doors.all, std::less<>());
  for (const ObjectId door : doors.all) {
    doors.groups.push_back({door});
  }
  if (!doors.all.empty()) {
    doors.groups.push_back(doors.all);
  }
  makeSet(doors.groups, [](const std::vector<ObjectId>& a, const std::vector<ObjectId>& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return doors;
}

std::string problemWithDoors(const SceneView& scene, std::span<const std::vector<ObjectId>> given) {
  for (const std::vector<ObjectId>& group : given) {
    if (group.empty()) {
      return "a group of doors has no door";
    }
    for (const ObjectId door : group) {
      const std::string name =
          "door " + (door.valid() ? std::to_string(door.value) : std::string("without a number"));
      if (door.value >= scene.objects.size()) {
        return name + " is no object of the scene, which has " + std::to_string(scene.objects.size());
      }
      const Object& object = scene.objects[door.value];
      if (object.mark == OccluderMark::kNever) {
        return name +
               " is marked as never an occluder, so it hides nothing when it is closed; remove the mark";
      }
      if (!scene.materialOf(object).opaque()) {
        return name + " has a material that is not opaque, so it hides nothing when it is closed";
      }
    }
  }
  return {};
}

std::vector<Object> withClosed(const SceneView& scene, const DoorGroups& doors,
                               std::span<const ObjectId> closed) {
  std::vector<Object> objects(scene.objects.begin(), scene.objects.end());
  for (const ObjectId door : doors.all) {
    if (std::find(closed.begin(), closed.end(), door) == closed.end()) {
      objects[door.value].mark = OccluderMark::kNever;
    }
  }
  return objects;
}

}  // namespace sightline::pvs
