#pragma once

// Finds all parts whose extents overlap a query, by a kd-tree that follows the moving parts.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2. The differences are listed in extent_nodes.h.

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/comparison/layer_sorting.h"
#include "src/comparison/layers/extent_keys.h"
#include "src/comparison/layers/extent_nodes.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::Extent;

// Use by one thread at a time.
class ExtentTree {
 public:
  explicit ExtentTree(const ExtentTreeSettings& settings);

  // Call once a frame, before queries. All parts are active afterwards. The first call, and a call after the
  // number of parts or axes changed, builds the tree. Other calls rebalance it and continue a new tree if one
  // has been begun: its nodes are made over several frames, and once complete it replaces the current tree.
  void update(const ExtentTable& table);
  // Builds a new tree at once.
  void build(const ExtentTable& table);
  void setActive(std::uint32_t part, bool active);
  // Appends the active parts for which overlaps(table, query, part) is true with the table of the last
  // update() or build(), each once, ascending.
  void query(const Extent& query, std::vector<std::uint32_t>& parts);

  // For tests and reports: the state of the current tree.
  const ExtentTreeWork& work() const { return work_; }
  const ExtentNodes& nodes() const { return trees_[current_]; }
  const ExtentKeys& keys() const { return keys_; }
  bool rebuilding() const { return rebuilding_; }

 private:
  // How many parts the leaves held that queries visited, over some frames with queries.
  struct Window {
    std::uint64_t visited = 0, queries = 0;
    std::uint32_t frames = 0;
    double average() const {
      return queries == 0 ? 0.0 : static_cast<double>(visited) / static_cast<double>(queries);
    }
  };

  bool mustRebuild();
  void closeFrame();
  bool takeOver(const ExtentTable& table);
  void beginLife();
  void activateAll();

  ExtentTreeSettings settings_;
  std::vector<ExtentAxis::Kind> kinds_;
  std::size_t parts_ = 0;
  bool built_ = false, rebuilding_ = false;
  std::array<ExtentNodes, 2> trees_;  // the current tree and the one being built
  std::size_t current_ = 0;
  ExtentKeys keys_;      // keys of this frame
  ExtentKeys snapshot_;  // keys of the frame in which the new tree was begun
  ExtentTreeWork work_;

  std::uint32_t frames_ = 0;  // frames since the current tree was completed
  Window first_, recent_, frame_;
  bool imbalanced_ = false;

  std::vector<std::uint32_t> seen_;  // one per part: the last query that returned it, or kInactive
  std::uint32_t epoch_ = 0;
  ExtentNodes::Query asked_;
};

}  // namespace sightline::comparison
