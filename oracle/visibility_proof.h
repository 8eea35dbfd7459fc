#pragma once

// Decides whether an object, or its bounding box, is visible from a point, in exact arithmetic.
//
// The images of nearer opaque triangles are subtracted from the image of a triangle of the object. If nothing
// is left, the triangle is hidden; otherwise a ray through what is left reaches it. Embree proposes the
// triangles to subtract and the rays to try; what they prove is decided without rounding. A box around many
// triangles of the object is tried before each of them: if all directions to it are blocked before its
// nearest point, they are all hidden. An object's bounding box is visible if one of its sides is, or if a ray
// that starts on the near plane starts inside the box.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "oracle/exact_visibility.h"
#include "oracle/image_polygon.h"
#include "oracle/ray_scene.h"
#include "oracle/triangle_tree.h"

namespace sightline {

// A scene prepared for proofs. May be used from several threads.
struct ProofScene {
  explicit ProofScene(const SceneView& scene);

  ImageTriangle corners(std::uint32_t first_index) const;

  SceneView scene;
  TriangleTree tree;
  std::vector<std::uint32_t> same_position;  // of each position, the first that is equal to it
  int lowest_exponent = 0;                   // of all finite coordinates, those of bounding boxes too
};

// Proofs for one view. Not for several threads at once.
class VisibilityProof {
 public:
  // All three must outlive this object. The view must be as validate() returns it.
  VisibilityProof(const ProofScene& scene, const RayScene& rays, const View& view);

  // Gives up after about this many batches of rays.
  Decision decide(ObjectId object, std::uint32_t max_steps);
  // The same for the object's bounding box; see ExactVisibility::decideBoxes().
  Decision decideBox(ObjectId object, std::uint32_t max_steps);

  // True if the direction reaches the object before any opaque surface, in the view; ties count as visible.
  bool reaches(const Vec3d& point, ObjectId object);

 private:
  using Corner = ImageFigures::Corner;
  using Line = ImageFigures::Line;
  using Depth = ImageFigures::Depth;

  struct Triangle {
    std::uint32_t first_index = kNone;
    ObjectId object;  // several may have the same indices
    friend bool operator==(const Triangle&, const Triangle&) = default;
  };
  // A triangle as it appears in the image: on its side of these lines, borders included.
  struct Appearance {
    bool shown = false;  // its image has an area, and it is not a back face that is not drawn
    bool occludes = false;
    ImageRegion region;  // the cone of the triangle, from the near plane on
    Depth depth = 0;
    ImageRegion hides;  // see hiddenBy(); no lines: not yet asked for
  };
  // What is to be proved hidden.
  enum class TargetKind : std::uint8_t {
    kTriangle,    // of the object
    kSide,        // of the object's bounding box
    kDirections,  // all that is not before a depth, in the directions of a box around some of its triangles
  };
  struct Target {
    TargetKind kind = TargetKind::kDirections;
    ObjectId object;
    Depth depth = 0;
    std::uint32_t first_index = kNone;  // of a triangle
    ImageTriangle plane;                // of a triangle or side: three points of its plane
    double nearest = 0.0;               // of directions: the depth, metres
  };
  // A side of a bounding box as it appears in the image, from the near plane on.
  struct Side {
    bool shown = false;  // it is not seen edge on
    bool front = false;
    ImageTriangle plane;
    ImageRegion region;
    Depth depth = 0;
  };
  struct BoxImage {
    ImageRectangle extents;                // only if all corners lie before the eye
    bool before_the_eye = false;           // beyond rounding
    double nearest = 0.0, farthest = 0.0;  // depths, metres
  };
  enum class Cover : std::uint8_t { kHidden, kSeen, kOpen };

  void begin(std::uint32_t max_steps);
  Cover coverBox(const Box& box, ObjectId object);
  Cover coverTriangle(const Triangle& triangle);
  Cover coverSides(ObjectId object);
  Cover coverImage(const Target& target, ImageRegion region);
  Cover coverBorder(const Target& target, ImageRegion image);
  Cover coverPolygons(const Target& target);
  Cover coverPiece(const Target& target, const ImagePolygon& piece);
  Cover coverOutOfRaysReach(const Target& target, const ImagePolygon& piece);
  Cover coverTies(const Target& target, const ImagePolygon& inside, Line tie);
  Cover coverPoints(const Target& target, std::span<const Corner> points);
  Cover coverTie(const Target& target, Corner from, Corner to, Line tie);

  void beginFigures();
  void castRays(const ImagePolygon& piece);
  Cover findBlockers(const Target& target, const ImagePolygon& piece);
  bool isBefore(const RayHit& hit, const Target& target) const;
  Cover lookPastBlockers(const Target& target, const ImagePolygon& piece,
                         const std::array<bool, RayScene::kBatch>& blocked);
  void addBlocker(const Triangle& blocker);
  BoxImage imageOf(const Box& box) const;
  Appearance& appearance(const Triangle& triangle);
  Side side(std::uint32_t number);
  std::optional<Corner> directionIntoBox();
  void cutAtNear(ImageRegion& region, Depth depth);
  std::vector<Corner> cornersInPicture(ImageRegion region);
  const ImageRegion& hiddenBy(const Triangle& blocker, const Target& target);
  bool contains(const ImageRegion& region, Corner direction);
  bool isInside(const ImagePolygon& piece, Corner direction);
  Corner inside(const ImagePolygon& piece);
  std::optional<Triangle> blockerOf(const Target& target, Corner direction);
  Cover seenAt(const Target& target, Corner direction);
  bool seen(ObjectId object, Corner direction);
  Vec3d pointAt(const ImageTriangle& plane, Corner direction) const;
  Vec3d pointOnPlane(const ImageTriangle& plane, const Vec3d& direction) const;

  const ProofScene& scene_;
  const RayScene& rays_;
  std::array<Vec3f, 8> box_corners_{};  // of the bounding box that is decided
  ImageSpace space_;
  ImageFigures figures_;
  ImagePolygon picture_;
  Depth near_ = 0, far_ = 0;
  std::unordered_map<std::uint64_t, Appearance> appearances_;  // by triangleKey()
  std::vector<ImagePolygon> pieces_;                           // still to be covered
  std::vector<ImagePolygon> parts_, next_parts_;               // of one piece
  std::vector<RayHit> hits_;
  std::vector<Vec3d> directions_;  // of the rays that were cast last
  std::vector<Triangle> blockers_;
  std::optional<SeenPoint> witness_;
  std::uint32_t steps_ = 0, max_steps_ = 0;
};

}  // namespace sightline
