#include "src/comparison/layers/incremental_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

#include "src/layers/sort/depth_first_sort.h"
#include "tests/layers/graph_source.h"

namespace sightline::comparison {
namespace {

using namespace layers;

// A line of the paper's tables: the list and the output, with parts named from A.
struct Trace {
  std::vector<std::string> lines;

  static std::string name(std::span<const std::uint32_t> members) {
    std::string text;
    for (const std::uint32_t part : members) {
      text += static_cast<char>('A' + part);
    }
    return members.size() > 1 ? "(" + text + ")" : text;
  }
  static void write(void* user, const IncrementalSort& sort, const GroupedOrder& output) {
    std::string line;
    for (const IncrementalSort::Listed& entry : sort.list()) {
      line += name(entry.members) + (entry.marked ? "*" : "");
    }
    line += " | ";
    for (std::size_t i = 0; i < output.groups(); ++i) {
      line += name(output.group(i));
    }
    static_cast<Trace*>(user)->lines.push_back(line);
  }
};

std::vector<std::string> traceOf(GraphSource& graph, std::span<const std::uint32_t> previous) {
  Trace trace;
  GroupedOrder order;
  IncrementalSort().sort(previous, graph, order, {Trace::write, &trace});
  return trace.lines;
}

GraphSource chain(std::uint32_t parts) {
  GraphSource graph(parts);
  for (std::uint32_t i = 0; i + 1 < parts; ++i) {
    graph.add(i, i + 1);
  }
  return graph;
}

GraphSource ring(std::uint32_t parts) {
  GraphSource graph = chain(parts);
  graph.add(parts - 1, 0);
  return graph;
}

using Lines = std::vector<std::string>;

TEST(IncrementalSort, TakesTheStepsOfFigure6) {
  GraphSource graph = chain(3);
  EXPECT_EQ(traceOf(graph, identityOrder(3)), (Lines{"ABC | ", "BC | A", "C | AB", " | ABC"}));
}

TEST(IncrementalSort, TakesTheStepsOfFigure7) {
  GraphSource graph = chain(3);
  EXPECT_EQ(traceOf(graph, std::vector<std::uint32_t>{2, 1, 0}),
            (Lines{"CBA | ", "BC*A | ", "C*AB* | ", "AB*C* | ", "BC | A", "C | AB", " | ABC"}));
}

TEST(IncrementalSort, TakesTheStepsOfFigure8) {
  GraphSource graph = ring(3);
  EXPECT_EQ(traceOf(graph, identityOrder(3)),
            (Lines{"ABC | ", "BCA* | ", "CA*B* | ", "A*B*C* | ", "(ABC) | ", " | (ABC)"}));
}

// The trace was made by hand from Figures 4 and 5. The caption of Figure 5 gives this graph and list.
TEST(IncrementalSort, ACycleBehindAPartThatNothingOccludesIsGrouped) {
  GraphSource graph(3);
  graph.add(0, 1);
  graph.add(1, 0);
  EXPECT_EQ(traceOf(graph, std::vector<std::uint32_t>{2, 0, 1}),
            (Lines{"CAB | ", "AB | C", "BA* | C", "A*B* | C", "(AB) | C", " | C(AB)"}));
}

// A is occluded by the cycle of B and C. When A is first, the path leaves it and finds a cycle without A, so
// A must stay in the list behind the group.
TEST(IncrementalSort, APartThatLeadsToACycleWithoutBeingInItStays) {
  GraphSource graph(3);
  graph.add(1, 2);
  graph.add(2, 1);
  graph.add(1, 0);
  GroupedOrder order;
  for (std::vector<std::uint32_t> previous = identityOrder(3);;) {
    graph.reset();
    IncrementalSort().sort(previous, graph, order);
    EXPECT_EQ(faultOf(order, graph, componentsOf(graph)), "");
    if (!std::next_permutation(previous.begin(), previous.end())) {
      break;
    }
  }
}

void expectSorts(IncrementalSort& sorter, GraphSource& graph, std::span<const std::uint32_t> previous) {
  GroupedOrder order, other;
  graph.reset();
  sorter.sort(previous, graph, order);
  EXPECT_EQ(faultOf(order, graph, componentsOf(graph)), "");
  EXPECT_EQ(faultOfMemberOrder(order, previous), "");
  // There is one query per output and reinsertion; the search for cycles asks about pairs.
  EXPECT_EQ(graph.queries, order.groups() + sorter.reinsertions());
  for (std::uint32_t part = 0; part < graph.parts(); ++part) {
    EXPECT_FALSE(graph.active(part));
  }
  graph.reset();
  DepthFirstSort().sort(previous, graph, other);
  EXPECT_EQ(order.groups(), other.groups());
}

TEST(IncrementalSort, GroupsAreTheComponentsOfEveryGraphOfUpToFourPartsFromEveryOrder) {
  IncrementalSort sorter;
  EXPECT_EQ(faultOfSmallGraphs(sorter), "");
}

TEST(IncrementalSort, GroupsAreTheComponentsOfRandomGraphsAndThoseOfTheDepthFirstSort) {
  IncrementalSort sorter;
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(60, random);
    GraphSource graph = variedGraph(seed, parts, random);
    expectSorts(sorter, graph, shuffledOrder(parts, random));
  }
}

TEST(IncrementalSort, HaltsOnAHundredThousandSmallGraphs) {
  IncrementalSort sorter;
  GroupedOrder order;
  std::mt19937 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const std::size_t parts = 2 + below(6, random);
    GraphSource graph = randomGraph(parts, 50 + below(600, random), random);
    sorter.sort(shuffledOrder(parts, random), graph, order);
    ASSERT_EQ(order.parts.size(), parts) << "seed 7, graph " << i;
    // Each arc must be within a group or go forwards; together with the test of components this checks the
    // order.
    std::array<std::uint32_t, 8> group{};
    for (std::uint32_t g = 0; g < order.groups(); ++g) {
      for (const std::uint32_t part : order.group(g)) {
        group[part] = g;
      }
    }
    for (std::uint32_t back = 0; back < parts; ++back) {
      for (const std::uint32_t front : graph.occludersOf(back)) {
        ASSERT_LE(group[front], group[back]) << "seed 7, graph " << i;
      }
    }
  }
}

// Answers for candidates alone; what it says of groups and pairs is OccluderSource's.
class CandidateSource : public OccluderSource {
 public:
  explicit CandidateSource(GraphSource& graph) : graph_(graph) {}
  void candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) override {
    graph_.candidatesOf(part, candidates);
  }
  bool candidateOccludes(std::uint32_t candidate, std::uint32_t part) override {
    return graph_.candidateOccludes(candidate, part);
  }
  void setActive(std::uint32_t part, bool active) override { graph_.setActive(part, active); }

 private:
  GraphSource& graph_;
};

TEST(IncrementalSort, TheOrderIsTheSameWhereASourceKnowsNothingButCandidates) {
  IncrementalSort sorter;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(40, random);
    GraphSource graph = variedGraph(seed, parts, random);
    CandidateSource candidates(graph);
    const std::vector<std::uint32_t> previous = shuffledOrder(parts, random);
    GroupedOrder order, other;
    graph.reset();
    sorter.sort(previous, graph, order);
    graph.reset();
    sorter.sort(previous, candidates, other);
    EXPECT_EQ(order.parts, other.parts);
    EXPECT_EQ(order.first_of, other.first_of);
  }
}

TEST(IncrementalSort, RingsChainsCompleteGraphsAndNestedCyclesAreSortedFromAnyOrder) {
  IncrementalSort sorter;
  const std::uint32_t parts = 40;
  GraphSource complete(parts);
  GraphSource pairs(parts);   // a chain of cycles of two parts
  GraphSource nested(parts);  // one large cycle with shortcuts back
  GraphSource no_arcs(parts);
  for (std::uint32_t i = 0; i < parts; ++i) {
    for (std::uint32_t k = 0; k < parts; ++k) {
      complete.add(i, k);
    }
    pairs.add(i, i ^ 1u);
    pairs.add(i, std::min(i + 2, parts - 1));
    nested.add(i, (i + 1) % parts);
    nested.add(i, i - i % 5);
  }
  std::vector<GraphSource> graphs{chain(parts), ring(parts), complete, pairs, nested, no_arcs};
  for (std::size_t g = 0; g < graphs.size(); ++g) {
    std::vector<std::uint32_t> reversed = identityOrder(parts);
    expectSorts(sorter, graphs[g], reversed);
    std::reverse(reversed.begin(), reversed.end());
    expectSorts(sorter, graphs[g], reversed);
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("graph " + std::to_string(g) + ", seed " + std::to_string(seed));
      std::mt19937 random(seed);
      expectSorts(sorter, graphs[g], shuffledOrder(parts, random));
    }
  }
}

TEST(IncrementalSort, AValidOrderOfAGraphWithoutCyclesNeedsNoReinsertion) {
  IncrementalSort sorter;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(60, random);
    GraphSource graph = randomAcyclicGraph(parts, below(300, random), random);
    GroupedOrder first, second;
    sorter.sort(shuffledOrder(parts, random), graph, first);
    ASSERT_EQ(faultOf(first, graph, componentsOf(graph)), "");
    graph.reset();
    sorter.sort(first.parts, graph, second);
    EXPECT_EQ(sorter.reinsertions(), 0u);
    EXPECT_EQ(graph.queries, parts);
    EXPECT_EQ(first.parts, second.parts);
  }
}

// Checks each step that begins with a marked object against the caption of Figure 5: if each object of an
// initial subsequence of the marked objects at the front is occluded by another object of it, the step finds
// a cycle.
struct CycleWatch {
  const GraphSource& graph;
  std::vector<IncrementalSort::Listed> before;
  std::size_t promised = 0, missed = 0;

  bool occludes(const IncrementalSort::Listed& front, const IncrementalSort::Listed& back) const {
    for (const std::uint32_t f : front.members) {
      for (const std::uint32_t b : back.members) {
        if (graph.has(f, b)) {
          return true;
        }
      }
    }
    return false;
  }
  bool cycleIsPromised() const {
    std::size_t marked = 0;
    while (marked < before.size() && before[marked].marked) {
      ++marked;
    }
    for (std::size_t size = 2; size <= marked; ++size) {
      const auto end = before.begin() + static_cast<std::ptrdiff_t>(size);
      if (std::all_of(before.begin(), end, [&](const IncrementalSort::Listed& back) {
            return std::any_of(before.begin(), end, [&](const IncrementalSort::Listed& front) {
              return &front != &back && occludes(front, back);
            });
          })) {
        return true;
      }
    }
    return false;
  }
  static void look(void* user, const IncrementalSort& sort, const GroupedOrder&) {
    CycleWatch& watch = *static_cast<CycleWatch*>(user);
    const std::vector<IncrementalSort::Listed> now = sort.list();
    if (watch.cycleIsPromised()) {
      ++watch.promised;
      // An object that is grouped with others is unmarked and stays at the front.
      const bool found =
          !now.empty() && now.size() < watch.before.size() && !now[0].marked && now[0].members.size() > 1;
      watch.missed += found ? 0 : 1;
    }
    watch.before = now;
  }
};

TEST(IncrementalSort, ACycleIsFoundWhereverFigure5PromisesOne) {
  IncrementalSort sorter;
  std::size_t promised = 0;
  for (std::uint32_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    // Sparse graphs large enough for paths that leave the marked objects, which small graphs do not have.
    const std::size_t parts = 10 + below(30, random);
    GraphSource graph = variedGraph(1, parts, random);
    CycleWatch watch{.graph = graph, .before = {}};
    GroupedOrder order;
    sorter.sort(shuffledOrder(parts, random), graph, order, {CycleWatch::look, &watch});
    EXPECT_EQ(watch.missed, 0u);
    promised += watch.promised;
  }
  EXPECT_GT(promised, 1000u);
}

// A source whose answers about pairs contradict its answers about all occluders, and change.
class ContradictingSource : public GraphSource {
 public:
  ContradictingSource(const GraphSource& graph, std::uint32_t seed) : GraphSource(graph), random_(seed) {}
  bool occludes(std::uint32_t, std::uint32_t) override { return below(1000, random_) < lies_per_mille; }

  std::uint32_t lies_per_mille = 0;

 private:
  std::mt19937 random_;
};

TEST(IncrementalSort, HaltsInAValidOrderThoughTheAnswersContradictEachOther) {
  IncrementalSort sorter;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(20, random);
    ContradictingSource graph(randomGraph(parts, below(400, random), random), seed);
    graph.lies_per_mille = seed % 3 == 0 ? 0 : below(300, random);
    GroupedOrder order;
    sorter.sort(shuffledOrder(parts, random), graph, order);
    ASSERT_EQ(order.parts.size(), parts);
    std::vector<std::size_t> group(parts);
    for (std::size_t g = 0; g < order.groups(); ++g) {
      for (const std::uint32_t part : order.group(g)) {
        group[part] = g;
      }
    }
    for (std::uint32_t back = 0; back < parts; ++back) {
      for (const std::uint32_t front : graph.GraphSource::occludersOf(back)) {
        EXPECT_LE(group[front], group[back]);
      }
    }
  }
}

// Compares OrderLabels with a plain list, with insertions crowded into one place and spread over all places.
TEST(OrderLabels, KeepTheOrderOfAPlainListUnderInsertionsAnywhere) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = seed == 0 ? 2 : 50 * seed;
    std::vector<std::uint32_t> plain = shuffledOrder(parts, random);
    OrderLabels labels;
    labels.assign(plain, parts);
    for (int i = 0; i < 3000; ++i) {
      const std::size_t from = seed % 2 == 0 ? 0 : below(plain.size(), random);
      const std::uint32_t item = plain[from];
      plain.erase(plain.begin() + static_cast<std::ptrdiff_t>(from));
      labels.remove(item);
      // 0: first; 1: behind the first, always into the same gap; 2: anywhere.
      const std::size_t to =
          seed % 3 == 2 ? below(plain.size() + 1, random) : std::min<std::size_t>(seed % 3, 1);
      if (to == 0) {
        labels.insertFirst(item);
      } else {
        labels.insertAfter(item, plain[to - 1]);
      }
      plain.insert(plain.begin() + static_cast<std::ptrdiff_t>(to), item);
      const std::size_t a = below(parts, random);
      const std::size_t b = below(parts, random);
      ASSERT_EQ(labels.before(plain[a], plain[b]), a < b);
    }
    std::uint32_t at = labels.first();
    for (std::size_t i = 0; i < parts; ++i, at = labels.next(at)) {
      ASSERT_EQ(at, plain[i]);
      ASSERT_TRUE(i == 0 || labels.before(plain[i - 1], plain[i]));
    }
    EXPECT_EQ(at, OrderLabels::kNone);
  }
}

}  // namespace
}  // namespace sightline::comparison
