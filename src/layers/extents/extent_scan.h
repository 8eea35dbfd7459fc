#pragma once

// All parts whose extents overlap a query, by comparing with many at a time: as whole numbers from 0 to 255
// first, so that an instruction compares up to 64, and exactly what is left then. Parts that are seen in like
// directions lie together; 64 of them have united extents, 64 of these again: what overlaps none of those is
// passed over. Made anew every frame. The same answers as ExtentTree.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/extents/candidate_search.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::layers {

// From an axis' numbers to cells. It never decreases, so what overlaps does so in cells too.
struct CellScale {
  float low = 0.0f, scale = 0.0f;

  std::uint8_t cell(float value) const {
    const float at = (value - low) * scale;
    return at >= 0.0f ? static_cast<std::uint8_t>(at < 255.0f ? at : 255.0f) : 0;
  }
};

// Level 0 has a row a part, level i + 1 one for every kFanOut rows of level i; the last level has at most
// kFanOut rows.
struct ScanRows {
  static constexpr std::size_t kFanOut = 64;
  static constexpr std::size_t kMaxLevels = 6;  // of 2^32 parts

  std::vector<ExtentAxis::Kind> kinds;
  std::array<CellScale, kMaxExtentAxes> scales;
  std::size_t levels = 0;
  std::array<std::size_t, kMaxLevels> count{};  // rows of each level
  std::array<std::size_t, kMaxLevels> first{};  // where a level begins in a column
  std::size_t stride = 0;                       // of a column: level after level, each padded to kFanOut
  std::vector<std::uint8_t> lows, highs;        // cells; an axis after the other
  std::vector<std::uint64_t> active;            // of level 0, a bit a row
  Extent all;                                   // of all parts

  std::size_t axes() const { return kinds.size(); }
};

class ExtentScan final : public CandidateSearch {
 public:
  // The parts in `order`, each of the table's at most once, are active; others are never found. The table
  // must stay as it is until the next call.
  void beginFrame(const ExtentTable& table, std::span<const std::uint32_t> order) override;
  void setActive(std::uint32_t part, bool active) override;
  // Appends the active parts that overlap, ascending.
  void query(const Extent& query, std::vector<std::uint32_t>& parts) override;

  // For tests: blocks of ScanRows::kFanOut rows that all queries so far have compared.
  std::uint64_t blocksCompared() const { return blocks_compared_; }

 private:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

  void measure(std::span<const std::uint32_t> order);
  void cluster(std::span<const std::uint32_t> order);
  void layOut();
  void fillRows();
  void uniteRows();

  const ExtentTable* table_ = nullptr;
  ScanRows rows_;
  std::vector<std::uint32_t> part_;   // one a row of level 0
  std::vector<std::uint32_t> place_;  // one a part: its row, or kNowhere
  std::vector<std::uint64_t> keys_;   // scratch
  std::vector<std::uint32_t> found_;
  std::uint64_t blocks_compared_ = 0;
};

}  // namespace sightline::layers
