#pragma once

// What is kept of pairs of parts between frames: open addressing, linear probing, entries that expire.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/layers/pairs/convex_pair.h"
#include "src/layers/pairs/pair_index.h"

namespace sightline::layers {

class PairTable {
 public:
  // Of hulls (or parts) a and b: do they meet; or does a meet b and what lies between b and the eye?
  enum class Question : std::uint8_t { kMeeting, kOcclusion };

  // Entries not used in the last `expiry` frames before this one are gone (0: all). Moves entries, so that
  // the table stays compact; allocates only when it holds more than ever before.
  void beginFrame(std::uint32_t expiry);
  // The entry for a pair, fresh if it is new; valid until the next call. kMeeting: the same for (b, a), a <
  // b.
  PairWitness& use(std::uint32_t a, std::uint32_t b, Question question);
  struct Kept {
    const PairWitness* witness = nullptr;  // null: nothing is kept
    bool used_now = false;                 // in this frame
  };
  Kept find(std::uint32_t a, std::uint32_t b, Question question) const;
  std::size_t size() const { return index_.size(); }
  void clear();

 private:
  PairIndex index_;
  std::vector<PairWitness> witnesses_;    // one an entry of the index
  std::vector<std::uint32_t> last_used_;  // one an entry: the frame
  std::vector<std::uint8_t> keep_;        // scratch
  std::uint32_t frame_ = 0;               // may wrap: only differences count
};

}  // namespace sightline::layers
