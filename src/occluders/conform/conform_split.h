#pragma once

// Divides one triangle along what it has in common with others.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/occluders/conform/conform_contacts.h"
#include "src/occluders/conform/conform_sweep.h"

namespace sightline::occluders {

// A new point, as one triangle has it; others have it again.
struct NewPoint {
  PointName name;
  Vec3d rounded;
  double error = 0.0;  // see geometry::ExactPoint
};

// The pieces of some triangles.
struct Pieces {
  std::vector<NewPoint> points;
  // By triangle, three for each piece: a vertex of the input, or that number of vertices and more for a new
  // point.
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> ends;  // by triangle: how many corners there are up to its last piece
  std::uint32_t overfull = 0;       // triangles of which only the borders are divided
};

// The point of a name, and what defines it.
geometry::ExactPoint exactPoint(const ConformScene& scene, const PointName& name);

// Divides triangles one at a time; keeps its storage.
class TriangleSplit {
 public:
  // most_contacts: see ConformSettings.
  explicit TriangleSplit(std::size_t most_contacts) : most_contacts_(most_contacts) {}

  // Appends the pieces of a triangle with area. contacts: all of its contacts, in any order. The pieces do
  // not depend on that order.
  void split(const ConformScene& scene, std::uint32_t triangle, std::span<const Contact> contacts,
             Pieces& pieces);

 private:
  // A segment between two ranks, and the plane or line in which it lies; see Contact.
  struct Segment {
    std::uint32_t low = 0, high = 0;
    Contact::Kind kind = Contact::Kind::kPoint;
    std::array<std::uint32_t, 2> along{};
  };
  struct NamedPlace {
    PointName name;
    Borders borders = 0;
    std::uint32_t use = 0;  // 2 i + k: end k of contact i
  };

  void placePoints(std::span<const Contact> contacts);
  void addPlace(const PointName& name, Borders borders);
  void rankPlaces();
  void makeSegments(std::span<const Contact> contacts);
  bool arrange(std::span<const Contact> contacts);
  bool crossSegments();
  PointName crossing(const Segment& a, const Segment& b) const;
  void makeEdges();
  void addEdges(std::uint32_t low, std::uint32_t high);
  void append(Pieces& pieces);
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  const geometry::ExactPoint& point(std::uint32_t rank) const { return points_[place_of_rank_[rank]]; }
  Borders bordersOf(std::uint32_t rank) const { return borders_of_rank_[rank]; }

  std::size_t most_contacts_;
  const ConformScene* scene_ = nullptr;
  std::vector<Contact> on_borders_;
  std::uint32_t triangle_ = 0;
  int axis_ = 0;  // of the triangle's plane, and the sign of its normal along it
  int sign_ = 0;
  // Places are the points by name, some of which may be the same point; ranks are different points in the
  // order of the sweep.
  std::vector<NamedPlace> named_;
  std::vector<std::uint32_t> place_of_end_;   // by 2 i + k
  std::vector<geometry::ExactPoint> points_;  // by place
  std::vector<PointName> names_;
  std::vector<Borders> borders_;
  std::vector<std::uint32_t> rank_, place_of_rank_;
  std::vector<Borders> borders_of_rank_;
  std::vector<Segment> segments_;
  // Segments of two ranks that cross at a place.
  struct Crossing {
    std::uint32_t segment = 0, place = 0;
  };
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> on_segment_;
  std::vector<PlaneSweep::Edge> edges_;
  std::vector<std::uint32_t> order_, triangles_, corner_of_rank_;
  PlaneSweep sweep_;
};

}  // namespace sightline::occluders
