#pragma once

// Finds the edges of objects. Corners at the same place are merged and edges cut at T-junctions.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/drawing/feature_edges.h"
#include "src/occluders/conform/conform_pairs.h"

namespace sightline::drawing {

class EdgeBuilder {
 public:
  explicit EdgeBuilder(const SceneView& scene);
  // Appends the object's edges.
  void add(const Object& object, FeatureEdges& edges);

 private:
  struct HalfEdge {
    std::uint32_t a = 0, b = 0;  // merged corners, a < b
    std::uint32_t first_index = 0;
    bool along = true;
  };
  struct OnEdge {
    double share = 0.0;
    std::uint32_t corner = 0;
  };
  static bool before(const HalfEdge& x, const HalfEdge& y);

  void weld(std::span<const std::uint32_t> indices);
  void gather(const Object& object);
  void addHalfEdge(std::uint32_t from, std::uint32_t to, std::uint32_t first_index);
  bool hasArea(const std::array<std::uint32_t, 3>& corners) const;
  void cutAtCorners();
  void findCornersOn(const HalfEdge& edge);
  void store(FeatureEdges& edges) const;

  Vec3d at(std::uint32_t corner) const { return Vec3d(scene_.positions[corner]); }

  const SceneView& scene_;
  double tolerance_ = 0.0;                 // metres
  std::vector<std::uint32_t> stands_for_;  // each position's merged corner; valid for the object's positions
  std::vector<std::uint32_t> corners_;     // the object's merged corners, each once
  std::optional<occluders::BoxPairs> boxes_;  // of corners_; empty until it is needed
  std::vector<HalfEdge> half_edges_, cut_;
  std::vector<OnEdge> on_edge_;
};

}  // namespace sightline::drawing
