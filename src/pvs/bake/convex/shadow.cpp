#include "src/pvs/bake/convex/shadow.h"

#include "sightline/geometry/tolerance.h"

// Why what is behind all planes is hidden. Take any faces F of a convex set, each with the eye in front of
// all its corners, and the closed loops of edges that bound F. Let x be strictly inside the planes through
// the eye and each edge of these loops. Seen along the line from the eye to x, each edge turns round the line
// the same way, so the loops wind round it, and the surface of F intersects it in a point y of some face,
// that is, of the convex set. If x is behind each face of F, y is between the eye and x, so x is hidden. This
// holds for any choice of F, and no face needs to be exactly flat: faces that the eye sees at a grazing angle
// are omitted.
//
// Both inset sets of a polygon must hide x. If the eye is over the inner side of an edge, the plane through
// the edge of the farther set is the stricter one, for all x behind the farther set; otherwise the plane of
// the nearer set is. If in doubt, both are used.
//
// Rounding, with u = 2^-53. A = edge - eye is known up to u |A| + 16 u size (inset corners are rounded), and
// its direction D up to u |D| + 32 u size. So D x A has an error of at most
//     16 u |A| |D| + 32 u size (|A| + |D|),
// This counts times |x - eye| <= reach, and the value of the plane at x adds 16 u |D x A| reach.

namespace sightline::pvs {
namespace {

constexpr double kRounding = 0x1p-48;  // 32 u

class ShadowMaker {
 public:
  ShadowMaker(const ConvexOccluder& occluder, const Vec3d& eye, double reach, Shadow& shadow)
      : size_(occluder.size), eye_(eye), reach_(reach), shadow_(shadow) {
    shadow_.eye = eye;
    shadow_.count = 0;
  }

  Vec3d fromEye(const Vec3d& point) const { return point - eye_; }
  // Rounding of the height of a point here above a plane with a unit normal.
  double heightRounding(const Vec3d& from_eye) const { return kRounding * (l1Norm(from_eye) + size_); }

  // Adds the plane through the eye and an edge; hidden points lie on its left as seen from the eye.
  void addEdge(const Vec3d& from_eye, const Vec3d& along) {
    const Vec3d normal = cross(along, from_eye);
    const double from_size = l1Norm(from_eye), along_size = l1Norm(along);
    const double rounding = l1Norm(normal) + from_size * along_size + size_ * (from_size + along_size);
    add(normal, kRounding * rounding * reach_);
  }
  // Requires x to be deeper than this along a unit normal.
  void addDepth(const Vec3d& normal, double depth) { add(normal, depth + kRounding * reach_); }

  // True if the planes fit and all of them are well-conditioned.
  bool done() const { return usable_ && shadow_.count > 0; }

 private:
  void add(const Vec3d& normal, double offset) {
    usable_ = usable_ && shadow_.count < kMaxShadowPlanes && offset > 0.0;
    if (usable_) {
      shadow_.nx[shadow_.count] = normal.x;
      shadow_.ny[shadow_.count] = normal.y;
      shadow_.nz[shadow_.count] = normal.z;
      shadow_.offset[shadow_.count++] = offset;
    }
  }

  double size_;
  Vec3d eye_;
  double reach_;
  Shadow& shadow_;
  bool usable_ = true;
};

bool shadowOfPolygon(const ConvexOccluders& all, const ConvexOccluder& occluder, ShadowMaker& maker) {
  const DrawnFace& face = all.facesOf(occluder).front();
  const Vec3d base = maker.fromEye(face.base);
  const double depth = dot(face.plane.normal, base), rounding = maker.heightRounding(base);
  const double min_depth = occluder.margin + face.max_height + rounding;
  if (!(depth < -min_depth || (occluder.double_sided && depth > min_depth))) {
    return false;
  }
  // The side that the eye is on, where edges run counter-clockwise.
  const double side = depth < 0.0 ? 1.0 : -1.0;
  const Vec3d outwards = face.plane.normal * side;
  maker.addDepth(-outwards, std::abs(depth) + occluder.margin + face.max_height + rounding);
  const Vec3d across = outwards * occluder.margin;
  for (const DrawnEdge& edge : all.edgesOf(occluder)) {
    const Vec3d from = maker.fromEye(edge.from), along = edge.along * side;
    const double over = -dot(cross(outwards, along), from);  // positive if the eye is over the inner side
    const double doubt = maker.heightRounding(from) * l1Norm(along);
    if (!(over < -doubt)) {
      maker.addEdge(from - across, along);
    }
    if (!(over > doubt)) {
      maker.addEdge(from + across, along);
    }
  }
  return maker.done();
}

bool shadowOfBody(const ConvexOccluders& all, const ConvexOccluder& occluder, ShadowMaker& maker) {
  std::uint32_t front = 0;  // bit i: the eye is clearly in front of face i
  const std::span<const DrawnFace> faces = all.facesOf(occluder);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const DrawnFace& face = faces[i];
    const Vec3d base = maker.fromEye(face.base);
    const double depth = -dot(face.plane.normal, base), rounding = maker.heightRounding(base);
    if (depth - face.max_height > rounding) {
      front |= 1u << i;
      maker.addDepth(-face.plane.normal, depth - face.min_height + rounding);
    }
  }
  for (const DrawnEdge& edge : all.edgesOf(occluder)) {
    const bool left = ((front >> edge.left) & 1u) != 0, right = ((front >> edge.right) & 1u) != 0;
    if (left != right) {
      maker.addEdge(maker.fromEye(edge.from), left ? edge.along : -edge.along);
    }
  }
  return front != 0 && maker.done();
}

}  // namespace

bool makeShadow(const ConvexOccluders& all, const ConvexOccluder& occluder, const Vec3d& eye, double reach,
                Shadow& shadow) {
  ShadowMaker maker(occluder, eye, reach, shadow);
  return occluder.body ? shadowOfBody(all, occluder, maker) : shadowOfPolygon(all, occluder, maker);
}

}  // namespace sightline::pvs
