#pragma once

// Finds all parts whose extents overlap a query by comparing many parts at a time. Extents are first compared
// as whole numbers from 0 to 255, up to 64 with one instruction, and what is left is compared exactly. Parts
// seen in similar directions lie together. 64 of them have a united extent, 64 of these again, and what does
// not overlap a united extent is skipped. The rows are rebuilt every frame.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/extents/candidate_search.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::layers {

// Maps the numbers of an axis to cells 0 to 255. The map is monotone, so intervals that overlap do so in
// cells.
struct CellScale {
  float low = 0.0f, scale = 0.0f;

  std::uint8_t cell(float value) const {
    // In this order NaN becomes 0, and there are no branches.
    const float at = (value - low) * scale, above = at > 0.0f ? at : 0.0f;
    return static_cast<std::uint8_t>(static_cast<std::int32_t>(above < 255.0f ? above : 255.0f));
  }
};

// Level 0 has one row per part, level i + 1 one row per kFanOut rows of level i. The last level has at most
// kFanOut rows.
struct ScanRows {
  static constexpr std::size_t kFanOut = 64;
  static constexpr std::size_t kMaxLevels = 6;  // enough for 2^32 parts

  std::vector<ExtentAxis::Kind> kinds;
  std::array<CellScale, kMaxExtentAxes> scales;
  std::size_t levels = 0;
  std::array<std::size_t, kMaxLevels> count{};  // number of rows of each level
  std::array<std::size_t, kMaxLevels> first{};  // row at which each level begins in a column
  std::size_t stride = 0;                       // rows of a column: all levels, each padded to kFanOut
  std::vector<std::uint8_t> lows, highs;        // cells, column after column, one column per axis
  std::vector<std::uint64_t> active;            // one bit per row of level 0
  Extent all;                                   // united extent of all parts

  std::size_t axes() const { return kinds.size(); }
};

class ExtentScan final : public CandidateSearch {
 public:
  // Other parts than those in `order` are never found, whatever setActive() says.
  void beginFrame(const ExtentTable& table, std::span<const std::uint32_t> order) override;
  void setActive(std::uint32_t part, bool active) override;

  void query(const Extent& query, std::vector<std::uint32_t>& parts) override;

  // For tests: how many blocks of ScanRows::kFanOut rows all queries so far have compared.
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
  std::vector<std::uint32_t> part_;   // one per row of level 0
  std::vector<std::uint32_t> place_;  // one per part: its row, or kNowhere
  std::vector<std::uint64_t> keys_;   // scratch for cluster(): Morton code and part
  std::vector<std::uint32_t> found_;  // scratch for one query: room for every row
  std::uint64_t blocks_compared_ = 0;
};

}  // namespace sightline::layers
