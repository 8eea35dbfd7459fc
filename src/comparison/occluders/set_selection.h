#pragma once

// Selects the minimum occluder sets for a picture by their gain, cost and score. The selected sets are drawn
// on top of each other into a buffer with ids.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/comparison/viewpoint_database.h"
#include "src/base/rows.h"
#include "src/comparison/occluders/id_buffer.h"
#include "src/comparison/occluders/occluder_picture.h"
#include "src/comparison/occluders/occluder_stack.h"

namespace sightline::comparison {

// The cost of one occluder, with weights >= 0. The cost of a set is the sum over its occluders.
double costOf(const ShownOccluder& occluder, std::uint32_t picture_pixels, const MinimumSetWeights& weights);

// The costs of all occluders of a picture, by number.
void costsOf(const OccluderPicture& picture, const MinimumSetWeights& weights, std::vector<double>& costs);

// The minimum sets of all occludees of a picture. Equal sets are one set. Its gain is the number of occludees
// that it hides; it also hides what its subsets hide. Keeps its storage.
class SetPool {
 public:
  void clear();
  // members: occluders by number in the picture, ascending; not empty.
  void add(std::span<const std::uint32_t> members, std::uint32_t occludee);
  // Call when all sets are added. Sorts them by their members.
  void finish(std::uint32_t occluder_count, std::uint32_t occludee_count);

  std::uint32_t setCount() const { return static_cast<std::uint32_t>(sets_.size()); }
  std::span<const std::uint32_t> members(std::uint32_t set) const {
    return std::span(members_).subspan(sets_[set].first, sets_[set].count);
  }
  // The occludees that the set hides, each once.
  std::span<const std::uint32_t> occludees(std::uint32_t set) const { return hidden_[set]; }
  std::uint32_t gain(std::uint32_t set) const { return static_cast<std::uint32_t>(hidden_[set].size()); }

 private:
  struct Set {
    std::uint32_t first = 0, count = 0;  // of members_
    std::uint32_t occludee = 0;
  };
  std::span<const std::uint32_t> membersOf(const Set& set) const {
    return std::span(members_).subspan(set.first, set.count);
  }
  void mergeEqual();
  void indexByRarest(std::uint32_t occluder_count);
  void inherit(std::uint32_t occluder_count, std::uint32_t occludee_count);

  std::vector<Set> sets_;  // each different one once, after finish()
  std::vector<std::uint32_t> members_;
  base::Rows<std::uint32_t> own_;        // occludees by set, before they are inherited
  base::Rows<std::uint32_t> hidden_;     // occludees by set
  base::Rows<std::uint32_t> by_rarest_;  // by occluder: each set once, under its member that is in the fewest
  std::vector<std::uint32_t> uses_, mark_of_occluder_, mark_of_occludee_;
};

// Selects sets for one picture after the other, and keeps its storage.
class SetSelection {
 public:
  // The occluders of the best sets, by number in the picture, best first, at most `limit`. occludees: those
  // of the pool, by number.
  //
  // Sets are taken one after the other, the one with the best score first, ties by their members. The score
  // counts only occludees that the sets taken so far do not hide, and only the cost of occluders that are not
  // taken yet. Occluders that are taken are drawn with ids. When no set gains anything any more, occluders
  // that are not seen are removed, and the occluders that hide them take their places, so that the beginning
  // of the list still hides what the first sets hide.
  //
  // The other sets follow by their first scores, with those of their occluders that are seen then. From the
  // grid point they hide nothing more; beside it they may.
  std::span<const std::uint32_t> select(const OccluderPicture& picture, const SetPool& pool,
                                        std::span<const Occludee> occludees, const MinimumSetWeights& weights,
                                        std::uint32_t limit);

 private:
  void prepare(const OccluderPicture& picture, const SetPool& pool, std::span<const Occludee> occludees,
               const MinimumSetWeights& weights);
  double score(std::uint32_t set) const;
  void take(const OccluderPicture& picture, const SetPool& pool, std::uint32_t set);
  void updateHidden(const OccluderPicture& picture, std::span<const Occludee> occludees);
  void takeBest(const OccluderPicture& picture, const SetPool& pool, std::span<const Occludee> occludees,
                std::uint32_t limit);
  void takeOthers(const OccluderPicture& picture, const SetPool& pool, std::uint32_t limit);
  void appendTaken(const OccluderPicture& picture, std::size_t first, std::uint32_t limit);
  void append(std::uint32_t occluder, std::uint32_t limit);

  std::vector<double> cost_of_;    // by occluder
  std::vector<double> worth_of_;   // by gain: gain^weight
  std::vector<double> set_cost_;   // by set: of what is not taken yet
  std::vector<double> set_score_;  // by set: at first
  std::vector<std::uint32_t> set_gain_;
  std::vector<std::uint8_t> set_taken_, occluder_taken_, in_list_;
  base::Rows<std::uint32_t> sets_of_occluder_, sets_of_occludee_;

  struct Open {
    std::uint32_t occludee = 0;
    std::uint32_t pixel = 0;  // in which nothing is in front of it
  };
  std::vector<Open> open_;  // occludees that have sets and are not hidden yet
  IdBuffer buffer_;
  std::vector<std::uint32_t> taken_;  // occluders, in order
  std::vector<std::uint32_t> order_;  // scratch: sets
  std::vector<std::uint32_t> list_;
};

}  // namespace sightline::comparison
