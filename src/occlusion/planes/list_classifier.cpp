#include "src/occlusion/planes/list_classifier.h"

namespace sightline::occlusion {

void ListClassifier::begin() {
  states_.clear();
  shared_edges_.clear();
  edge_planes_.clear();
}

const ListClassifier::SharedEdges& ListClassifier::sharedEdgesOf(std::uint32_t number) {
  SharedEdges& shared = shared_edges_[number];
  if (shared.first_plane != SharedEdges::kNotYet) {
    return shared;
  }
  const ActiveOccluder& active = active_[number];
  const OccluderSet& set = active_.setOf(active);
  const Occluder& occluder = set[active.seen.id];
  shared.first_plane = static_cast<std::uint32_t>(edge_planes_.size());
  edge_planes_.resize(edge_planes_.size() + occluder.vertex_count);
  for (std::uint32_t side = 0; side < occluder.vertex_count; ++side) {
    const Outline outline = outlineOf(active_.eye(), set, active.seen, side);
    if (const std::optional<SharedEdge> edge = sharedEdgeOf(active_.eye(), set, active.seen, outline)) {
      const std::uint32_t e = outline.edge - occluder.first_vertex;
      edge_planes_[shared.first_plane + e] = edge->oriented();
      shared.edges |= std::uint64_t{1} << e;
    }
  }
  return shared;
}

// Makes an occluder a candidate that may be what an edge of another candidate goes on in, whether or not it
// touches the box. Returns whether it is one now.
bool ListClassifier::recruit(std::uint32_t set, OccluderId id, const Box& box) {
  const std::uint32_t number = active_.find(set, id);
  if (number >= active_.builtCount() || states_[number] != State::kUnknown ||
      candidates_.size() >= kMaxCandidates) {
    return false;
  }
  states_[number] = State::kRejected;
  examined_.push_back(number);
  const EyePlaneTest result = active_.test(number, box);
  if (!result.behind || (result.failing & ~sharedEdgesOf(number).edges) != 0) {
    return false;
  }
  states_[number] = State::kKept;
  candidates_.push_back({number, result.failing});
  return true;
}

// Returns whether beyond each failing edge of the candidate other candidates go on, recruiting them where
// that is needed.
bool ListClassifier::staysKept(const Candidate& candidate, const Box& box) {
  const ActiveOccluder& active = active_[candidate.number];
  const OccluderSet& set = active_.setOf(active);
  const Occluder& occluder = set[active.seen.id];
  const auto centroidOf = [&](OccluderId id) -> const Vec3d* {
    const std::uint32_t other = active_.find(active.set, id);
    const bool kept = other < active_.size() && states_[other] == State::kKept;
    return kept ? &active_[other].seen.centroid : nullptr;
  };
  for (std::uint32_t e = 0; e < occluder.vertex_count; ++e) {
    if ((candidate.failing >> e & 1) == 0) {
      continue;
    }
    const OccluderEdge& edge = set.edges[occluder.first_vertex + e];
    const Plane plane = edge_planes_[shared_edges_[candidate.number].first_plane + e];
    std::uint64_t open = openMeshEdges(set, edge, plane, centroidOf);
    for (std::uint32_t c = 0; c < edge.neighbour_count && open != 0; ++c) {
      const EdgeNeighbour& neighbour = set.neighbours[edge.first_neighbour + c];
      if ((open >> neighbour.mesh_edge & 1) != 0 && recruit(active.set, neighbour.occluder, box)) {
        open = openMeshEdges(set, edge, plane, centroidOf);
      }
    }
    if (open != 0) {
      return false;
    }
  }
  return true;
}

// A set of occluders hides what lies behind all of them and fails no edge but those at which the set goes on.
// Elimination leaves the largest such set.
bool ListClassifier::hiddenJointly(const Box& box) {
  states_.resize(active_.size(), State::kUnknown);
  shared_edges_.resize(active_.size());
  examined_.clear();
  std::erase_if(candidates_, [this](const Candidate& candidate) {
    const bool rejected = (candidate.failing & ~sharedEdgesOf(candidate.number).edges) != 0;
    states_[candidate.number] = rejected ? State::kRejected : State::kKept;
    examined_.push_back(candidate.number);
    return rejected;
  });
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < candidates_.size();) {
      const Candidate candidate = candidates_[i];
      if (staysKept(candidate, box)) {
        ++i;
      } else {
        states_[candidate.number] = State::kRejected;
        candidates_[i] = candidates_.back();
        candidates_.pop_back();
        changed = true;
      }
    }
  }
  for (const std::uint32_t number : examined_) {
    states_[number] = State::kUnknown;
  }
  return !candidates_.empty();
}

}  // namespace sightline::occlusion
