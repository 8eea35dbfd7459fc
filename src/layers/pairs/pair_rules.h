#pragma once

// The rules that the program has set for pairs of parts.

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "sightline/layers/pair_rule.h"
#include "src/layers/pairs/pair_index.h"

namespace sightline::layers {

// The two parts are the front and the back of one closed convex surface.
struct ContainerRule {};

struct PairRule {
  std::uint32_t first = 0, second = 0;  // parts; of a container: its front and its back
  // std::monostate: the rule has been cleared.
  std::variant<std::monostate, PairPlane, SphereCylinderJoint, PairCallback, ContainerRule> what;
};

// Holds at most one rule per unordered pair; a new rule replaces the old one. A part belongs to at most one
// container, which ends with a new container or another rule for its two parts. A rule of a part with itself
// is ignored. Searching is almost free for parts without rules.
class PairRules {
 public:
  static constexpr std::uint32_t kNone = PairIndex::kNone;

  struct Container {
    std::uint32_t other = kNone;  // the container's other part; kNone: in no container
    bool is_front = false;
  };

  void set(std::uint32_t first, std::uint32_t second, const PairPlane& rule);
  void set(std::uint32_t first, std::uint32_t second, const SphereCylinderJoint& rule);
  void set(std::uint32_t first, std::uint32_t second, const PairCallback& rule);
  void setContainer(std::uint32_t front, std::uint32_t back);
  void clear(std::uint32_t first, std::uint32_t second);
  void clear(std::uint32_t part);  // all rules of the part
  // Gives part `to` every rule of `from` with another part, except containers.
  void copy(std::uint32_t from, std::uint32_t to);

  // Returns the number of the rule for two parts in any order, or kNone.
  std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    return ruled(a) && ruled(b) ? findRuled(a, b) : kNone;
  }
  const PairRule& rule(std::uint32_t number) const { return rules_[number]; }
  // All rule numbers are below this.
  std::size_t numbers() const { return rules_.size(); }
  Container containerOf(std::uint32_t part) const {
    return part < parts_.size() ? parts_[part].container : Container{};
  }

 private:
  struct Part {
    std::uint32_t rules = 0;
    Container container;
  };

  bool ruled(std::uint32_t part) const { return part < parts_.size() && parts_[part].rules != 0; }
  std::uint32_t findRuled(std::uint32_t a, std::uint32_t b) const;
  void set(const PairRule& rule);

  PairIndex index_;  // all pairs that ever had a rule
  std::vector<PairRule> rules_;
  std::vector<Part> parts_;
};

}  // namespace sightline::layers
