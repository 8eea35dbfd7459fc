#pragma once

// A table of the witnesses of pairs, whose entries expire when they are not used.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/layers/pairs/convex_pair.h"
#include "src/layers/pairs/pair_index.h"

namespace sightline::layers {

class PairTable {
 public:
  // kIntersection: does hull a intersect hull b? kOcclusion: does a intersect the set that b sweeps to the
  // eye?
  enum class Question : std::uint8_t { kIntersection, kOcclusion };

  // Begins a frame and removes entries that were not used in the last `expiry` frames (0: all). Moves the
  // others together. Allocates only when the table holds more entries than ever before.
  void beginFrame(std::uint32_t expiry);
  struct Used {
    PairWitness& witness;
    bool again = false;  // whether the entry was used in this frame before
  };
  // Returns the entry of a pair, which it makes if there is none; valid until the next call. The entries of
  // kIntersection for (a, b) and (b, a) are the same, with a < b.
  Used use(std::uint32_t a, std::uint32_t b, Question question);
  struct Kept {
    const PairWitness* witness = nullptr;  // null: there is no entry
    bool used_now = false;                 // whether the entry was used in this frame
  };
  Kept find(std::uint32_t a, std::uint32_t b, Question question) const;
  std::size_t size() const { return index_.size(); }

 private:
  PairIndex index_;
  std::vector<PairWitness> witnesses_;    // one per entry of the index
  std::vector<std::uint32_t> last_used_;  // one per entry: the frame of its last use
  std::vector<std::uint8_t> keep_;        // scratch for beginFrame()
  std::uint32_t frame_ = 0;               // may wrap around, since only differences are used
};

}  // namespace sightline::layers
