// Merges layers that occlude each other mutually (binary cycles) until none are left.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 8, "Compositing Expression Compilation".

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"
#include "src/base/rows.h"
#include "src/base/union_find.h"

namespace sightline {
namespace {

// An arc between places in the order. A place stands for a part, and a layer's first place for the layer.
struct PlaceArc {
  std::uint32_t front = 0, back = 0;

  friend auto operator<=>(const PlaceArc&, const PlaceArc&) = default;
};

constexpr std::uint32_t kNotInOrder = 0xffffffffu;

}  // namespace

struct LayerMerger::Impl {
  std::vector<std::uint32_t> place_of;  // one per part
  std::vector<std::uint32_t> group_of;  // one per place
  base::UnionFind places;               // sets of places in the same layer, which is named by its first place
  std::vector<std::uint32_t> number;    // one per place: number of its layer
  std::vector<PlaceArc> arcs;           // ascending, without duplicates
  FrameLayers layers;

  void read(const LayerOrder& order);
  void takeArcs(std::span<const LayerArc> given);
  bool mergePairs();
  void contractArcs();
  void numberLayers(const LayerOrder& order);
  void listParts(const LayerOrder& order);
};

void LayerMerger::Impl::read(const LayerOrder& order) {
  std::uint32_t parts = 0;
  for (const PartId part : order.parts) {
    parts = std::max(parts, part.value + 1);
  }
  place_of.assign(parts, kNotInOrder);
  group_of.resize(order.parts.size());
  places.reset(order.parts.size());
  for (std::size_t g = 0; g < order.groups(); ++g) {
    for (std::uint32_t i = order.first_of[g]; i < order.first_of[g + 1]; ++i) {
      place_of[order.parts[i].value] = i;
      group_of[i] = static_cast<std::uint32_t>(g);
    }
  }
  takeArcs(order.arcs);
  if (order.depth_buffered != LayerOrder::kNone) {
    const std::uint32_t first = order.first_of[order.depth_buffered];
    for (std::uint32_t i = first + 1; i < order.first_of[order.depth_buffered + 1]; ++i) {
      places.unite(first, i);
    }
  }
}

void LayerMerger::Impl::takeArcs(std::span<const LayerArc> given) {
  const auto placeOf = [&](PartId part) {
    return part.value < place_of.size() ? place_of[part.value] : kNotInOrder;
  };
  arcs.clear();
  for (const LayerArc& arc : given) {
    const std::uint32_t front = placeOf(arc.front), back = placeOf(arc.back);
    if (front != kNotInOrder && back != kNotInOrder && front != back && group_of[front] == group_of[back]) {
      arcs.push_back({front, back});
    }
  }
  std::sort(arcs.begin(), arcs.end());
  arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
}

// Merges all pairs of layers that occlude each other mutually. Returns whether there was one.
bool LayerMerger::Impl::mergePairs() {
  bool merged = false;
  for (const PlaceArc& arc : arcs) {
    if (arc.front < arc.back && std::binary_search(arcs.begin(), arcs.end(), PlaceArc{arc.back, arc.front})) {
      places.unite(arc.front, arc.back);
      merged = true;
    }
  }
  return merged;
}

void LayerMerger::Impl::contractArcs() {
  for (PlaceArc& arc : arcs) {
    arc = {places.root(arc.front), places.root(arc.back)};
  }
  std::erase_if(arcs, [](const PlaceArc& arc) { return arc.front == arc.back; });
  std::sort(arcs.begin(), arcs.end());
  arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
}

void LayerMerger::Impl::numberLayers(const LayerOrder& order) {
  const std::size_t parts = order.parts.size();
  number.resize(parts);
  layers.first_layer.assign(1, 0u);
  std::uint32_t count = 0;
  for (std::size_t g = 0; g < order.groups(); ++g) {
    for (std::uint32_t i = order.first_of[g]; i < order.first_of[g + 1]; ++i) {
      const std::uint32_t of = places.root(i);
      if (of == i) {
        number[i] = count++;
      }
      number[i] = number[of];
    }
    layers.first_layer.push_back(count);
  }
}

void LayerMerger::Impl::listParts(const LayerOrder& order) {
  base::groupIntoRows(layers.first_layer.back(), layers.first_part, layers.parts, [&](auto&& body) {
    for (std::size_t i = 0; i < order.parts.size(); ++i) {
      body(number[i], order.parts[i]);
    }
  });
}

LayerMerger::LayerMerger() : impl_(std::make_unique<Impl>()) {}
LayerMerger::~LayerMerger() = default;
LayerMerger::LayerMerger(LayerMerger&&) noexcept = default;
LayerMerger& LayerMerger::operator=(LayerMerger&&) noexcept = default;

const FrameLayers& LayerMerger::merge(const LayerOrder& order) {
  Impl& m = *impl_;
  m.read(order);
  // A merged layer may occlude a layer that occludes another of its parts.
  while (m.mergePairs()) {
    m.contractArcs();
  }
  m.numberLayers(order);
  m.listParts(order);
  m.layers.depth_buffered = {};
  m.layers.first_hidden = LayerId(0u);
  if (order.depth_buffered != LayerOrder::kNone) {
    m.layers.depth_buffered = LayerId(m.layers.first_layer[order.depth_buffered]);
    m.layers.first_hidden = LayerId(m.layers.first_layer[order.first_sorted]);
  }
  m.layers.occlusions.clear();
  for (const PlaceArc& arc : m.arcs) {
    // Layers are numbered by their first places, so the occlusions are ascending, too.
    m.layers.occlusions.push_back({LayerId(m.number[arc.front]), LayerId(m.number[arc.back])});
  }
  return m.layers;
}

}  // namespace sightline
