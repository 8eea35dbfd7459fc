#include "sightline/comparison/layer_sorting.h"

#include <memory>
#include <span>
#include <vector>

#include "src/comparison/layers/extent_tree.h"
#include "src/comparison/layers/incremental_sort.h"
#include "src/layers/extents/candidate_search.h"

namespace sightline {
namespace {

class ExtentTreeSearch final : public CandidateSearch {
 public:
  explicit ExtentTreeSearch(const ExtentTreeSettings& settings) : tree_(settings) {}

  void beginFrame(const layers::ExtentTable& table, std::span<const std::uint32_t> active) override {
    tree_.update(table);
    if (active.size() < table.parts) {
      deactivateOthers(active, table.parts);
    }
  }
  void setActive(std::uint32_t part, bool active) override { tree_.setActive(part, active); }
  void query(const layers::Extent& query, std::vector<std::uint32_t>& parts) override {
    tree_.query(query, parts);
  }
  void rebuild(const layers::ExtentTable& table) override { tree_.build(table); }

 private:
  // The tree has just activated all parts.
  void deactivateOthers(std::span<const std::uint32_t> active, std::size_t parts) {
    is_active_.assign(parts, 0);
    for (const std::uint32_t part : active) {
      is_active_[part] = 1;
    }
    for (std::uint32_t part = 0; part < parts; ++part) {
      if (is_active_[part] == 0) {
        tree_.setActive(part, false);
      }
    }
  }

  comparison::ExtentTree tree_;
  std::vector<std::uint8_t> is_active_;  // scratch, one per part
};

}  // namespace

MakeLayerSort incrementalSort() {
  return [] { return std::make_unique<comparison::IncrementalSort>(); };
}

MakeCandidateSearch extentTree(const ExtentTreeSettings& settings) {
  return [settings] { return std::make_unique<ExtentTreeSearch>(settings); };
}

}  // namespace sightline
