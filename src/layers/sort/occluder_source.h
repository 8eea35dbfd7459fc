#pragma once

// What a sorter asks: who occludes whom, among the parts that are not in the order yet.

#include <cstdint>
#include <span>
#include <vector>

namespace sightline::layers {

class OccluderSource {
 public:
  virtual ~OccluderSource() = default;

  // Appends, each once and ascending, the active parts that occlude at least one of the members, without the
  // members themselves.
  virtual void occludersOf(std::span<const std::uint32_t> members, std::vector<std::uint32_t>& occluders) = 0;
  // Whether one part occludes another, active or not.
  virtual bool occludes(std::uint32_t front, std::uint32_t back) = 0;
  // All parts are active at first.
  virtual void setActive(std::uint32_t part, bool active) = 0;
};

// `front` occludes `back`.
struct Arc {
  std::uint32_t front = 0, back = 0;

  friend auto operator<=>(const Arc&, const Arc&) = default;
};

// Groups front to back; in a group, parts that occlude each other in a circle.
struct GroupedOrder {
  std::vector<std::uint32_t> parts;     // group after group
  std::vector<std::uint32_t> first_of;  // groups + 1: where each begins in parts
  std::vector<Arc> arcs;                // all between parts of one group, ascending

  std::size_t groups() const { return first_of.empty() ? 0 : first_of.size() - 1; }
  std::span<const std::uint32_t> group(std::size_t i) const {
    return std::span(parts).subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

}  // namespace sightline::layers
