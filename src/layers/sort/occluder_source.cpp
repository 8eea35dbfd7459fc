#include "src/layers/sort/occluder_source.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace sightline::layers {

void OccluderSource::occludersOf(std::span<const std::uint32_t> group,
                                 std::vector<std::uint32_t>& occluders) {
  const auto begin = static_cast<std::ptrdiff_t>(occluders.size());
  std::vector<std::uint32_t> candidates;
  for (const std::uint32_t part : group) {
    candidates.clear();
    candidatesOf(part, candidates);
    std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(occluders),
                 [&](std::uint32_t candidate) {
                   return std::find(group.begin(), group.end(), candidate) == group.end() &&
                          candidateOccludes(candidate, part);
                 });
  }
  std::sort(occluders.begin() + begin, occluders.end());
  occluders.erase(std::unique(occluders.begin() + begin, occluders.end()), occluders.end());
}

bool OccluderSource::occludes(std::uint32_t front, std::uint32_t back) {
  std::vector<std::uint32_t> candidates;
  candidatesOf(back, candidates);
  return std::binary_search(candidates.begin(), candidates.end(), front) && candidateOccludes(front, back);
}

}  // namespace sightline::layers
