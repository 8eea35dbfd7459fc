#pragma once

// The interface of what finds the parts whose extents overlap a query.

#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/extents/extent_table.h"

namespace sightline {

// Keeps its memory from frame to frame. For one thread at a time.
class CandidateSearch {
 public:
  virtual ~CandidateSearch() = default;

  // Call once a frame, before the first query. The table must stay unchanged until the next call.
  // active: parts of the table, each at most once; they alone are active afterwards.
  virtual void beginFrame(const layers::ExtentTable& table, std::span<const std::uint32_t> active) = 0;

  virtual void setActive(std::uint32_t part, bool active) = 0;

  // Appends the active parts that overlap the query, ascending.
  virtual void query(const layers::Extent& query, std::vector<std::uint32_t>& parts) = 0;

  // Builds what is kept between frames anew, at once.
  virtual void rebuild(const layers::ExtentTable& /*table*/) {}
};

}  // namespace sightline
