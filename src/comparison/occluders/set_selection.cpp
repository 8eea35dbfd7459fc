// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 4.3.
// Differs from the paper in: an occludee that several subsets hide counts once; gain and cost are those that
// a set adds to what was taken before, where the paper's scores stay as they are; an occluder that is hidden
// by later ones leaves them its place in the order.

#include "src/comparison/occluders/set_selection.h"

#include <algorithm>
#include <cmath>

namespace sightline::comparison {
namespace {

constexpr double kMinCost = 1e-6;  // for weights of zero

}  // namespace

double costOf(const ShownOccluder& occluder, std::uint32_t picture_pixels, const MinimumSetWeights& weights) {
  return weights.count + weights.area * occluder.area / picture_pixels;
}

void costsOf(const OccluderPicture& picture, const MinimumSetWeights& weights, std::vector<double>& costs) {
  costs.clear();
  for (const ShownOccluder& occluder : picture.occluders()) {
    costs.push_back(costOf(occluder, picture.pixelCount(), weights));
  }
}

void SetPool::clear() {
  sets_.clear();
  members_.clear();
}

void SetPool::add(std::span<const std::uint32_t> members, std::uint32_t occludee) {
  sets_.push_back(
      {static_cast<std::uint32_t>(members_.size()), static_cast<std::uint32_t>(members.size()), occludee});
  members_.insert(members_.end(), members.begin(), members.end());
}

void SetPool::finish(std::uint32_t occluder_count, std::uint32_t occludee_count) {
  mergeEqual();
  indexByRarest(occluder_count);
  inherit(occluder_count, occludee_count);
}

void SetPool::mergeEqual() {
  std::sort(sets_.begin(), sets_.end(), [this](const Set& a, const Set& b) {
    const auto in_a = membersOf(a), in_b = membersOf(b);
    const auto [at_a, at_b] = std::mismatch(in_a.begin(), in_a.end(), in_b.begin(), in_b.end());
    if (at_a == in_a.end() && at_b == in_b.end()) {
      return a.occludee < b.occludee;
    }
    return at_b != in_b.end() && (at_a == in_a.end() || *at_a < *at_b);
  });
  own_.clear();
  std::size_t kept = 0;
  for (const Set& set : sets_) {
    const auto members = membersOf(set);
    const bool is_new =
        kept == 0 || !std::equal(members.begin(), members.end(), membersOf(sets_[kept - 1]).begin(),
                                 membersOf(sets_[kept - 1]).end());
    const bool is_twice = !is_new && own_.items().back() == set.occludee;
    if (is_new) {
      if (kept > 0) {
        own_.endRow();
      }
      sets_[kept++] = set;
    }
    if (!is_twice) {
      own_.add(set.occludee);
    }
  }
  own_.endRow();
  sets_.resize(kept);
}

void SetPool::indexByRarest(std::uint32_t occluder_count) {
  uses_.assign(occluder_count, 0);
  for (const Set& set : sets_) {
    for (const std::uint32_t member : membersOf(set)) {
      ++uses_[member];
    }
  }
  by_rarest_.group(occluder_count, [this](auto&& body) {
    for (std::uint32_t s = 0; s < sets_.size(); ++s) {
      const auto members = membersOf(sets_[s]);
      body(*std::min_element(members.begin(), members.end(),
                             [this](std::uint32_t a, std::uint32_t b) { return uses_[a] < uses_[b]; }),
           s);
    }
  });
}

// Each set gets the occludees of its subsets, which are found under its members.
void SetPool::inherit(std::uint32_t occluder_count, std::uint32_t occludee_count) {
  mark_of_occluder_.assign(occluder_count, 0);
  mark_of_occludee_.assign(occludee_count, 0);
  hidden_.clear();
  for (std::uint32_t s = 0; s < sets_.size(); ++s) {
    const std::uint32_t mark = s + 1;
    for (const std::uint32_t member : membersOf(sets_[s])) {
      mark_of_occluder_[member] = mark;
    }
    for (const std::uint32_t member : membersOf(sets_[s])) {
      for (const std::uint32_t other : by_rarest_[member]) {
        const auto others = membersOf(sets_[other]);
        if (!std::all_of(others.begin(), others.end(),
                         [&](std::uint32_t m) { return mark_of_occluder_[m] == mark; })) {
          continue;
        }
        for (const std::uint32_t occludee : own_[other]) {
          if (mark_of_occludee_[occludee] != mark) {
            mark_of_occludee_[occludee] = mark;
            hidden_.add(occludee);
          }
        }
      }
    }
    hidden_.endRow();
  }
}

std::span<const std::uint32_t> SetSelection::select(const OccluderPicture& picture, const SetPool& pool,
                                                    std::span<const Occludee> occludees,
                                                    const MinimumSetWeights& weights, std::uint32_t limit) {
  list_.clear();
  if (pool.setCount() > 0 && limit > 0) {
    prepare(picture, pool, occludees, weights);
    takeBest(picture, pool, occludees, limit);
    appendTaken(picture, 0, limit);
    const std::size_t taken_before = taken_.size();
    takeOthers(picture, pool, limit);
    appendTaken(picture, taken_before, limit);
  }
  return list_;
}

void SetSelection::prepare(const OccluderPicture& picture, const SetPool& pool,
                           std::span<const Occludee> occludees, const MinimumSetWeights& weights) {
  const auto occluder_count = static_cast<std::uint32_t>(picture.occluders().size());
  const auto occludee_count = static_cast<std::uint32_t>(occludees.size());
  costsOf(picture, weights, cost_of_);
  worth_of_.clear();
  for (std::uint32_t gain = 0; gain <= occludee_count; ++gain) {
    worth_of_.push_back(std::pow(static_cast<double>(gain), weights.gain));
  }
  sets_of_occluder_.group(occluder_count, [&](auto&& body) {
    for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
      for (const std::uint32_t member : pool.members(s)) {
        body(member, s);
      }
    }
  });
  sets_of_occludee_.group(occludee_count, [&](auto&& body) {
    for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
      for (const std::uint32_t occludee : pool.occludees(s)) {
        body(occludee, s);
      }
    }
  });
  set_gain_.clear();
  set_cost_.clear();
  set_score_.clear();
  for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
    set_gain_.push_back(pool.gain(s));
    double cost = 0.0;
    for (const std::uint32_t member : pool.members(s)) {
      cost += cost_of_[member];
    }
    set_cost_.push_back(cost);
    set_score_.push_back(score(s));
  }
  open_.clear();
  for (std::uint32_t o = 0; o < occludee_count; ++o) {
    if (!sets_of_occludee_[o].empty()) {
      open_.push_back({o, occludees[o].rect.low * picture.resolution() + occludees[o].rect.left});
    }
  }
  set_taken_.assign(pool.setCount(), 0);
  occluder_taken_.assign(occluder_count, 0);
  in_list_.assign(occluder_count, 0);
  taken_.clear();
  buffer_.clear(picture);
}

// Divides what is left of the set's gain by what is left of its cost.
double SetSelection::score(std::uint32_t set) const {
  return worth_of_[set_gain_[set]] / std::max(set_cost_[set], kMinCost);
}

void SetSelection::take(const OccluderPicture& picture, const SetPool& pool, std::uint32_t set) {
  set_taken_[set] = 1;
  for (const std::uint32_t member : pool.members(set)) {
    if (occluder_taken_[member] != 0) {
      continue;
    }
    occluder_taken_[member] = 1;
    taken_.push_back(member);
    buffer_.draw(picture, member);
    for (const std::uint32_t touched : sets_of_occluder_[member]) {
      set_cost_[touched] -= cost_of_[member];
    }
  }
}

// Sets lose the occludees that have become hidden.
void SetSelection::updateHidden(const OccluderPicture& picture, std::span<const Occludee> occludees) {
  const auto isHidden = [&](Open& open) {
    if (!hides(buffer_, picture.resolution(), occludees[open.occludee], open.pixel)) {
      return false;
    }
    for (const std::uint32_t touched : sets_of_occludee_[open.occludee]) {
      --set_gain_[touched];
    }
    return true;
  };
  std::size_t kept = 0;
  for (Open open : open_) {
    if (!isHidden(open)) {
      open_[kept++] = open;
    }
  }
  open_.resize(kept);
}

void SetSelection::takeBest(const OccluderPicture& picture, const SetPool& pool,
                            std::span<const Occludee> occludees, std::uint32_t limit) {
  while (buffer_.survivors() < limit) {
    std::uint32_t best = pool.setCount();
    double best_score = 0.0;
    for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
      if (set_taken_[s] == 0 && set_gain_[s] > 0 && (best == pool.setCount() || score(s) > best_score)) {
        best = s;
        best_score = score(s);
      }
    }
    if (best == pool.setCount()) {
      return;
    }
    take(picture, pool, best);
    updateHidden(picture, occludees);
  }
}

void SetSelection::takeOthers(const OccluderPicture& picture, const SetPool& pool, std::uint32_t limit) {
  order_.clear();
  for (std::uint32_t s = 0; s < pool.setCount(); ++s) {
    if (set_taken_[s] == 0) {
      order_.push_back(s);
    }
  }
  std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return set_score_[a] > set_score_[b] || (set_score_[a] == set_score_[b] && a < b);
  });
  for (const std::uint32_t set : order_) {
    if (buffer_.survivors() >= limit) {
      return;
    }
    take(picture, pool, set);
  }
}

// Appends the occluders that were taken, from number `first` on.
void SetSelection::appendTaken(const OccluderPicture& picture, std::size_t first, std::uint32_t limit) {
  for (const std::uint32_t occluder : std::span(taken_).subspan(first)) {
    if (buffer_.pixelsOf(occluder) > 0) {
      append(occluder, limit);
      continue;
    }
    picture.forEachPixel(occluder,
                         [&](std::uint32_t pixel, float) { append(buffer_.occluderAt(pixel), limit); });
  }
}

void SetSelection::append(std::uint32_t occluder, std::uint32_t limit) {
  if (in_list_[occluder] == 0 && list_.size() < limit) {
    in_list_[occluder] = 1;
    list_.push_back(occluder);
  }
}

}  // namespace sightline::comparison
