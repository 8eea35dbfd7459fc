#include "src/layers/split/piece_tree.h"

#include <algorithm>
#include <utility>

namespace sightline::layers {

std::uint32_t PieceTrees::find(PartId part) const {
  return part.value < node_of_.size() ? node_of_[part.value] : kNone;
}

void PieceTrees::setNode(PartId part, std::uint32_t node) {
  node_of_.resize(std::max<std::size_t>(node_of_.size(), std::size_t{part.value} + 1), kNone);
  node_of_[part.value] = node;
}

std::uint32_t PieceTrees::makeNode() {
  if (free_nodes_.empty()) {
    nodes_.emplace_back();
    return size() - 1;
  }
  const std::uint32_t node = free_nodes_.back();
  free_nodes_.pop_back();
  nodes_[node] = {};
  return node;
}

void PieceTrees::release(std::uint32_t node) {
  nodes_[node] = {};
  nodes_[node].in_use = false;
  free_nodes_.push_back(node);
}

std::uint32_t PieceTrees::rootOf(PartId part) {
  if (const std::uint32_t known = find(part); known != kNone) {
    return known;
  }
  const std::uint32_t node = makeNode();
  nodes_[node].part = nodes_[node].whole = part;
  setNode(part, node);
  return node;
}

// Makes a part of a piece, with the rules of the part that it takes the place of.
void PieceTrees::addToSorter(std::uint32_t number, PartId like) {
  Node& node = nodes_[number];
  for (const ShapeBody& body : node.shape.bodies) {
    if (free_hulls_.empty()) {
      node.hulls.push_back(sorter_->addHull(body.hull));
      continue;
    }
    node.hulls.push_back(free_hulls_.back());
    free_hulls_.pop_back();
    sorter_->setHull(node.hulls.back(), body.hull);
  }
  node.part = sorter_->addPart(node.hulls, sorter_->settingsOf(node.whole));
  sorter_->setTransform(node.part, sorter_->transformOf(node.whole));
  sorter_->copyRules(like, node.part);
  setNode(node.part, number);
}

void PieceTrees::removeFromSorter(std::uint32_t number) {
  Node& node = nodes_[number];
  if (node.parent == kNone) {
    sorter_->setEnabled(node.part, false);
    return;
  }
  sorter_->removePart(node.part);
  setNode(node.part, kNone);
  free_hulls_.insert(free_hulls_.end(), node.hulls.begin(), node.hulls.end());
  node.hulls.clear();
  node.part = {};
}

std::pair<std::uint32_t, std::uint32_t> PieceTrees::divide(std::uint32_t number, const Plane& plane,
                                                           PartShape front, PartShape behind,
                                                           double weight_in_front) {
  const std::uint32_t first = makeNode(), second = makeNode();
  Node& node = nodes_[number];
  node.front = first;
  node.behind = second;
  node.plane = plane;
  for (const std::uint32_t half : {first, second}) {
    nodes_[half].whole = node.whole;
    nodes_[half].parent = number;
    nodes_[half].depth = node.depth + 1;
  }
  nodes_[first].shape = std::move(front);
  nodes_[second].shape = std::move(behind);
  nodes_[first].weight = weight_in_front;
  nodes_[second].weight = node.weight - weight_in_front;
  addToSorter(first, node.part);
  addToSorter(second, node.part);
  sorter_->setRule(nodes_[first].part, nodes_[second].part, PairPlane{plane});
  pieces_ += node.parent == kNone ? 2 : 1;
  removeFromSorter(number);
  return {first, second};
}

bool PieceTrees::canJoin(std::uint32_t number) const {
  const Node& node = nodes_[number];
  return node.in_use && node.isDivided() && !nodes_[node.front].isDivided() &&
         !nodes_[node.behind].isDivided();
}

void PieceTrees::join(std::uint32_t number) {
  const std::uint32_t front = nodes_[number].front, behind = nodes_[number].behind;
  const bool is_root = nodes_[number].parent == kNone;
  if (is_root) {
    sorter_->setEnabled(nodes_[number].part, true);
  } else {
    // The piece gets the rules of a half. The half's rule with the other half, of which the piece gets a copy
    // too, ends when the other half is removed below.
    addToSorter(number, nodes_[front].part);
  }
  for (const std::uint32_t half : {front, behind}) {
    removeFromSorter(half);
    release(half);
  }
  pieces_ -= is_root ? 2 : 1;
  nodes_[number].front = nodes_[number].behind = kNone;
  nodes_[number].is_superfluous = false;
  if (is_root) {
    // A removed part's number may be that of a piece meanwhile.
    if (find(nodes_[number].part) == number) {
      setNode(nodes_[number].part, kNone);
    }
    release(number);
  }
}

void PieceTrees::joinAll(PartId whole) {
  // Pieces of pieces are joined first, and those of the part last.
  for (bool joined = true; joined;) {
    joined = false;
    for (std::uint32_t node = 0; node < size(); ++node) {
      if (canJoin(node) && nodes_[node].whole == whole) {
        join(node);
        joined = true;
      }
    }
  }
}

void PieceTrees::place() {
  for (const Node& node : nodes_) {
    if (node.in_use && node.parent != kNone && !node.isDivided()) {
      sorter_->setTransform(node.part, sorter_->transformOf(node.whole));
    }
  }
}

void PieceTrees::collect(std::vector<PartPiece>& pieces) const {
  pieces.clear();
  for (std::uint32_t number = 0; number < size(); ++number) {
    const Node& node = nodes_[number];
    if (!node.in_use || node.parent == kNone || node.isDivided()) {
      continue;
    }
    PartPiece& piece = pieces.emplace_back();
    piece.piece = node.part;
    piece.part = node.whole;
    for (std::uint32_t at = number; nodes_[at].parent != kNone; at = nodes_[at].parent) {
      const Node& parent = nodes_[nodes_[at].parent];
      piece.sides.push_back({parent.plane, parent.front == at});
    }
    std::reverse(piece.sides.begin(), piece.sides.end());
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const PartPiece& a, const PartPiece& b) { return a.piece < b.piece; });
}

std::uint32_t PieceTrees::dividedParts() const {
  return static_cast<std::uint32_t>(std::count_if(nodes_.begin(), nodes_.end(), [](const Node& node) {
    return node.in_use && node.parent == kNone && node.isDivided();
  }));
}

}  // namespace sightline::layers
