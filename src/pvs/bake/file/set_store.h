#pragma once

// Where sets are put as they come.

#include <cstdint>
#include <span>

namespace sightline::pvs {

// Takes sets of nodes, and numbers them in the order in which they come.
class SetStore {
 public:
  virtual ~SetStore() = default;
  virtual std::uint32_t count() const = 0;
  // Whether a set that was added has exactly these nodes. False also if that cannot be told any more: then
  // the set is there twice.
  virtual bool same(std::uint32_t set, std::span<const std::uint32_t> nodes) = 0;
  virtual void add(std::span<const std::uint32_t> nodes) = 0;
};

}  // namespace sightline::pvs
