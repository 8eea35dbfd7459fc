#pragma once

// Classifies boxes against lists of active occluders, one by one and jointly. SupportingPlanes and KeptPlanes
// share it: they differ in how one occluder and one box are compared.
//
// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 4.
// Differs from the paper in: joint occlusion is decided by elimination, so that a connected set of occluders
// hides a box also when only part of the set does, see docs/algorithms/supporting-planes.md.

#include <cstdint>
#include <vector>

#include "src/occlusion/planes/active_occluders.h"

namespace sightline::occlusion {

class ListClassifier {
 public:
  // The active occluders must outlive this.
  ListClassifier(ActiveOccluders& active, bool joint_occlusion)
      : active_(active), joint_occlusion_(joint_occlusion) {}

  // Starts a view; to be called after ActiveOccluders::build().
  void begin();

  // Classifies a well-formed box. test(i): how the i-th occluder of `among` compares with it, an
  // EyePlaneTest; asked for ascending i, up to `count` or the first that hides the box. touching: see
  // SupportingPlanes.
  template <typename Test>
  Visibility classify(const Box& box, OccluderList among, std::uint32_t count, OccluderList& touching,
                      Test&& test) {
    touching = {active_.endOfLists(), 0};
    candidates_.clear();
    bool hidden = false;
    for (std::uint32_t i = 0; i < count && !hidden; ++i) {
      const EyePlaneTest result = test(i);
      if (!result.touches) {
        continue;
      }
      const std::uint32_t number = active_.inList(among, i);
      active_.append(number);
      if (result.behind) {
        hidden = result.failing == 0;
        candidates_.push_back({number, result.failing});
      }
    }
    if (hidden || (joint_occlusion_ && !candidates_.empty() && hiddenJointly(box))) {
      active_.truncate(touching.first);
      return Visibility::kHidden;
    }
    touching.count = active_.endOfLists() - touching.first;
    return touching.count == 0 ? Visibility::kVisible : Visibility::kPartial;
  }

 private:
  // An occluder that has all of the box behind its plane and may hide some of it.
  struct Candidate {
    std::uint32_t number = 0;
    std::uint64_t failing = 0;  // edges beyond which some of the box may be seen, a bit each
  };
  // The edges at which other occluders may go on, found when first asked for.
  struct SharedEdges {
    static constexpr std::uint32_t kNotYet = 0xffffffffu;

    std::uint32_t first_plane = kNotYet;  // in edge_planes_, one for each edge
    std::uint64_t edges = 0;              // edges that have such a plane, a bit each
  };
  // An occluder's state during one elimination.
  enum class State : std::uint8_t { kUnknown, kKept, kRejected };
  static constexpr std::size_t kMaxCandidates = 256;  // occluders that hide a box together, at most

  bool hiddenJointly(const Box& box);
  bool staysKept(const Candidate& candidate, const Box& box);
  bool recruit(std::uint32_t set, OccluderId id, const Box& box);
  const SharedEdges& sharedEdgesOf(std::uint32_t number);

  ActiveOccluders& active_;
  bool joint_occlusion_;
  std::vector<Candidate> candidates_;      // of the box that is being classified
  std::vector<State> states_;              // by number; all kUnknown between eliminations
  std::vector<std::uint32_t> examined_;    // numbers whose state is not kUnknown
  std::vector<SharedEdges> shared_edges_;  // by number
  std::vector<Plane> edge_planes_;         // the occluder lies behind; relative to the eye
};

}  // namespace sightline::occlusion
