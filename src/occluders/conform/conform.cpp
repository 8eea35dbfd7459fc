// Conforming: pairs of triangles whose boxes meet, what they have in common, the pieces of each triangle, and
// the new points as vertices.
//
// Based on: G. Cherchi, M. Livesu, R. Scateni, M. Attene. Fast and robust mesh arrangements using
// floating-point arithmetic. ACM Transactions on Graphics 39, 2020: contacts first, then each triangle alone.
// Differs from the paper in that a point is what its coordinates are, as exact numbers, and not what defines
// it; so points that coincide by chance are one point without further ado. And in that triangles are divided
// by a sweep, which treats coplanar triangles alike.

#include "src/occluders/conform/conform.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "sightline/math/box.h"
#include "src/base/parts.h"
#include "src/base/rows.h"
#include "src/math/outer_box.h"
#include "src/occluders/conform/close_cracks.h"
#include "src/occluders/conform/conform_contacts.h"
#include "src/occluders/conform/conform_pairs.h"
#include "src/occluders/conform/conform_split.h"

namespace sightline::occluders {
namespace {

using geometry::Lattice;

enum class Role : std::uint8_t { kTaking, kUntouched, kDegenerate };  // part in contacts, or why not

constexpr std::uint32_t kSplitsOfPart = 64;
constexpr std::uint32_t kNone = 0xffffffffu;

class Conforming {
 public:
  Conforming(const ConformInput& input, const ConformSettings& settings, const ParallelFor& parallel_for)
      : scene_{input.vertices, input.triangles, {}},
        count_(static_cast<std::uint32_t>(input.triangles.size() / 3)),
        settings_(settings),
        parallel_for_(parallel_for) {}

  ConformedMesh run() {
    assignRoles();
    findContacts();
    splitTriangles();
    mergePoints();
    assemble();
    return std::move(mesh_);
  }

 private:
  void assignRoles() {
    std::vector<std::uint8_t> vertex_allowed(scene_.vertices.size());
    for (std::size_t v = 0; v < scene_.vertices.size(); ++v) {
      vertex_allowed[v] = Lattice::allowed(scene_.vertices[v]) ? 1 : 0;
    }
    scene_.lattice = Lattice::of(scene_.vertices);
    roles_.resize(count_);
    base::forEach(parallel_for_, count_, [&](std::uint32_t t) {
      const std::uint32_t* corner = scene_.corners(t);
      roles_[t] = vertex_allowed[corner[0]] + vertex_allowed[corner[1]] + vertex_allowed[corner[2]] < 3
                      ? Role::kUntouched
                  : hasArea(scene_, t) ? Role::kTaking
                                       : Role::kDegenerate;
    });
    mesh_.untouched = static_cast<std::uint32_t>(std::count(roles_.begin(), roles_.end(), Role::kUntouched));
    mesh_.degenerate =
        static_cast<std::uint32_t>(std::count(roles_.begin(), roles_.end(), Role::kDegenerate));
  }

  void findContacts() {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t t = 0; t < count_; ++t) {
      if (roles_[t] == Role::kTaking) {
        numbers.push_back(t);
      }
    }
    std::vector<Box> boxes(numbers.size());
    base::forEach(parallel_for_, numbers.size(), [&](std::uint32_t i) {
      for (int k = 0; k < 3; ++k) {
        const Vec3d& at = scene_.vertices[scene_.corners(numbers[i])[k]];
        boxes[i].extend(math::outerBox(at, at));
      }
    });
    const BoxPairs pairs(boxes, numbers);
    std::vector<std::vector<Contact>> parts(pairs.partCount());
    std::vector<ContactCounts> counts(pairs.partCount());
    base::forEach(parallel_for_, pairs.partCount(), [&](std::uint32_t part) {
      pairs.forPairs(part, [&](std::uint32_t a, std::uint32_t b) {
        addContacts(scene_, settings_, std::min(a, b), std::max(a, b), parts[part], counts[part]);
      });
    });
    for (const ContactCounts& part : counts) {
      mesh_.contacts.points += part.points;
      mesh_.contacts.edges_on_edges += part.edges_on_edges;
      mesh_.contacts.edges_in_faces += part.edges_in_faces;
      mesh_.contacts.penetrations += part.penetrations;
      mesh_.contacts.overlaps += part.overlaps;
    }
    row_of_.assign(count_, kNone);
    for (const std::vector<Contact>& part : parts) {
      for (const Contact& contact : part) {
        row_of_[contact.triangle] = 0;
      }
    }
    for (std::uint32_t t = 0; t < count_; ++t) {
      if (row_of_[t] != kNone) {
        row_of_[t] = static_cast<std::uint32_t>(touched_.size());
        touched_.push_back(t);
      }
    }
    contacts_.group(touched_.size(), [&](auto&& pair) {
      for (const std::vector<Contact>& part : parts) {
        for (const Contact& contact : part) {
          pair(row_of_[contact.triangle], contact);
        }
      }
    });
  }

  void splitTriangles() {
    pieces_.resize((touched_.size() + kSplitsOfPart - 1) / kSplitsOfPart);
    base::forEach(parallel_for_, pieces_.size(), [&](std::uint32_t part) {
      TriangleSplit split(settings_.most_contacts);
      const std::size_t end = std::min<std::size_t>(touched_.size(), (part + std::size_t{1}) * kSplitsOfPart);
      for (std::size_t i = part * std::size_t{kSplitsOfPart}; i < end; ++i) {
        split.split(scene_, touched_[i], contacts_[i], pieces_[part]);
      }
    });
    mesh_.divided = static_cast<std::uint32_t>(touched_.size());
    for (const Pieces& part : pieces_) {
      mesh_.overfull += part.overfull;
    }
  }

  // Numbers the new points: equal ones, which several triangles have, are one vertex.
  void mergePoints() {
    std::vector<const NewPoint*> points;
    first_point_.clear();
    for (const Pieces& part : pieces_) {
      first_point_.push_back(static_cast<std::uint32_t>(points.size()));
      for (const NewPoint& point : part.points) {
        points.push_back(&point);
      }
    }
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) {
      const NewPoint& p = *points[i];
      return std::tie(p.rounded.x, p.rounded.y, p.rounded.z, p.name);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    mesh_.vertices.assign(scene_.vertices.begin(), scene_.vertices.end());
    vertex_of_.resize(points.size());
    for (std::size_t i = 0; i < order.size();) {
      std::size_t end = i + 1;
      while (end < order.size() && points[order[end]]->rounded == points[order[i]]->rounded) {
        ++end;
      }
      mergeRun(points, std::span(order).subspan(i, end - i));
      i = end;
    }
  }

  // order: points that are rounded to the same place, by name.
  void mergeRun(std::span<const NewPoint* const> points, std::span<const std::uint32_t> order) {
    struct Found {
      const PointName* name;
      std::uint32_t vertex;
    };
    std::vector<Found> found;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const NewPoint& point = *points[order[i]];
      if (i > 0 && point.name == points[order[i - 1]]->name) {
        vertex_of_[order[i]] = vertex_of_[order[i - 1]];
        continue;
      }
      std::uint32_t vertex = kNone;
      if (!found.empty()) {
        const geometry::ExactPoint exact = exactPoint(scene_, point.name);
        for (const Found& other : found) {
          if (exactPoint(scene_, *other.name) == exact) {
            vertex = other.vertex;
          }
        }
      }
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(mesh_.vertices.size());
        found.push_back({&point.name, vertex});
        mesh_.vertices.push_back(point.rounded);
        mesh_.names.push_back(point.name);
        mesh_.slack = std::max(mesh_.slack, point.error);
      }
      vertex_of_[order[i]] = vertex;
    }
  }

  void assemble() {
    for (std::uint32_t t = 0; t < count_; ++t) {
      const std::uint32_t row = row_of_[t];
      if (roles_[t] == Role::kDegenerate) {
        continue;
      }
      if (row == kNone) {
        mesh_.triangles.insert(mesh_.triangles.end(), scene_.corners(t), scene_.corners(t) + 3);
        mesh_.source.push_back(t);
        continue;
      }
      const std::uint32_t part = row / kSplitsOfPart, place = row % kSplitsOfPart;
      const Pieces& pieces = pieces_[part];
      for (std::uint32_t i = place == 0 ? 0 : pieces.ends[place - 1]; i < pieces.ends[place]; ++i) {
        const std::uint32_t corner = pieces.corners[i];
        mesh_.triangles.push_back(corner < scene_.vertices.size()
                                      ? corner
                                      : vertex_of_[first_point_[part] + corner - scene_.vertices.size()]);
      }
      mesh_.source.resize(mesh_.triangles.size() / 3, t);
    }
  }

  ConformScene scene_;
  std::uint32_t count_;
  const ConformSettings settings_;
  const ParallelFor& parallel_for_;
  std::vector<Role> roles_;                 // by triangle
  std::vector<std::uint32_t> touched_;      // triangles with contacts, ascending
  std::vector<std::uint32_t> row_of_;       // by triangle: its place in touched_, or kNone
  base::Rows<Contact> contacts_;            // by touched triangle
  std::vector<Pieces> pieces_;              // by part of touched_
  std::vector<std::uint32_t> first_point_;  // by part: its first point in vertex_of_
  std::vector<std::uint32_t> vertex_of_;    // by point of all parts
  ConformedMesh mesh_;
};

}  // namespace

ConformedMesh conform(const ConformInput& input, const ConformSettings& settings,
                      const ParallelFor& parallel_for) {
  if (!(settings.crack_width > 0.0)) {
    return Conforming(input, settings, parallel_for).run();
  }
  const ClosedCracks closed = closeCracks(input, settings.crack_width, parallel_for);
  ConformedMesh mesh = Conforming({input.vertices, closed.triangles}, settings, parallel_for).run();
  for (std::uint32_t& source : mesh.source) {
    source = closed.source[source];
  }
  mesh.slack += closed.slack;
  return mesh;
}

}  // namespace sightline::occluders
