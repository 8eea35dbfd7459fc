#include "src/layers/pairs/pair_rules.h"

#include <algorithm>

namespace sightline::layers {
namespace {

PairKey keyOf(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b), 0};
}

}  // namespace

void PairRules::set(std::uint32_t first, std::uint32_t second, const PairPlane& rule) {
  set({first, second, rule});
}

void PairRules::set(std::uint32_t first, std::uint32_t second, const SphereCylinderJoint& rule) {
  set({first, second, rule});
}

void PairRules::set(std::uint32_t first, std::uint32_t second, const PairCallback& rule) {
  set({first, second, rule});
}

void PairRules::setContainer(std::uint32_t front, std::uint32_t back) {
  if (front == back) {
    return;
  }
  for (const std::uint32_t part : {front, back}) {
    const std::uint32_t other = containerOf(part).other;
    if (other != kNone) {
      clear(part, other);
    }
  }
  set({front, back, ContainerRule{}});
  parts_[front].container = {back, true};
  parts_[back].container = {front, false};
}

void PairRules::clear(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t number = find(first, second);
  if (number == kNone) {
    return;
  }
  if (std::holds_alternative<ContainerRule>(rules_[number].what)) {
    parts_[first].container = {};
    parts_[second].container = {};
  }
  rules_[number].what = std::monostate{};
  --parts_[first].rules;
  --parts_[second].rules;
}

void PairRules::clear(std::uint32_t part) {
  for (std::size_t i = 0; i < rules_.size() && ruled(part); ++i) {
    if (rules_[i].first == part || rules_[i].second == part) {
      clear(rules_[i].first, rules_[i].second);
    }
  }
}

void PairRules::copy(std::uint32_t from, std::uint32_t to) {
  // set() appends, and what it appends is of `to` alone.
  const std::size_t known = from != to && ruled(from) ? rules_.size() : 0;
  for (std::size_t i = 0; i < known; ++i) {
    PairRule rule = rules_[i];
    const bool is_first = rule.first == from, is_second = rule.second == from;
    if ((!is_first && !is_second) || std::holds_alternative<std::monostate>(rule.what) ||
        std::holds_alternative<ContainerRule>(rule.what)) {
      continue;
    }
    (is_first ? rule.first : rule.second) = to;
    set(rule);
  }
}

std::uint32_t PairRules::findRuled(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t number = index_.find(keyOf(a, b));
  return number == kNone || std::holds_alternative<std::monostate>(rules_[number].what) ? kNone : number;
}

void PairRules::set(const PairRule& rule) {
  if (rule.first == rule.second) {
    return;
  }
  clear(rule.first, rule.second);
  const PairKey key = keyOf(rule.first, rule.second);
  std::uint32_t number = index_.find(key);
  if (number == kNone) {
    number = static_cast<std::uint32_t>(rules_.size());
    index_.add(key);
    rules_.emplace_back();
  }
  rules_[number] = rule;
  parts_.resize(std::max<std::size_t>(parts_.size(), std::size_t{key.b} + 1));
  ++parts_[rule.first].rules;
  ++parts_[rule.second].rules;
}

}  // namespace sightline::layers
