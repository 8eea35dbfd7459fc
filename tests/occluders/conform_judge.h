#pragma once

// Judges conformed triangles in rational numbers, by brute force and without any geometry of the library.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "src/occluders/conform/conform.h"
#include "tests/occluders/triangle_soup.h"

namespace sightline::test {

// Without expression templates, which take long to compile.
using Rational = boost::multiprecision::number<boost::multiprecision::cpp_rational::backend_type,
                                               boost::multiprecision::et_off>;

struct RationalVec {
  Rational x, y, z;

  RationalVec() = default;
  explicit RationalVec(const Vec3d& v) : x(v.x), y(v.y), z(v.z) {}
  RationalVec(Rational x_, Rational y_, Rational z_) : x(std::move(x_)), y(std::move(y_)), z(std::move(z_)) {}

  friend RationalVec operator+(const RationalVec& a, const RationalVec& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend RationalVec operator-(const RationalVec& a, const RationalVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend RationalVec operator*(const RationalVec& a, const Rational& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
  friend bool operator==(const RationalVec& a, const RationalVec& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

inline Rational dot(const RationalVec& a, const RationalVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline RationalVec cross(const RationalVec& a, const RationalVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline bool isZero(const RationalVec& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

using RationalTriangle = std::array<RationalVec, 3>;

inline RationalVec areaOf(const RationalTriangle& t) {  // twice
  return cross(t[1] - t[0], t[2] - t[0]);
}

class ConformJudge {
 public:
  ConformJudge(const Soup& soup, const occluders::ConformedMesh& mesh) : soup_(soup), mesh_(mesh) {
    for (const Vec3d& v : soup.vertices) {
      exact_.push_back(isFinite(v) ? RationalVec(v) : RationalVec());
    }
    for (const occluders::PointName& name : mesh.names) {
      exact_.push_back(positionOf(name));
    }
  }

  void judge() {
    judgeTiling();
    judgeMeetings();
  }

  // No vertex of the input lies on an edge at the border of a triangle, between its ends.
  void judgeBorders() {
    for (std::size_t i = 0; i < mesh_.source.size(); ++i) {
      const RationalTriangle whole = sourceOf(mesh_.source[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const RationalVec &a = exact_[pieceOf(i)[k]], &b = exact_[pieceOf(i)[(k + 1) % 3]];
        if (!onBorder(whole, a, b)) {
          continue;
        }
        for (const std::uint32_t v : mesh_.triangles) {
          const RationalVec &p = exact_[v], along = b - a;
          EXPECT_FALSE(isZero(cross(along, p - a)) && dot(along, p - a) > 0 && dot(along, b - p) > 0)
              << "vertex " << v << " on an edge of piece " << i;
        }
      }
    }
  }

  // As far as it holds whatever is divided.
  void judgeTiling() {
    ASSERT_EQ(mesh_.vertices.size(), soup_.vertices.size() + mesh_.names.size());
    ASSERT_EQ(mesh_.triangles.size(), 3 * mesh_.source.size());
    judgeRounding();
    judgePieces();
  }

 private:
  RationalTriangle triangleOf(std::span<const std::uint32_t> corners) const {
    return {exact_[corners[0]], exact_[corners[1]], exact_[corners[2]]};
  }
  RationalTriangle sourceOf(std::uint32_t number) const {
    return triangleOf(std::span(soup_.triangles).subspan(std::size_t{3} * number, 3));
  }
  std::span<const std::uint32_t> pieceOf(std::size_t piece) const {
    return std::span(mesh_.triangles).subspan(3 * piece, 3);
  }

  // Solves anew what a name says.
  RationalVec positionOf(const occluders::PointName& name) const {
    using Kind = occluders::PointName::Kind;
    const auto vertex = [&](int k) { return RationalVec(soup_.vertices[name.of[k]]); };
    if (name.kind == Kind::kLineAndPlane) {
      const RationalTriangle plane = sourceOf(name.of[2]);
      const RationalVec normal = areaOf(plane), from = vertex(0), along = vertex(1) - from;
      const Rational speed = dot(normal, along);
      EXPECT_NE(speed, 0);
      return from + along * (dot(normal, plane[0] - from) / speed);
    }
    if (name.kind == Kind::kLines) {
      const RationalVec p = vertex(0), d = vertex(1) - p, r = vertex(2), e = vertex(3) - r;
      const RationalVec normal = cross(d, e);
      EXPECT_FALSE(isZero(normal));
      const RationalVec at = p + d * (dot(cross(r - p, e), normal) / dot(normal, normal));
      EXPECT_TRUE(isZero(cross(at - r, e)));
      return at;
    }
    EXPECT_EQ(name.kind, Kind::kPlanes);
    RationalVec n[3];
    Rational offset[3];
    for (int k = 0; k < 3; ++k) {
      const RationalTriangle plane = sourceOf(name.of[k]);
      n[k] = areaOf(plane);
      offset[k] = dot(n[k], plane[0]);
    }
    const Rational volume = dot(n[0], cross(n[1], n[2]));
    EXPECT_NE(volume, 0);
    return (cross(n[1], n[2]) * offset[0] + cross(n[2], n[0]) * offset[1] + cross(n[0], n[1]) * offset[2]) *
           (1 / volume);
  }

  void judgeRounding() const {
    for (std::size_t v = soup_.vertices.size(); v < exact_.size(); ++v) {
      const RationalVec off = RationalVec(mesh_.vertices[v]) - exact_[v];
      EXPECT_LE(dot(off, off), Rational(mesh_.slack) * Rational(mesh_.slack));
    }
  }

  // The pieces of a triangle face as it does. Their edges cancel but for those on its border, so they cover
  // it equally often everywhere, and by their area, once.
  void judgePieces() const {
    std::map<std::uint32_t, std::vector<std::size_t>> pieces;
    for (std::size_t i = 0; i < mesh_.source.size(); ++i) {
      pieces[mesh_.source[i]].push_back(i);
    }
    for (std::uint32_t t = 0; t < soup_.count(); ++t) {
      if (!isJudged(t)) {
        continue;
      }
      const RationalTriangle whole = sourceOf(t);
      const RationalVec normal = areaOf(whole);
      if (isZero(normal)) {
        EXPECT_EQ(pieces.count(t), 0u) << "triangle " << t;
        continue;
      }
      RationalVec sum;
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> values;
      for (const std::size_t piece : pieces[t]) {
        const RationalVec area = areaOf(triangleOf(pieceOf(piece)));
        EXPECT_TRUE(isZero(cross(area, normal))) << "triangle " << t;
        EXPECT_GT(dot(area, normal), 0) << "triangle " << t;
        sum = sum + area;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = pieceOf(piece)[k], b = pieceOf(piece)[(k + 1) % 3];
          values[std::minmax(a, b)] += a < b ? 1 : -1;
        }
      }
      EXPECT_EQ(sum, normal) << "triangle " << t;
      for (const auto& [edge, value] : values) {
        EXPECT_TRUE(value == 0 || onBorder(whole, exact_[edge.first], exact_[edge.second]))
            << "triangle " << t;
      }
    }
  }

  static bool onBorder(const RationalTriangle& t, const RationalVec& a, const RationalVec& b) {
    for (std::size_t k = 0; k < 3; ++k) {
      const RationalVec along = t[(k + 1) % 3] - t[k];
      if (isZero(cross(along, a - t[k])) && isZero(cross(along, b - t[k]))) {
        return true;
      }
    }
    return false;
  }

  // Triangles of finite coordinates that the promise covers.
  bool isJudged(std::uint32_t t) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& v = soup_.vertices[soup_.triangles[std::size_t{3} * t + k]];
      for (const double c : {v.x, v.y, v.z}) {
        if (!(std::abs(c) < 0x1p64) || (c != 0.0 && std::abs(c) < 0x1p-149)) {
          return false;
        }
      }
    }
    return true;
  }

  struct Bounds {
    Vec3d low, high;
    bool meets(const Bounds& b) const {
      return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y &&
             low.z <= b.high.z && b.low.z <= high.z;
    }
  };
  Bounds boundsOf(std::span<const std::uint32_t> vertices) const {
    Bounds bounds{mesh_.vertices[vertices[0]], mesh_.vertices[vertices[0]]};
    for (const std::uint32_t v : vertices) {
      bounds.low = min(bounds.low, mesh_.vertices[v]);
      bounds.high = max(bounds.high, mesh_.vertices[v]);
    }
    const Vec3d margin{2.0 * mesh_.slack, 2.0 * mesh_.slack, 2.0 * mesh_.slack};
    return {bounds.low - margin, bounds.high + margin};
  }

  // No vertex lies inside an edge or a face, and no edge crosses another or a face.
  void judgeMeetings() const {
    std::set<std::uint32_t> used;
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<std::size_t> pieces;
    for (std::size_t i = 0; i < mesh_.source.size(); ++i) {
      if (isJudged(mesh_.source[i])) {
        pieces.push_back(i);
        for (std::size_t k = 0; k < 3; ++k) {
          used.insert(pieceOf(i)[k]);
          edges.insert(std::minmax(pieceOf(i)[k], pieceOf(i)[(k + 1) % 3]));
        }
      }
    }
    for (auto a = used.begin(); a != used.end(); ++a) {
      for (auto b = std::next(a); b != used.end(); ++b) {
        EXPECT_FALSE(mesh_.vertices[*a] == mesh_.vertices[*b] && exact_[*a] == exact_[*b]) << *a << ' ' << *b;
      }
    }
    for (const std::size_t piece : pieces) {
      const RationalTriangle t = triangleOf(pieceOf(piece));
      const Normal normal(areaOf(t));
      const Bounds bounds = boundsOf(pieceOf(piece));
      const RoundedPlane plane(mesh_, pieceOf(piece));
      for (const std::uint32_t v : used) {
        const std::array<std::uint32_t, 1> one{v};
        if (!isCorner(piece, v) && bounds.meets(boundsOf(one)) && plane.sideOf(mesh_.vertices[v]) == 0) {
          EXPECT_FALSE(dot(normal.exact, exact_[v] - t[0]) == 0 && inside(t, normal.exact, exact_[v]))
              << "vertex " << v << " in piece " << piece;
        }
      }
      for (const auto& [a, b] : edges) {
        const std::array<std::uint32_t, 2> ends{a, b};
        const int side = plane.sideOf(mesh_.vertices[a]);
        if (bounds.meets(boundsOf(ends)) && (side == 0 || plane.sideOf(mesh_.vertices[b]) != side)) {
          EXPECT_FALSE(crosses(piece, t, normal, a, b)) << "edge " << a << ' ' << b << ", piece " << piece;
        }
      }
    }
  }

  struct Normal {
    explicit Normal(const RationalVec& n)
        : exact(n), rounded(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)) {}
    RationalVec exact;
    Vec3d rounded;
  };

  // Spares rational numbers where rounded ones leave no doubt.
  struct RoundedPlane {
    RoundedPlane(const occluders::ConformedMesh& mesh, std::span<const std::uint32_t> corners)
        : origin(mesh.vertices[corners[0]]) {
      const Vec3d b = mesh.vertices[corners[1]], c = mesh.vertices[corners[2]];
      normal = sightline::cross(b - origin, c - origin);
      reach = std::max({maxComponent(abs(origin)), maxComponent(abs(b)), maxComponent(abs(c))});
      size = std::max(maxComponent(abs(b - origin)), maxComponent(abs(c - origin)));
    }
    // 0 if in doubt.
    int sideOf(const Vec3d& p) const {
      const double distance = sightline::dot(normal, p - origin);
      const double far = std::max(size, maxComponent(abs(p - origin)));
      const double doubt = 1e-12 * std::max(reach, maxComponent(abs(p))) * far * far;
      return distance > doubt ? 1 : distance < -doubt ? -1 : 0;
    }
    Vec3d origin, normal;
    double reach, size;
  };

  bool isCorner(std::size_t piece, std::uint32_t v) const {
    const std::span<const std::uint32_t> corners = pieceOf(piece);
    return std::find(corners.begin(), corners.end(), v) != corners.end();
  }
  static bool inside(const RationalTriangle& t, const RationalVec& normal, const RationalVec& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (dot(normal, cross(t[(k + 1) % 3] - t[k], p - t[k])) < 0) {
        return false;
      }
    }
    return true;
  }
  // An edge passes through a face or, in its plane, across one of its edges.
  bool crosses(std::size_t piece, const RationalTriangle& t, const Normal& normal, std::uint32_t a,
               std::uint32_t b) const {
    const Rational from = dot(normal.exact, exact_[a] - t[0]), to = dot(normal.exact, exact_[b] - t[0]);
    if (from.sign() * to.sign() < 0) {
      return inside(t, normal.exact, exact_[a] + (exact_[b] - exact_[a]) * (from / (from - to)));
    }
    if (from != 0 || to != 0) {
      return false;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t c = pieceOf(piece)[k], d = pieceOf(piece)[(k + 1) % 3];
      // Edges with a common end do not cross between their ends.
      if (a != c && a != d && b != c && b != d && side(normal, a, b, c) * side(normal, a, b, d) < 0 &&
          side(normal, c, d, a) * side(normal, c, d, b) < 0) {
        return true;
      }
    }
    return false;
  }

  // Whether r lies to the left of the line from p to q in the plane of a normal.
  int side(const Normal& normal, std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    const Vec3d at = mesh_.vertices[p], n = normal.rounded;
    const Vec3d along = mesh_.vertices[q] - at, to = mesh_.vertices[r] - at;
    const double rounded = sightline::dot(n, sightline::cross(along, to));
    const double far = std::max(maxComponent(abs(along)), maxComponent(abs(to)));
    const double doubt = 1e-12 * maxComponent(abs(n)) * far * (far + maxComponent(abs(at)));
    if (std::abs(rounded) > doubt) {
      return rounded > 0.0 ? 1 : -1;
    }
    return dot(normal.exact, cross(exact_[q] - exact_[p], exact_[r] - exact_[p])).sign();
  }

  const Soup& soup_;
  const occluders::ConformedMesh& mesh_;
  std::vector<RationalVec> exact_;  // by vertex of the mesh
};

}  // namespace sightline::test
