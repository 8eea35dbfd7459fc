#include "sightline/pvs/format/doors.h"

#include <algorithm>

namespace sightline {

std::vector<ObjectId> allDoors(const DoorsView& doors) {
  std::vector<ObjectId> all(doors.doors.begin(), doors.doors.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

bool isClosed(const DoorsView& doors, std::uint32_t group, std::span<const ObjectId> closed) {
  const std::span<const ObjectId> members = doors.doorsOf(group);
  return std::includes(closed.begin(), closed.end(), members.begin(), members.end());
}

}  // namespace sightline
