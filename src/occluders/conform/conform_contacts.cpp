// Based on: O. Devillers and P. Guigue. Faster triangle-triangle intersection tests. INRIA report 4488, 2002:
// where the edges of one triangle pass the other follows from orientations of given points alone. Differs
// from the paper in that touching is told from crossing, and common vertices are known to be common.

#include "src/occluders/conform/conform_contacts.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "src/math/longest_axis.h"

namespace sightline::occluders {
namespace {

using geometry::Lattice;
using geometry::orientation;

constexpr int kNext[3] = {1, 2, 0};

// A triangle's number, and the numbers and places of its corners.
struct Corner3 {
  Corner3(const ConformScene& scene, std::uint32_t triangle) : number(triangle) {
    for (int k = 0; k < 3; ++k) {
      id[k] = scene.corners(triangle)[k];
      at[k] = scene.vertices[id[k]];
    }
  }
  std::uint32_t number;
  std::uint32_t id[3];
  Vec3d at[3];
};

struct Facing {
  int axis = -1;  // along which the normal is not zero
  int sign = 0;   // of the normal along it; 0 for triangles without area
};

Facing facingOf(const Lattice& lattice, const Vec3d (&at)[3]) {
  const Vec3d normal = abs(cross(at[1] - at[0], at[2] - at[0]));
  Facing facing;
  facing.axis = math::longestAxis(normal);
  facing.sign = orientation(lattice, facing.axis, at[0], at[1], at[2]);
  if (facing.sign == 0) {  // too thin to tell by rounded numbers
    facing.axis = geometry::longestAxis(lattice, {at[0], at[1], at[2]});
    facing.sign = facing.axis < 0 ? 0 : orientation(lattice, facing.axis, at[0], at[1], at[2]);
  }
  return facing;
}

// A common point of two triangles, and where it lies in each.
struct Meeting {
  PointName name;
  Borders in[2];
};

// The at most two ends of what is common.
struct Meetings {
  void add(const PointName& name, Borders in_a, Borders in_b) {
    if (count < 2) {
      at[count] = {name, {in_a, in_b}};
    }
    ++count;
  }
  int count = 0;
  Meeting at[2];
};

PointName vertexName(std::uint32_t vertex) {
  return {PointName::Kind::kVertex, 0, {vertex, 0, 0, 0}};
}

class Pair {
 public:
  Pair(const ConformScene& scene, const ConformSettings& settings, std::uint32_t a, std::uint32_t b,
       std::vector<Contact>& contacts, ContactCounts& counts)
      : lattice_(scene.lattice),
        settings_(settings),
        t_{{scene, a}, {scene, b}},
        contacts_(contacts),
        counts_(counts) {
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) {
        if (t_[0].id[k] == t_[1].id[m]) {
          same_[0][k] = m;
          same_[1][m] = k;
          ++common_;
        }
      }
    }
  }

  void meet() {
    if (common_ == 3 || clear(1)) {
      return;
    }
    const bool flat = side_[1][0] == 0 && side_[1][1] == 0 && side_[1][2] == 0;
    if (flat) {
      meetInPlane();
    } else if (!clear(0)) {
      meetAcross();
    }
  }

 private:
  // Finds the sides of the other's plane on which the corners of a triangle lie, and whether it has no more
  // than common corners in that plane, and the rest on one side.
  bool clear(int which) {
    const Corner3 &t = t_[which], &plane = t_[1 - which];
    bool front = false, back = false, touches = false;
    for (int k = 0; k < 3; ++k) {
      int& side = side_[which][k];
      side = same_[which][k] >= 0 ? 0 : orientation(lattice_, plane.at[0], plane.at[1], plane.at[2], t.at[k]);
      front = front || side > 0;
      back = back || side < 0;
      touches = touches || (side == 0 && same_[which][k] < 0);
    }
    return front != back && !touches;
  }

  // Where a point of a triangle's plane lies in it; false if outside.
  bool locate(int which, const Facing& facing, const Vec3d& point, Borders& borders) const {
    borders = 0;
    for (int k = 0; k < 3; ++k) {
      const int side =
          facing.sign * orientation(lattice_, facing.axis, t_[which].at[k], t_[which].at[kNext[k]], point);
      if (side < 0) {
        return false;
      }
      borders |= static_cast<Borders>((side == 0 ? 1 : 0) << k);
    }
    return true;
  }

  // Corners of one triangle that lie in the other one.
  void addCorners(int which, Meetings& meetings) const {
    Facing facing;
    for (int k = 0; k < 3; ++k) {
      const int m = same_[which][k];
      Borders other = 0;
      if (m >= 0) {
        if (which == 0) {  // once
          meetings.add(vertexName(t_[0].id[k]), kBordersOfCorner[k], kBordersOfCorner[m]);
        }
      } else if (side_[which][k] == 0) {
        if (facing.axis < 0) {
          facing = facingOf(lattice_, t_[1 - which].at);
        }
        if (locate(1 - which, facing, t_[which].at[k], other)) {
          meetings.add(vertexName(t_[which].id[k]), which == 0 ? kBordersOfCorner[k] : other,
                       which == 0 ? other : kBordersOfCorner[k]);
        }
      }
    }
  }

  // Places where an edge of one triangle passes through the other one, but not through its corners. crossed:
  // edges of both that are known to cross each other, bit 3 k + m for edge k of the first and m of the second
  // triangle.
  void addPiercings(int which, std::uint32_t& crossed, Meetings& meetings) const {
    const Corner3 &t = t_[which], &face = t_[1 - which];
    for (int k = 0; k < 3; ++k) {
      if (side_[which][k] * side_[which][kNext[k]] >= 0) {
        continue;
      }
      bool left = false, right = false;
      Borders other = 0;
      for (int m = 0; m < 3; ++m) {
        const int turn = orientation(lattice_, t.at[k], t.at[kNext[k]], face.at[m], face.at[kNext[m]]);
        left = left || turn > 0;
        right = right || turn < 0;
        other |= static_cast<Borders>((turn == 0 ? 1 : 0) << m);
      }
      if ((left && right) || std::popcount(other) >= 2) {
        continue;
      }
      if (other != 0) {
        const int m = std::countr_zero(other);
        const std::uint32_t bit = 1u << (which == 0 ? 3 * k + m : 3 * m + k);
        if ((crossed & bit) != 0) {
          continue;
        }
        crossed |= bit;
      }
      const auto own = static_cast<Borders>(1 << k);
      meetings.add({PointName::Kind::kLineAndPlane, 0, {t.id[k], t.id[kNext[k]], face.number, 0}},
                   which == 0 ? own : other, which == 0 ? other : own);
    }
  }

  // Triangles of two planes have a point or a segment in common, or nothing.
  void meetAcross() {
    Meetings meetings;
    std::uint32_t crossed = 0;
    for (const int which : {0, 1}) {
      addCorners(which, meetings);
    }
    for (const int which : {0, 1}) {
      addPiercings(which, crossed, meetings);
    }
    const bool line = meetings.count >= 2;
    const bool edge_0 = line && (meetings.at[0].in[0] & meetings.at[1].in[0]) != 0;
    const bool edge_1 = line && (meetings.at[0].in[1] & meetings.at[1].in[1]) != 0;
    if (line && !edge_0 && !edge_1 && settings_.divide == Divide::kFaces) {
      emitBorders(meetings);
      return;
    }
    bool added = false;
    for (const int which : {0, 1}) {
      added = emit(which, meetings, Contact::Kind::kAlongPlane, {t_[1 - which].number, 0}) || added;
    }
    if (added) {
      ++(!line              ? counts_.points
         : edge_0 && edge_1 ? counts_.edges_on_edges
         : edge_0 || edge_1 ? counts_.edges_in_faces
                            : counts_.penetrations);
    }
  }

  // Sides of the other triangle's edges on which the corners of a triangle of the same plane lie.
  struct Sides {
    int of[3][3];        // by edge of the other, then corner; 1 is inside
    bool inside[3];      // of the closed triangle, by corner
    Borders borders[3];  // of the other, by corner
  };

  Sides sidesOf(int which, const Facing& facing, int sign) const {
    const Corner3 &t = t_[which], &other = t_[1 - which];
    Sides sides{};
    for (int m = 0; m < 3; ++m) {
      sides.inside[m] = true;
      for (int k = 0; k < 3; ++k) {
        const bool end = same_[which][m] == k || same_[which][m] == kNext[k];
        const int side =
            end ? 0 : sign * orientation(lattice_, facing.axis, other.at[k], other.at[kNext[k]], t.at[m]);
        sides.of[k][m] = side;
        sides.inside[m] = sides.inside[m] && side >= 0;
        sides.borders[m] |= static_cast<Borders>((side == 0 ? 1 : 0) << k);
      }
    }
    return sides;
  }

  // Whether an edge of the other triangle has all corners outside or, if they are common, on it.
  bool parted(int which, const Sides& sides) const {
    for (int k = 0; k < 3; ++k) {
      bool outside = true;
      for (int m = 0; m < 3; ++m) {
        outside = outside && (sides.of[k][m] < 0 || (sides.of[k][m] == 0 && same_[which][m] >= 0));
      }
      if (outside) {
        return true;
      }
    }
    return false;
  }

  void meetInPlane() {
    const Facing facing = facingOf(lattice_, t_[0].at);
    const int sign_1 = orientation(lattice_, facing.axis, t_[1].at[0], t_[1].at[1], t_[1].at[2]);
    // Corners of each triangle, and the edges of the other one.
    const Sides sides[2] = {sidesOf(0, facing, sign_1), sidesOf(1, facing, facing.sign)};
    if (parted(0, sides[0]) || parted(1, sides[1])) {
      return;
    }
    bool added = false;
    for (const int which : {0, 1}) {
      for (int m = 0; m < 3; ++m) {
        added = meetEdge(which, m, sides, facing.axis) || added;
      }
    }
    if (added) {
      bool apart = false;  // has an edge with nothing on its inner side
      for (const int which : {0, 1}) {
        for (int k = 0; k < 3; ++k) {
          apart =
              apart || std::all_of(sides[which].of[k], sides[which].of[k] + 3, [](int s) { return s <= 0; });
        }
      }
      ++(apart ? counts_.edges_on_edges : counts_.overlaps);
    }
  }

  // What an edge of one triangle has in common with the other one, for the latter.
  bool meetEdge(int which, int edge, const Sides (&sides)[2], int axis) {
    const int face = 1 - which, end = kNext[edge];
    const Corner3 &t = t_[which], &other = t_[face];
    const auto own = static_cast<Borders>(1 << edge);
    Meetings meetings;
    const auto add = [&](const PointName& name, Borders in_t, Borders in_face) {
      meetings.add(name, which == 0 ? in_t : in_face, which == 0 ? in_face : in_t);
    };
    for (const int corner : {edge, end}) {
      if (sides[which].inside[corner]) {
        add(vertexName(t.id[corner]), kBordersOfCorner[corner], sides[which].borders[corner]);
      }
    }
    for (int k = 0; k < 3; ++k) {
      const int corner = same_[face][k];
      if (corner != edge && corner != end && sides[face].of[edge][k] == 0 && sides[face].inside[k]) {
        add(vertexName(other.id[k]), own, kBordersOfCorner[k]);
      }
      if (sides[which].of[k][edge] * sides[which].of[k][end] < 0 &&
          sides[face].of[edge][k] * sides[face].of[edge][kNext[k]] < 0) {
        add({PointName::Kind::kLines,
             static_cast<std::uint8_t>(axis),
             {t.id[edge], t.id[end], other.id[k], other.id[kNext[k]]}},
            own, static_cast<Borders>(1 << k));
      }
    }
    return emit(face, meetings, Contact::Kind::kAlongEdge, {t.id[edge], t.id[end]});
  }

  // Adds what meetings mean for one of the triangles; false if nothing.
  bool emit(int which, const Meetings& meetings, Contact::Kind kind, std::array<std::uint32_t, 2> along) {
    const Meeting *first = &meetings.at[0], *second = &meetings.at[1];
    const std::uint32_t number = t_[which].number;
    const bool only_edges = settings_.divide == Divide::kEdges;
    if (meetings.count >= 2 && (first->in[which] & second->in[which]) == 0 && !only_edges) {
      contacts_.push_back(
          {number, kind, {first->in[which], second->in[which]}, {first->name, second->name}, along});
      return true;
    }
    bool added = false;
    for (int i = 0; i < std::min(meetings.count, 2); ++i) {
      const Meeting& meeting = meetings.at[i];
      const int borders = std::popcount(meeting.in[which]);
      if (only_edges ? borders == 1 && meeting.name.kind == PointName::Kind::kVertex : borders < 2) {
        contacts_.push_back({number, Contact::Kind::kPoint, {meeting.in[which], 0}, {meeting.name, {}}, {}});
        added = true;
      }
    }
    return added;
  }

  // Adds what penetrating triangles must know of each other although they are not divided along their common
  // segment: where borders of both meet. Other triangles at these borders may be divided there, for another
  // reason; then all are. Where an edge pierces a face, none of those at the edge is divided there: the face
  // and each of them penetrate each other.
  void emitBorders(const Meetings& meetings) {
    for (const Meeting& meeting : meetings.at) {
      if (meeting.in[0] != 0 && meeting.in[1] != 0) {
        Meetings one;
        one.add(meeting.name, meeting.in[0], meeting.in[1]);
        emit(0, one, Contact::Kind::kPoint, {});
        emit(1, one, Contact::Kind::kPoint, {});
      }
    }
  }

  const Lattice& lattice_;
  const ConformSettings& settings_;
  Corner3 t_[2];
  int same_[2][3] = {{-1, -1, -1}, {-1, -1, -1}};  // the other's corner that is the same vertex
  int common_ = 0;
  int side_[2][3] = {};
  std::vector<Contact>& contacts_;
  ContactCounts& counts_;
};

}  // namespace

bool hasArea(const ConformScene& scene, std::uint32_t triangle) {
  const Corner3 t(scene, triangle);
  return facingOf(scene.lattice, t.at).sign != 0;
}

void addContacts(const ConformScene& scene, const ConformSettings& settings, std::uint32_t a, std::uint32_t b,
                 std::vector<Contact>& contacts, ContactCounts& counts) {
  Pair(scene, settings, a, b, contacts, counts).meet();
}

}  // namespace sightline::occluders
