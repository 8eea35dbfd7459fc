#pragma once

// The best occluders for the viewpoints of one cell, for every direction: scores, and the search for them.

#include <span>
#include <utility>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occluders/occluder_set.h"
#include "src/occluders/database/sphere_directions.h"

namespace sightline::occluders {

// What the score of an occluder depends on, in metres and square metres.
struct Candidate {
  Vec3d centroid;
  Plane plane;  // unit normal
  double area = 0.0;
  double radius = 0.0;  // of a sphere around the centroid that holds the polygon
  OccluderId id;
  bool double_sided = false;
};

// A hierarchy over the centroids of a set's occluders.
class CandidateTree {
 public:
  // Leaves out occluders without area or with coordinates that are not finite. turned_away: swaps front and
  // back of each occluder.
  explicit CandidateTree(const OccluderSet& set, bool turned_away = false);

  std::uint32_t count() const { return static_cast<std::uint32_t>(candidates_.size()); }
  const Box& bounds() const { return bounds_; }  // of the centroids; empty without candidates

  // A node bounds the candidates below it.
  struct Node {
    Vec3d min, max;  // of the centroids
    double max_area = 0.0;
    double radius = 0.0;                 // of a sphere around the middle that holds the polygons
    std::uint32_t first = 0, after = 0;  // leaf: its candidates
    std::uint32_t right = 0;             // inner: its second child; the first one follows it
    bool leaf() const { return after != 0; }
  };
  std::span<const Node> nodes() const { return nodes_; }
  const Candidate& operator[](std::uint32_t index) const { return candidates_[index]; }

 private:
  std::vector<Node> nodes_;
  std::vector<Candidate> candidates_;  // leaf after leaf
  Box bounds_;
};

struct ListSettings {
  std::uint32_t count = 0;        // k
  double view_angle_deg = 100.0;  // clamped to [0, 360]
  AreaAngleDirection direction = AreaAngleDirection::kOccluder;
};

// Finds the lists of one cell after the other, and keeps its storage. Each thread has one of its own.
class ListFinder {
 public:
  ListFinder(const CandidateTree& tree, const occluders::SphereDirections& directions,
             const ListSettings& settings);

  // Finds exactly the k best occluders by score for each direction, best first, ties by id. Those of
  // direction d are written from ids[d * k] on, their number to counts[d]. ids: directions * k entries;
  // counts: one for each direction.
  void find(const Box& cell, std::span<OccluderId> ids, std::span<std::uint32_t> counts);

 private:
  struct Cell {
    Vec3d min, max, center;
    double radius = 0.0;  // of the sphere around the box
  };
  // A node to be opened, or an occluder to be taken. The largest bound comes first; of equal ones nodes come
  // before occluders, and these by id.
  struct Entry {
    double bound = 0.0;
    std::uint32_t rank = 0;   // node: 0, occluder: id + 1
    std::uint32_t index = 0;  // of the node or the candidate
    friend bool operator<(const Entry& a, const Entry& b) {
      return a.bound < b.bound || (a.bound == b.bound && a.rank > b.rank);
    }
  };
  using Ranked = std::pair<double, OccluderId>;  // a score
  struct Sight {
    bool front = false, back = false;
    double highest = 0.0, lowest = 0.0;  // of N . E over the cell
    double squared_distance = 0.0;
  };

  Sight sightOf(const Candidate& candidate) const;
  double boundOf(const CandidateTree::Node& node) const;
  double boundOf(const Candidate& candidate) const;
  double scoreAlong(const Vec3d& direction, const Candidate& candidate, const Sight& sight) const;
  double minDotInCone(const Vec3d& from_cell, double radius) const;
  void push(const Entry& entry);
  void open(std::uint32_t node);
  void take(const Candidate& candidate, double bound);
  void insert(const Ranked& entry, std::vector<Ranked>& list) const;

  const CandidateTree& tree_;
  const occluders::SphereDirections& directions_;
  ListSettings settings_;
  double cos_cone_ = 0.0, sin_cone_ = 0.0;          // of the half angle in which occluders count
  double cos_covering_ = 0.0, sin_covering_ = 0.0;  // of the directions' covering angle

  Cell cell_;
  std::vector<Entry> queue_;               // a heap
  std::vector<std::uint32_t> open_;        // directions whose lists may still change
  std::vector<std::vector<Ranked>> best_;  // by direction: a heap, the worst on top
};

}  // namespace sightline::occluders
