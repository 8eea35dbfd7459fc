#include "sightline/comparison/traversal_record.h"

#include "sightline/occlusion/occlusion_tree.h"
#include "src/culling/hierarchical_traversal.h"

namespace sightline {

using culling::AskAll;
using culling::TraversalBox;

struct RecordedTraversal::Impl {
  Impl(const Hierarchy& of, std::span<const Box> object_bounds, const RecordedTraversalSettings& given)
      : hierarchy(of), traversal(of, object_bounds), settings(given) {}

  const Hierarchy& hierarchy;
  culling::HierarchicalTraversal traversal;
  RecordedTraversalSettings settings;
  OcclusionTree tree;
  std::vector<NodeVisit> visits;

  // A node that was not tested, though one below it was, was skipped: below hidden and visible nodes none is.
  void markSkipped() {
    for (std::size_t n = visits.size(); n-- > 0;) {
      const NodeIndex node(n);
      const auto reached = [&](NodeIndex child) { return visits[child.value] != NodeVisit::kNone; };
      if (visits[n] == NodeVisit::kNone && !hierarchy.nodes[n].leaf() &&
          (reached(hierarchy.left(node)) || reached(hierarchy.right(node)))) {
        visits[n] = NodeVisit::kSkipped;
      }
    }
  }
};

RecordedTraversal::RecordedTraversal(const Hierarchy& hierarchy, std::span<const Box> object_bounds,
                                     const RecordedTraversalSettings& settings)
    : impl_(std::make_unique<Impl>(hierarchy, object_bounds, settings)) {}
RecordedTraversal::~RecordedTraversal() = default;
RecordedTraversal::RecordedTraversal(RecordedTraversal&&) noexcept = default;
RecordedTraversal& RecordedTraversal::operator=(RecordedTraversal&&) noexcept = default;

std::span<const NodeVisit> RecordedTraversal::traverse(const View& view, const OccluderSet& set,
                                                       std::span<const OccluderId> chosen) {
  Impl& impl = *impl_;
  impl.tree.build(view, set, chosen);
  impl.visits.assign(impl.hierarchy.nodes.size(), NodeVisit::kNone);
  CullStats stats;
  std::vector<ObjectId> visible;
  const auto classify = [&impl](const TraversalBox& asked) {
    const Visibility state = impl.tree.classify(asked.box, asked.frustum_planes);
    impl.visits[asked.item] = state == Visibility::kHidden    ? NodeVisit::kHidden
                              : state == Visibility::kVisible ? NodeVisit::kVisible
                                                              : NodeVisit::kPartial;
    return state;
  };
  impl.traversal.run(frustumOf(view),
                     {.min_node_cost = impl.settings.min_node_cost,
                      .temporal_coherence = impl.settings.temporal_coherence,
                      .test_objects = false},
                     AskAll{classify}, stats, visible);
  impl.markSkipped();
  return impl.visits;
}

}  // namespace sightline
