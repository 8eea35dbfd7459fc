#pragma once

// The occlusion graph as a sort algorithm sees it, and the order that the algorithm makes of it.

#include <cstdint>
#include <span>
#include <vector>

namespace sightline::layers {

class OccluderSource {
 public:
  virtual ~OccluderSource() = default;

  // Appends the active parts that may occlude a part, each once and ascending, without the part itself. They
  // cost little; whether a candidate occludes the part is for candidateOccludes() to say.
  virtual void candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) = 0;
  virtual bool candidateOccludes(std::uint32_t candidate, std::uint32_t part) = 0;
  // Parts are active until they are put into the order.
  virtual void setActive(std::uint32_t part, bool active) = 0;

  // What follows comes of candidatesOf() and candidateOccludes() by default. Sources may have faster answers.
  //
  // Appends the active parts that occlude at least one part of the group, each once and ascending, without
  // the group's own parts.
  virtual void occludersOf(std::span<const std::uint32_t> group, std::vector<std::uint32_t>& occluders);
  // Whether `front`, which is active, occludes `back`.
  virtual bool occludes(std::uint32_t front, std::uint32_t back);
};

// `front` occludes `back`.
struct Arc {
  std::uint32_t front = 0, back = 0;

  friend auto operator<=>(const Arc&, const Arc&) = default;
};

// Strongly connected components of the occlusion graph ("groups"), front to back.
struct GroupedOrder {
  std::vector<std::uint32_t> parts;     // group after group
  std::vector<std::uint32_t> first_of;  // groups + 1 elements: where each group begins in parts

  std::size_t groups() const { return first_of.empty() ? 0 : first_of.size() - 1; }
  std::span<const std::uint32_t> group(std::size_t i) const {
    return std::span(parts).subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

}  // namespace sightline::layers
