#include "src/pvs/bake/runs.h"

#include <algorithm>

namespace sightline::pvs {

void intersect(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out) {
  out.clear();
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const std::uint32_t begin = std::max(a[i].begin, b[j].begin), end = std::min(a[i].end, b[j].end);
    if (begin < end) {
      out.push_back({begin, end});
    }
    if (a[i].end < b[j].end) {
      ++i;
    } else {
      ++j;
    }
  }
}

void unite(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out) {
  out.clear();
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool from_a = j == b.size() || (i < a.size() && a[i].begin <= b[j].begin);
    const ObjectRun& run = from_a ? a[i++] : b[j++];
    if (!out.empty() && run.begin <= out.back().end) {
      out.back().end = std::max(out.back().end, run.end);
    } else {
      out.push_back(run);
    }
  }
}

void subtract(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out) {
  out.clear();
  std::size_t j = 0;
  for (const ObjectRun& run : a) {
    std::uint32_t begin = run.begin;
    while (j < b.size() && b[j].end <= begin) {
      ++j;
    }
    for (std::size_t k = j; k < b.size() && b[k].begin < run.end; ++k) {
      if (begin < b[k].begin) {
        out.push_back({begin, b[k].begin});
      }
      begin = b[k].end;
    }
    if (begin < run.end) {
      out.push_back({begin, run.end});
    }
  }
}

void appendNodes(const BoxTreeView& tree, std::span<const ObjectRun> runs,
                 std::vector<std::uint32_t>& nodes) {
  std::size_t run = 0;
  for (std::uint32_t n = 0; n < tree.nodes.size() && run < runs.size();) {
    const BoxNode& node = tree.nodes[n];
    const std::uint32_t begin = node.first_object, end = begin + node.object_count;
    while (run < runs.size() && runs[run].end <= begin) {
      ++run;
    }
    if (run == runs.size() || runs[run].begin >= end) {
      n = node.end;
    } else if (runs[run].begin <= begin && runs[run].end >= end) {
      nodes.push_back(n);
      n = node.end;
    } else {
      n += 1;
    }
  }
}

TriangleCounts::TriangleCounts(const BoxTreeView& tree) : before_(tree.objects.size() + 1) {
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    if (tree.leaf(n)) {
      before_[tree.nodes[n].first_object + 1] = tree.nodes[n].triangles;
    }
  }
  for (std::size_t i = 1; i < before_.size(); ++i) {
    before_[i] += before_[i - 1];
  }
}

}  // namespace sightline::pvs
