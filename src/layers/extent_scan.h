#pragma once

// All parts whose extents overlap a query, by comparing with many of them, a vector of parts at a time.
// Blocks of 64 that follow each other in the order have united extents; in an order by distance most blocks
// lie behind what is asked about. The same answers as ExtentTree.

#include <cstdint>
#include <span>
#include <vector>

#include "layers/extent_table.h"

namespace sightline::layers {

struct ScanTables {
  ExtentTable rows, blocks;  // of 64 rows
  Extent all;                // of all rows
};

class ExtentScan {
 public:
  // Copies the extents of the parts in `order`, each of the table's at most once; these are active, others
  // are never found. Best in the order in which they will become inactive: what is left then lies together.
  void begin(const ExtentTable& table, std::span<const std::uint32_t> order);
  void setActive(std::uint32_t part, bool active);
  // Appends the active parts that overlap, ascending.
  void query(const Extent& query, std::vector<std::uint32_t>& parts);

 private:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

  void uniteBlocks();

  ScanTables tables_;                  // a row a place in the order
  std::vector<std::uint32_t> part_;    // one a place
  std::vector<std::uint32_t> place_;   // one a part, or kNowhere
  std::vector<std::uint64_t> active_;  // a bit a place; none beyond
};

}  // namespace sightline::layers
