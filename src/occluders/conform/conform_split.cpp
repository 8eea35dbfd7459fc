#include "src/occluders/conform/conform_split.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sightline::occluders {

using geometry::ExactPoint;

ExactPoint exactPoint(const ConformScene& scene, const PointName& name) {
  const auto vertex = [&](int k) { return scene.vertices[name.of[k]]; };
  switch (name.kind) {
    case PointName::Kind::kVertex:
      return geometry::givenPoint(scene.lattice, vertex(0));
    case PointName::Kind::kLineAndPlane:
      return geometry::pointOfLine(scene.lattice, vertex(0), vertex(1), scene.planeOf(name.of[2]));
    case PointName::Kind::kLines:
      return geometry::pointOfLines(scene.lattice, name.axis, vertex(0), vertex(1), vertex(2), vertex(3));
    case PointName::Kind::kPlanes:
      break;
  }
  const geometry::PlanePoints planes[3] = {scene.planeOf(name.of[0]), scene.planeOf(name.of[1]),
                                           scene.planeOf(name.of[2])};
  return geometry::pointOfPlanes(scene.lattice, planes);
}

void TriangleSplit::split(const ConformScene& scene, std::uint32_t triangle,
                          std::span<const Contact> contacts, Pieces& pieces) {
  scene_ = &scene;
  triangle_ = triangle;
  const geometry::PlanePoints plane = scene.planeOf(triangle);
  axis_ = geometry::longestAxis(scene.lattice, plane);
  sign_ = geometry::orientation(scene.lattice, axis_, plane.a, plane.b, plane.c);
  if (!arrange(contacts)) {
    ++pieces.overfull;
    on_borders_.clear();
    for (const Contact& contact : contacts) {
      for (std::size_t k = 0; k < (contact.kind == Contact::Kind::kPoint ? 1u : 2u); ++k) {
        if (contact.borders[k] != 0) {
          on_borders_.push_back(
              {triangle, Contact::Kind::kPoint, {contact.borders[k], 0}, {contact.ends[k], {}}, {}});
        }
      }
    }
    arrange(on_borders_);
  }
  makeEdges();
  triangles_.clear();
  sweep_.triangulate(
      static_cast<std::uint32_t>(place_of_rank_.size()), edges_,
      [this](std::uint32_t a, std::uint32_t b, std::uint32_t c) { return turn(a, b, c); }, triangles_);
  append(pieces);
}

// Finds the points and segments of a triangle; false if it is overfull.
bool TriangleSplit::arrange(std::span<const Contact> contacts) {
  if (contacts.size() > most_contacts_) {
    const auto segment = [](const Contact& contact) { return contact.kind != Contact::Kind::kPoint; };
    if (std::any_of(contacts.begin(), contacts.end(), segment)) {
      return false;
    }
  }
  placePoints(contacts);
  rankPlaces();
  makeSegments(contacts);
  return crossSegments();
}

void TriangleSplit::addPlace(const PointName& name, Borders borders) {
  points_.push_back(exactPoint(*scene_, name));
  names_.push_back(name);
  borders_.push_back(borders);
}

// The first three places are the corners.
void TriangleSplit::placePoints(std::span<const Contact> contacts) {
  points_.clear();
  names_.clear();
  borders_.clear();
  const std::uint32_t* corner = scene_->corners(triangle_);
  for (int k = 0; k < 3; ++k) {
    addPlace({PointName::Kind::kVertex, 0, {corner[k], 0, 0, 0}}, kBordersOfCorner[k]);
  }
  named_.clear();
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    for (std::uint32_t k = 0; k < (contacts[i].kind == Contact::Kind::kPoint ? 1u : 2u); ++k) {
      named_.push_back({contacts[i].ends[k], contacts[i].borders[k], 2 * i + k});
    }
  }
  std::sort(named_.begin(), named_.end(),
            [](const NamedPlace& a, const NamedPlace& b) { return a.name < b.name; });
  place_of_end_.assign(2 * contacts.size(), 0);
  for (std::size_t i = 0; i < named_.size(); ++i) {
    if (i == 0 || named_[i].name != named_[i - 1].name) {
      addPlace(named_[i].name, named_[i].borders);
    }
    place_of_end_[named_[i].use] = static_cast<std::uint32_t>(points_.size() - 1);
  }
}

// Finds which places are the same point, and the order of the points.
void TriangleSplit::rankPlaces() {
  order_.resize(points_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int order = geometry::compareInPlane(axis_, points_[a], points_[b]);
    return order != 0 ? order < 0 : std::tie(names_[a], a) < std::tie(names_[b], b);
  });
  rank_.resize(points_.size());
  place_of_rank_.clear();
  borders_of_rank_.clear();
  for (const std::uint32_t place : order_) {
    // Vertices have the lowest names, so a point that is a vertex is named after it.
    if (place_of_rank_.empty() ||
        geometry::compareInPlane(axis_, points_[place_of_rank_.back()], points_[place]) != 0) {
      place_of_rank_.push_back(place);
      borders_of_rank_.push_back(0);
    }
    rank_[place] = static_cast<std::uint32_t>(place_of_rank_.size() - 1);
    borders_of_rank_.back() |= borders_[place];
  }
}

void TriangleSplit::makeSegments(std::span<const Contact> contacts) {
  segments_.clear();
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].kind != Contact::Kind::kPoint) {
      const auto [low, high] =
          std::minmax(place_of_end_[2 * i], place_of_end_[2 * i + 1],
                      [&](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
      segments_.push_back({low, high, contacts[i].kind, contacts[i].along});
    }
  }
}

int TriangleSplit::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  if ((bordersOf(a) & bordersOf(b) & bordersOf(c)) != 0) {
    return 0;
  }
  return geometry::orientation(axis_, point(a), point(b), point(c));
}

PointName TriangleSplit::crossing(const Segment& a, const Segment& b) const {
  const bool a_edge = a.kind == Contact::Kind::kAlongEdge, b_edge = b.kind == Contact::Kind::kAlongEdge;
  if (a_edge && b_edge) {
    return {PointName::Kind::kLines,
            static_cast<std::uint8_t>(axis_),
            {a.along[0], a.along[1], b.along[0], b.along[1]}};
  }
  if (a_edge || b_edge) {
    const Segment &edge = a_edge ? a : b, &plane = a_edge ? b : a;
    return {PointName::Kind::kLineAndPlane, 0, {edge.along[0], edge.along[1], plane.along[0], 0}};
  }
  PointName name{PointName::Kind::kPlanes, 0, {triangle_, a.along[0], b.along[0], 0}};
  std::sort(name.of, name.of + 3);
  return name;
}

// Finds where segments cross, and turns their ends into ranks; false if they cross too often.
bool TriangleSplit::crossSegments() {
  const auto toRanks = [&] {
    for (Segment& segment : segments_) {
      segment.low = rank_[segment.low];
      segment.high = rank_[segment.high];
    }
  };
  const auto toPlaces = [&] {
    for (Segment& segment : segments_) {
      segment.low = place_of_rank_[segment.low];
      segment.high = place_of_rank_[segment.high];
    }
  };
  toRanks();
  std::sort(segments_.begin(), segments_.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.low, a.high, a.kind, a.along) < std::tie(b.low, b.high, b.kind, b.along);
  });
  segments_.erase(
      std::unique(segments_.begin(), segments_.end(),
                  [](const Segment& a, const Segment& b) { return a.low == b.low && a.high == b.high; }),
      segments_.end());
  crossings_.clear();
  const std::size_t places = points_.size();
  const int v = (axis_ + 2) % 3;
  const auto across = [&](const Segment& s) {
    return std::minmax(point(s.low).rounded[v], point(s.high).rounded[v]);
  };
  for (std::uint32_t i = 0; i < segments_.size(); ++i) {
    const Segment& a = segments_[i];
    const std::pair<double, double> a_across = across(a);
    for (std::uint32_t k = i + 1; k < segments_.size() && segments_[k].low < a.high; ++k) {
      const Segment& b = segments_[k];
      const std::pair<double, double> b_across = across(b);
      if (a.low == b.low || a.high == b.high || b_across.first > a_across.second ||
          a_across.first > b_across.second || turn(a.low, a.high, b.low) * turn(a.low, a.high, b.high) >= 0 ||
          turn(b.low, b.high, a.low) * turn(b.low, b.high, a.high) >= 0) {
        continue;
      }
      if (crossings_.size() >= 2 * most_contacts_) {
        return false;
      }
      crossings_.push_back({i, static_cast<std::uint32_t>(names_.size())});
      crossings_.push_back({k, static_cast<std::uint32_t>(names_.size())});
      names_.push_back(crossing(a, b));
      borders_.push_back(0);
    }
  }
  if (names_.size() > places) {
    toPlaces();
    for (std::size_t place = places; place < names_.size(); ++place) {
      points_.push_back(exactPoint(*scene_, names_[place]));
    }
    rankPlaces();
    toRanks();
  }
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.segment, a.place) < std::tie(b.segment, b.place);
  });
  return true;
}

// Adds the edges between consecutive points of on_segment_ and its ends.
void TriangleSplit::addEdges(std::uint32_t low, std::uint32_t high) {
  on_segment_.push_back(high);
  std::sort(on_segment_.begin(), on_segment_.end());
  for (const std::uint32_t rank : on_segment_) {
    if (rank != low) {
      edges_.push_back({low, rank});
      low = rank;
    }
  }
}

// Divides the borders and the segments at all points that lie on them.
void TriangleSplit::makeEdges() {
  edges_.clear();
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({rank_[k], rank_[k == 2 ? 0 : k + 1]});
    on_segment_.clear();
    for (std::uint32_t rank = low + 1; rank < high; ++rank) {
      if ((bordersOf(rank) >> k & 1) != 0) {
        on_segment_.push_back(rank);
      }
    }
    addEdges(low, high);
  }
  const int v = (axis_ + 2) % 3;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < segments_.size(); ++i) {
    const Segment& segment = segments_[i];
    on_segment_.clear();
    for (; next < crossings_.size() && crossings_[next].segment == i; ++next) {
      on_segment_.push_back(rank_[crossings_[next].place]);
    }
    const std::size_t known = on_segment_.size();
    std::sort(on_segment_.begin(), on_segment_.end());
    const std::pair<double, double> across =
        std::minmax(point(segment.low).rounded[v], point(segment.high).rounded[v]);
    for (std::uint32_t rank = segment.low + 1; rank < segment.high; ++rank) {
      const double at = point(rank).rounded[v];
      if (bordersOf(rank) == 0 && at >= across.first && at <= across.second &&
          !std::binary_search(on_segment_.begin(), on_segment_.begin() + static_cast<std::ptrdiff_t>(known),
                              rank) &&
          turn(segment.low, segment.high, rank) == 0) {
        on_segment_.push_back(rank);
      }
    }
    addEdges(segment.low, segment.high);
  }
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
}

void TriangleSplit::append(Pieces& pieces) {
  corner_of_rank_.clear();
  for (const std::uint32_t place : place_of_rank_) {
    if (names_[place].kind == PointName::Kind::kVertex) {
      corner_of_rank_.push_back(names_[place].of[0]);
    } else {
      corner_of_rank_.push_back(static_cast<std::uint32_t>(scene_->vertices.size() + pieces.points.size()));
      pieces.points.push_back({names_[place], points_[place].rounded, points_[place].error});
    }
  }
  for (std::size_t i = 0; i < triangles_.size(); i += 3) {
    const std::uint32_t a = triangles_[i], b = triangles_[i + 1], c = triangles_[i + 2];
    pieces.corners.push_back(corner_of_rank_[a]);
    pieces.corners.push_back(corner_of_rank_[sign_ > 0 ? b : c]);
    pieces.corners.push_back(corner_of_rank_[sign_ > 0 ? c : b]);
  }
  pieces.ends.push_back(static_cast<std::uint32_t>(pieces.corners.size()));
}

}  // namespace sightline::occluders
