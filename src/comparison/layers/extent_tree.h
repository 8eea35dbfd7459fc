#pragma once

// All parts whose extents overlap a query, by a kd-tree over the axes that follows the parts' motion.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2. What differs is said in extent_nodes.h.

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/comparison/layer_sorting.h"
#include "src/comparison/layers/extent_keys.h"
#include "src/comparison/layers/extent_nodes.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::Extent;

// For one thread at a time.
class ExtentTree {
 public:
  explicit ExtentTree(const ExtentTreeSettings& settings);

  // Once a frame, before queries. The first time, or when the number of parts or axes changed, builds;
  // otherwise rebalances, and goes on with a new tree beside this one where one has been begun (its nodes are
  // made over several frames; when it is whole it is brought up to date and takes over). All parts are active
  // afterwards.
  void update(const ExtentTable& table);
  // Builds anew, whatever there is.
  void build(const ExtentTable& table);
  // part: less than the table's parts. Setting what is already so does nothing.
  void setActive(std::uint32_t part, bool active);
  // Appends the active parts that overlap, each once, ascending: those for which overlaps(table, query, part)
  // is true of the table at the last update() or build().
  void query(const Extent& query, std::vector<std::uint32_t>& parts);

  // For tests and reports; of the tree that answers.
  const ExtentTreeWork& work() const { return work_; }
  const ExtentNodes& nodes() const { return trees_[current_]; }
  const ExtentKeys& keys() const { return keys_; }
  bool rebuilding() const { return rebuilding_; }

 private:
  // How many parts queries met in leaves, over some frames with queries.
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
  std::array<ExtentNodes, 2> trees_;  // the one that answers, and one that is being made
  std::size_t current_ = 0;
  ExtentKeys keys_;      // now
  ExtentKeys snapshot_;  // when the new tree was begun
  ExtentTreeWork work_;

  std::uint32_t frames_ = 0;  // since the tree was whole
  Window first_, recent_, frame_;
  bool imbalanced_ = false;

  std::vector<std::uint32_t> seen_;  // one a part: the last query that returned it, or kInactive
  std::uint32_t epoch_ = 0;
  ExtentNodes::Query asked_;
};

}  // namespace sightline::comparison
