#pragma once

// What each occluder hides from single viewpoints. Samples are computed on demand, shared by all cells that
// have the viewpoint as a corner, and discarded when memory runs out. (The paper's list of samples.)

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/convex/shadow_tree.h"

namespace sightline::pvs {

// The runs hidden from one viewpoint, by occluder.
class Sample {
 public:
  explicit Sample(const Vec3d& eye) : eye_(eye) {}

  const Vec3d& eye() const { return eye_; }
  // Returns nothing if it is not computed yet. Valid until the next add().
  std::optional<std::span<const ObjectRun>> find(std::uint32_t occluder) const;
  void add(std::uint32_t occluder, std::span<const ObjectRun> runs);
  std::size_t bytes() const {
    return sizeof(Sample) + slots_.capacity() * sizeof(Slot) + runs_.capacity() * sizeof(ObjectRun);
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;
  struct Slot {
    std::uint32_t occluder = kFree, first = 0, count = 0;  // runs_[first, first + count)
  };
  // Index of the occluder's slot, or of the free slot where it goes.
  std::size_t slotOf(std::uint32_t occluder) const;
  void grow();

  Vec3d eye_;
  std::vector<Slot> slots_;  // open addressing; the size is a power of two
  std::uint32_t used_ = 0;
  Runs runs_;
};

class SampleStore {
 public:
  // Occluders and tree must outlive this. reach: see makeShadow.
  SampleStore(const ConvexOccluders& occluders, const ShadowTree& tree, double reach, std::size_t max_bytes)
      : occluders_(occluders), tree_(tree), reach_(reach), max_bytes_(max_bytes) {}

  // The sample of a viewpoint, the same for equal viewpoints. Stays valid until forgetOldest().
  Sample& at(const Vec3d& eye);
  // The runs that the occluder hides from there. Valid until the next call for this sample.
  std::span<const ObjectRun> hidden(Sample& sample, std::uint32_t occluder);
  // Fills `common` with the runs that this one occluder hides from all corners. Returns false if there are
  // none.
  bool hiddenFromAll(std::uint32_t occluder, std::span<Sample* const> corners, Runs& common);

  // Discards the least recently used samples until they fit the limit.
  void forgetOldest();
  const BakeStats& stats() const { return stats_; }

 private:
  struct Key {
    std::uint64_t x, y, z;
    friend bool operator==(const Key&, const Key&) = default;
  };
  static Key keyOf(const Vec3d& eye);
  struct KeyHash {
    std::size_t operator()(const Key& k) const;
  };

  const ConvexOccluders& occluders_;
  const ShadowTree& tree_;
  double reach_;
  std::size_t max_bytes_, bytes_ = 0;
  std::list<Sample> samples_;  // most recently used first
  std::unordered_map<Key, std::list<Sample>::iterator, KeyHash> places_;
  Shadow shadow_;
  Runs scratch_, both_;
  BakeStats stats_;
};

}  // namespace sightline::pvs
