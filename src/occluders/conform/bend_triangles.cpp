#include "src/occluders/conform/bend_triangles.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace sightline::occluders {

TriangleBender::TriangleBender(std::span<const MeshEdge> edges, const base::Rows<std::uint32_t>& through,
                               BentTriangles& bent)
    : edges_(edges), through_(through), bent_(bent) {
  first_of_low_.resize(edges.empty() ? 1 : std::size_t{edges.back().low} + 2);
  for (const MeshEdge& edge : edges) {
    ++first_of_low_[edge.low + 1];
  }
  std::partial_sum(first_of_low_.begin(), first_of_low_.end(), first_of_low_.begin());
}

// The vertices through which the way from a to b is led, in this direction.
void TriangleBender::findWay(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& way) const {
  way.clear();
  const MeshEdge edge = meshEdge(a, b);
  if (std::size_t{edge.low} + 1 >= first_of_low_.size()) {
    return;
  }
  const auto of_low = edges_.begin() + first_of_low_[edge.low],
             end = edges_.begin() + first_of_low_[edge.low + 1];
  const auto found = std::ranges::lower_bound(of_low, end, edge.high, {}, &MeshEdge::high);
  if (found == end || found->high != edge.high) {
    return;
  }
  const std::span<const std::uint32_t> through = through_[static_cast<std::size_t>(found - edges_.begin())];
  way.assign(through.begin(), through.end());
  if (a > b) {
    std::reverse(way.begin(), way.end());
  }
}

void TriangleBender::append(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t source) {
  if (a != b && b != c && c != a) {
    bent_.triangles.insert(bent_.triangles.end(), {a, b, c});
    bent_.source.push_back(source);
  } else {
    bent_.collapsed.insert(bent_.collapsed.end(), {a, b, c});
    bent_.collapsed_source.push_back(source);
  }
}

// Adds the triangles between a point and each step of the way from a to b.
void TriangleBender::addFan(std::uint32_t point, std::uint32_t a, std::span<const std::uint32_t> way,
                            std::uint32_t b, std::uint32_t source) {
  for (const std::uint32_t next : way) {
    append(point, a, next, source);
    a = next;
  }
  append(point, a, b, source);
}

// Whether what is left of a triangle runs back along its own border: its corners lie on a line, or have
// come to do so.
bool TriangleBender::isFolded(const std::uint32_t (&corners)[3]) {
  loop_.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    loop_.push_back(corners[k]);
    loop_.insert(loop_.end(), ways_[k].begin(), ways_[k].end());
  }
  steps_.clear();
  for (std::size_t i = 0; i < loop_.size(); ++i) {
    const std::uint32_t a = loop_[i], b = loop_[i + 1 < loop_.size() ? i + 1 : 0];
    if (a != b) {
      steps_.push_back({meshEdge(a, b), a < b});
    }
  }
  std::sort(steps_.begin(), steps_.end());
  for (std::size_t i = 0; i < steps_.size();) {
    int value = 0;
    const MeshEdge edge = steps_[i].first;
    for (; i < steps_.size() && steps_[i].first == edge; ++i) {
      value += steps_[i].second ? 1 : -1;
    }
    if (value != 0) {
      return false;
    }
  }
  return true;
}

void TriangleBender::add(const std::uint32_t (&corners)[3], std::uint32_t source) {
  for (std::size_t k = 0; k < 3; ++k) {
    findWay(corners[k], corners[(k + 1) % 3], ways_[k]);
  }
  std::size_t first = 0;
  while (first < 3 && ways_[first].empty()) {
    ++first;
  }
  if (first == 3) {
    append(corners[0], corners[1], corners[2], source);
    return;
  }
  if (isFolded(corners)) {
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::uint32_t next = loop_[i + 1 < loop_.size() ? i + 1 : 0];
      append(loop_[i], next, next, source);
    }
    return;
  }
  const std::uint32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
  const std::vector<std::uint32_t>&to_b = ways_[first], &to_c = ways_[(first + 1) % 3],
        &to_a = ways_[(first + 2) % 3];
  addFan(to_b.front(), c, to_a, a, source);
  if (to_b.size() > 1) {
    addFan(c, to_b.front(), std::span(to_b).subspan(1, to_b.size() - 2), to_b.back(), source);
  }
  addFan(to_b.back(), b, to_c, c, source);
}

}  // namespace sightline::occluders
