#include "oracle/region_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <unordered_map>
#include <utility>

#include "oracle/proof_mesh.h"
#include "oracle/region_hull.h"
#include "oracle/shaft.h"
#include "oracle/target_pieces.h"
#include "src/math/longest_axis.h"

namespace sightline {
namespace {

constexpr std::size_t kMostFaces = 256;     // of a body
constexpr std::size_t kMostMembers = 1024;  // of a surface
constexpr std::size_t kMostCandidates = 24;
constexpr std::size_t kMostLeftOut = 24;  // objects, when a surface is followed

}  // namespace

// One claim.
class RegionProof::Attempt {
 public:
  // target: a box around what is to be hidden of the claim's object.
  Attempt(const ProofMesh& mesh, const RegionClaim& claim, const DoubleBox& target)
      : mesh_(mesh), claim_(claim), eyes_(hullOf(claim.region)), target_(target) {
    if (eyes_.empty()) {
      return;
    }
    starts_ = startsIn(eyes_);
    ends_ = endsIn(target_);
    // Rounding may put a start a little outside of the hull, so what is proved is for a hull that has it.
    eyes_.insert(eyes_.end(), starts_.begin(), starts_.end());
    around_ = {eyes_[0], eyes_[0]};
    for (const Vec3d& eye : eyes_) {
      around_ = {min(around_.min, eye), max(around_.max, eye)};
    }
  }

  bool run() {
    if (eyes_.empty()) {
      return true;  // there is no eye
    }
    if (!std::all_of(eyes_.begin(), eyes_.end(), isNear) ||
        !mesh_.scene.objects[claim_.target.value].bounds.wellFormed() || !apart(around_, target_, 0.0)) {
      return false;
    }
    findCandidates();
    std::vector<std::uint32_t> bodies;
    for (const std::uint32_t t : candidates_) {
      const std::uint32_t body = mesh_.body_of[t];
      if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) {
        bodies.push_back(body);
        if (bodyHides(mesh_.bodies[body])) {
          return true;
        }
      }
    }
    if (candidates_.empty()) {
      return false;
    }
    const Shaft shaft(eyes_, target_);
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [&](std::uint32_t t) { return surfaceHides(t, shaft); });
  }

  bool refuted() const {
    // Only points of the box and of what the claim's region surely holds: the corners of a whole cell.
    if (!claim_.region.sides.empty() || !std::all_of(eyes_.begin(), eyes_.end(), isNear)) {
      return false;
    }
    const DoubleBox cell{claim_.region.min, claim_.region.max};
    for (std::uint32_t eye = 0; eye < 8; ++eye) {
      for (std::uint32_t i = 0; i < 8; ++i) {
        if (mesh_.misses(cell.corner(eye), target_.corner(i), claim_.by)) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  void findCandidates() {
    for (std::size_t line = 0; line < kSightLines; ++line) {
      const Vec3d from = starts_[line], to = ends_[line];
      mesh_.tree.alongRay(from, to - from, 0.0, [&](const TriangleTree::Node& leaf) {
        const auto found = mesh_.number_of.find(triangleKey(leaf.object, leaf.first_index));
        if (found == mesh_.number_of.end() || leaf.object == claim_.target ||
            (claim_.by.valid() && leaf.object != claim_.by)) {
          return;
        }
        if (candidates_.size() < kMostCandidates &&
            crossing(mesh_.triangles[found->second].at, from, to) != 0 &&
            std::find(candidates_.begin(), candidates_.end(), found->second) == candidates_.end()) {
          candidates_.push_back(found->second);
        }
      });
    }
  }

  // True if the whole body is behind a plane, and all eyes are before it by more than the near distance.
  bool separated(const ProofMesh::Body& body) const {
    DoubleBox box = boxOf(mesh_.triangles[body.triangles[0]].at);
    for (const std::uint32_t t : body.triangles) {
      const DoubleBox more = boxOf(mesh_.triangles[t].at);
      box = {min(box.min, more.min), max(box.max, more.max)};
    }
    if (apart(box, around_, claim_.near_distance)) {
      return true;
    }
    return std::any_of(body.triangles.begin(), body.triangles.end(), [&](std::uint32_t number) {
      const Corners& face = mesh_.triangles[number].at;
      const Vec3d n = cross(face.b - face.a, face.c - face.a);
      const double near = claim_.near_distance * length(n) * (1.0 + 1e-9);
      double farthest = -std::numeric_limits<double>::infinity();
      for (const std::uint32_t t : body.triangles) {
        for (const Vec3d& p : {mesh_.triangles[t].at.a, mesh_.triangles[t].at.b, mesh_.triangles[t].at.c}) {
          const Sign s = along(n, p, face.a);
          farthest = std::max(farthest, s.value + s.doubt);
        }
      }
      return std::all_of(eyes_.begin(), eyes_.end(), [&](const Vec3d& eye) {
        const Sign s = along(n, eye, face.a);
        return s.value - s.doubt - farthest > near;
      });
    });
  }

  bool bodyHides(const ProofMesh::Body& body) const {
    if (!body.closed || body.triangles.size() > kMostFaces || !separated(body)) {
      return false;
    }
    const std::size_t faces = body.triangles.size();
    const std::size_t ends = eyes_.size() + 8;
    std::vector<Sign> sides(faces * ends);
    for (std::size_t f = 0; f < faces; ++f) {
      for (std::size_t e = 0; e < ends; ++e) {
        const Vec3d p =
            e < eyes_.size() ? eyes_[e] : target_.corner(static_cast<std::uint32_t>(e - eyes_.size()));
        sides[f * ends + e] = sideOf(mesh_.triangles[body.triangles[f]].at, p);
      }
    }
    for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
      for (std::size_t end = eyes_.size(); end < ends; ++end) {
        // The places on the segment that are surely behind all planes, from 0 to 1.
        double low = 0.0, high = 1.0;
        for (std::size_t f = 0; f < faces; ++f) {
          const Sign& a = sides[f * ends + eye];
          const Sign& b = sides[f * ends + end];
          const double a_most = a.value + a.doubt, b_most = b.value + b.doubt;
          const bool a_behind = a_most < 0.0, b_behind = b_most < 0.0;
          if (!a_behind && !b_behind) {
            return false;
          }
          if (a_behind && b_behind) {
            continue;
          }
          // The greatest that the linear function may be is behind up to, or from, this place.
          const double place = a_most / (a_most - b_most);
          if (!std::isfinite(place)) {
            return false;
          }
          if (a_behind) {
            high = std::min(high, place - 0x1p-50);
          } else {
            low = std::max(low, place + 0x1p-50);
          }
        }
        if (!(low < high)) {
          return false;
        }
      }
    }
    return true;
  }

  bool allOn(const Corners& t, bool front, bool eyes) const {
    for (std::size_t i = 0; i < (eyes ? eyes_.size() : 8); ++i) {
      const Sign s = sideOf(t, eyes ? eyes_[i] : target_.corner(static_cast<std::uint32_t>(i)));
      if (!(front ? s.positive() : s.negative())) {
        return false;
      }
    }
    return true;
  }

  // True if all eyes are in front of the triangle's plane by more than the near distance.
  bool allFarBefore(const Corners& t) const {
    const double near = claim_.near_distance * length(cross(t.b - t.a, t.c - t.a)) * (1.0 + 1e-9);
    return std::all_of(eyes_.begin(), eyes_.end(), [&](const Vec3d& eye) {
      const Sign s = sideOf(t, eye);
      return s.value - s.doubt > near;
    });
  }

  // True if no line of sight begins or ends at the triangle while its ends move through the region and the
  // box: how often lines cross it does not change there.
  bool clearOfEnds(const Corners& t) const {
    const DoubleBox box = boxOf(t);
    const bool from_eyes =
        apart(box, around_, claim_.near_distance) || allOn(t, false, true) || allFarBefore(t);
    return from_eyes && (apart(box, target_, 0.0) || allOn(t, true, false) || allOn(t, false, false));
  }

  // Facts of a sheet that depend on the eyes, the target and the shaft alone, so that they hold for each
  // candidate and whatever is left out.
  struct SheetFacts {
    bool known = false;
    bool spoils = false;                 // a line of sight may begin or end at it
    std::array<bool, 3> misses_shaft{};  // by edge
    std::uint32_t last_surface = 0;      // number of the last one that it was found in
  };
  const SheetFacts& factsOf(std::uint32_t sheet, const Shaft& shaft) {
    SheetFacts& facts = sheets_[sheet];
    if (!facts.known) {
      const Corners at = mesh_.cornersOf(sheet);
      facts.known = true;
      facts.spoils = !clearOfEnds(at) && !shaft.isMissedBy(at);
      facts.misses_shaft = {shaft.isMissedBy(at.a, at.b), shaft.isMissedBy(at.b, at.c),
                            shaft.isMissedBy(at.c, at.a)};
    }
    return facts;
  }

  // Follows the surface of a triangle, again and again without the objects that kept it from being a proof:
  // any triangles may be left out of it.
  bool surfaceHides(std::uint32_t triangle, const Shaft& shaft) {
    std::vector<std::uint32_t> left_out{claim_.target.value};
    while (left_out.size() <= kMostLeftOut) {
      std::optional<std::uint32_t> spoiler;
      if (surfaceHides(triangle, shaft, left_out, spoiler)) {
        return true;
      }
      if (!spoiler || *spoiler == mesh_.triangles[triangle].object) {
        return false;
      }
      left_out.push_back(*spoiler);
    }
    return false;
  }

  // spoiler: set to an object, not yet left out, of which a triangle is too near or ends in the shaft, if
  // that is what is wrong.
  bool surfaceHides(std::uint32_t triangle, const Shaft& shaft, std::span<const std::uint32_t> left_out,
                    std::optional<std::uint32_t>& spoiler) {
    const ProofMesh::Triangle& t = mesh_.triangles[triangle];
    std::uint32_t start = 2 * triangle;
    if (sideOf(t.at, starts_[0]).negative()) {
      if (!t.double_sided) {
        return false;
      }
      start += 1;
    }
    surface_count_ += 1;
    sheets_[start].last_surface = surface_count_;
    std::vector<std::uint32_t> members{start};
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (members.size() > kMostMembers) {
        return false;
      }
      const SheetFacts& facts = factsOf(members[i], shaft);
      if (facts.spoils) {
        spoiler = mesh_.triangles[members[i] / 2].object;
        return false;
      }
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (facts.misses_shaft[k]) {
          continue;
        }
        const std::uint32_t partner = mesh_.partnerOf(members[i], k, left_out);
        if (partner == ProofMesh::kNoSheet) {
          spoiler = mesh_.triangles[members[i] / 2].object;
          return false;
        }
        if (std::exchange(sheets_[partner].last_surface, surface_count_) != surface_count_) {
          members.push_back(partner);
        }
      }
    }
    for (std::size_t line = 0; line < kSightLines; ++line) {
      int sum = 0;
      bool sure = true;
      for (const std::uint32_t sheet : members) {
        const std::optional<int> once = crossing(mesh_.cornersOf(sheet), starts_[line], ends_[line]);
        sure = sure && once.has_value();
        sum += once.value_or(0);
      }
      if (sure) {
        return sum > 0;
      }
    }
    return false;
  }

  const ProofMesh& mesh_;
  const RegionClaim& claim_;
  std::vector<Vec3d> eyes_;
  std::array<Vec3d, kSightLines> starts_{}, ends_{};
  DoubleBox target_, around_{};
  std::vector<std::uint32_t> candidates_;
  std::unordered_map<std::uint32_t, SheetFacts> sheets_;  // by number
  std::uint32_t surface_count_ = 0;
};

RegionProof::RegionProof(const SceneView& scene) : mesh_(std::make_unique<ProofMesh>(scene)) {}
RegionProof::~RegionProof() = default;
RegionProof::RegionProof(RegionProof&&) noexcept = default;
RegionProof& RegionProof::operator=(RegionProof&&) noexcept = default;

bool RegionProof::isEmpty(const EyeRegion& region) {
  return hullOf(region).empty();
}

DoubleBox RegionProof::boundsOf(ObjectId object) const {
  const Box& bounds = mesh_->scene.objects[object.value].bounds;
  return {Vec3d(bounds.min), Vec3d(bounds.max)};
}

bool RegionProof::proves(const RegionClaim& claim) const {
  return Attempt(*mesh_, claim, boundsOf(claim.target)).run();
}

bool RegionProof::provesInParts(const RegionClaim& claim, std::uint32_t divisions) const {
  return proves(claim) ||
         (divisions > 0 && provesHalves(claim, TargetPieces(mesh_->scene, claim.target), divisions));
}

bool RegionProof::provesPart(const RegionClaim& claim, const TargetPieces& target,
                             std::uint32_t divisions) const {
  return target.empty() || Attempt(*mesh_, claim, target.bounds()).run() ||
         (divisions > 0 && provesHalves(claim, target, divisions));
}

// Halves whatever is larger, the region or the box around the pieces.
bool RegionProof::provesHalves(const RegionClaim& claim, const TargetPieces& target,
                               std::uint32_t divisions) const {
  if (target.empty()) {
    return true;
  }
  const DoubleBox box = target.bounds();
  const Vec3d of_region = claim.region.max - claim.region.min, of_target = box.max - box.min;
  const bool halve_region = maxComponent(of_region) > maxComponent(of_target);
  const int axis = math::longestAxis(halve_region ? of_region : of_target);
  for (const bool high : {false, true}) {
    RegionClaim half = claim;
    if (halve_region) {
      const double middle = 0.5 * (claim.region.min[axis] + claim.region.max[axis]);
      (high ? half.region.min : half.region.max)[axis] = middle;
    }
    const double middle = 0.5 * (box.min[axis] + box.max[axis]);
    if (!provesPart(half, halve_region ? target : target.half(axis, middle, high), divisions - 1)) {
      return false;
    }
  }
  return true;
}

bool RegionProof::refutesObject(const RegionClaim& claim) const {
  return Attempt(*mesh_, claim, boundsOf(claim.target)).refuted();
}

bool RegionProof::misses(const Vec3d& from, const Vec3d& to, ObjectId object) const {
  return mesh_->misses(from, to, object);
}

}  // namespace sightline
