#pragma once

// Which surfaces are drawn in a view, and how they appear in a depth buffer.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/occlusion/surfaces/box_extents.h"
#include "src/occlusion/surfaces/depth_target.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// A chosen cluster as it appears in the buffer.
struct ClusterImage {
  std::uint32_t cluster = 0;
  std::int32_t sign = 0;  // 1: as it is; -1: with its other side
  bool cut = false;       // by the near plane
  bool flat = false;      // `depth` is about as good as those of its triangles
  PixelRectangle rectangle;
  DepthBound depth;
};

// The side of a patch that all of it shows to the eye.
struct PatchSide {
  std::int32_t side = 0;  // 1: its front; -1: its back; 0: neither is sure
  double travel = 0.0;    // it stays so until the eye has moved so far, metres
};
struct ShownPatch {
  std::uint32_t patch = 0;  // into SurfaceSet::patches
  std::int32_t side = 0;    // as in PatchSide
};

// A patch that may show its front.
struct PatchImage {
  std::uint32_t first = 0, count = 0;  // of its clusters in SurfaceView::clusters()
  PixelRectangle rectangle;
  float nearest = 0.0f;  // reciprocal depth, rounded up
  bool flat = false;     // `depth` is about as good as those of its clusters
  // Not 0: the patch is flat, not cut by the near plane, and all of it shows its front (1) or its other side
  // (-1). It may be drawn as a whole, without its clusters.
  std::int32_t sign = 0;
  double farthest = 0.0;    // depth, metres
  DepthBound depth;         // since setDepth() or addClusters()
  std::uint32_t patch = 0;  // into SurfaceSet::patches
};

// A part of a surface that may be drawn.
struct PartImage {
  std::uint32_t part = 0;
  PixelRectangle rectangle;
  float nearest = 0.0f;  // reciprocal depth, rounded up
};

class SurfaceView {
 public:
  // What surfaces nearer than this depth do is left out, metres.
  double clipDepth() const { return extents_.clipDepth(); }
  const scene::PixelView& view() const { return extents_.view(); }

  // min_pixels: parts with a smaller rectangle in the buffer are left out.
  void begin(const SurfaceSet& set, const scene::PixelView& view, double min_pixels,
             const DepthTarget& target);
  // Lists the parts of some objects, the nearest ones first.
  void listParts(std::span<const ObjectId> objects);
  // Lists these parts, in this order.
  void listParts(std::span<const std::uint32_t> parts);
  // What was listed last.
  std::span<const PartImage> parts() const { return parts_; }

  PatchSide sideOf(std::uint32_t patch) const;
  // Sets `images` to those of the patches that have so many pixels. They have neither clusters nor depths
  // yet.
  void imagesOf(std::span<const ShownPatch> patches, double min_pixels, std::vector<PatchImage>& images);
  // Finds how far away a patch is that may be drawn as a whole.
  void setDepth(PatchImage& image) const;
  // Appends the clusters of a patch that may show their fronts to clusters().
  void addClusters(const SurfacePatch& patch, PatchImage& image);
  // Appends these clusters to clusters(), so far as they may show their fronts.
  void addClusters(std::span<const std::uint32_t> numbers);
  std::span<const ClusterImage> clusters() const { return clusters_; }  // since begin()

  // Appends how far away the cluster is where it may appear.
  void addDepths(const ClusterImage& image, std::vector<PartDepth>& depths);

 private:
  void findCandidates(std::span<const ObjectId> objects);
  // Sets `images` to those of the candidates that are large enough, in their order.
  void imagesOfCandidates(std::vector<PartImage>& images);
  double smallestOf(const BoxExtent& object) const;
  void sortParts();
  bool chooseCluster(std::uint32_t number, const PixelBox& box, ClusterImage& image, double& farthest) const;
  // The bound of surfaces that lie before this plane and no farther away than `farthest`.
  DepthBound boundOf(const Plane& plane, double farthest) const;
  // size: the length of the normal, or more; at_eye: the plane's value at the eye.
  DepthBound boundOf(const Vec3d& normal, double at_eye, double size, double farthest) const;
  Plane behind(const Plane& support, double thickness, std::int32_t sign) const;

  const SurfaceSet* set_ = nullptr;
  BoxExtents extents_;
  DepthTarget target_;
  double min_pixels_ = 0.0;
  std::vector<ClusterImage> clusters_;
  std::vector<PartImage> parts_, unsorted_;
  std::vector<std::uint32_t> first_of_key_, candidates_;
  std::vector<ObjectId> objects_;
  std::vector<bool> listed_;  // by part: it is among candidates_
  std::vector<Box> boxes_;
  std::vector<PixelBox> images_;
};

}  // namespace sightline::occlusion
