#pragma once

// 32-bit indices, one type each, so that an object's number is never taken for a node's.

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace sightline {

template <typename Tag>
struct Id {
  std::uint32_t value = 0xffffffffu;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  constexpr explicit Id(std::floating_point auto) = delete;
  // A number that is negative or does not fit makes the invalid id.
  template <std::integral Number>
  constexpr explicit Id(Number number) {
    const auto whole = +number;  // std::in_range takes neither characters nor bool
    if (std::in_range<std::uint32_t>(whole)) {
      value = static_cast<std::uint32_t>(whole);
    }
  }
  constexpr bool valid() const { return value != 0xffffffffu; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using ObjectId = Id<struct ObjectTag>;      // object of a Scene, in the contract's numbering
using MaterialId = Id<struct MaterialTag>;  // material of a Scene
using NodeIndex = Id<struct NodeTag>;       // node of a Hierarchy
using OccluderId = Id<struct OccluderTag>;  // polygon of an OccluderSet

}  // namespace sightline

template <typename Tag>
struct std::hash<sightline::Id<Tag>> {
  std::size_t operator()(sightline::Id<Tag> id) const noexcept {
    return std::hash<std::uint32_t>()(id.value);
  }
};
