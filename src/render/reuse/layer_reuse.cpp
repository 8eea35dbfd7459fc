#include "sightline/render/layer_reuse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "src/render/reuse/layer_reuse_points.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace render;

namespace {

bool isFinite(const Mat4& m) {
  return std::all_of(m.m.begin(), m.m.end(), [](double v) { return std::isfinite(v); });
}

bool isFinite(const View& view) {
  return isFinite(clipFromScene(view)) && sightline::isFinite(view.eye);
}

bool areOfOneKind(const View& a, const View& b) {
  return a.orthographic == b.orthographic && a.z_near == b.z_near && a.z_far == b.z_far;
}

bool areEqual(const View& a, const View& b) {
  return areOfOneKind(a, b) && a.eye == b.eye && a.right == b.right && a.up == b.up &&
         a.forward == b.forward && a.tan_half_fovy == b.tan_half_fovy && a.ortho_height == b.ortho_height &&
         a.aspect == b.aspect && a.shift_x == b.shift_x && a.shift_y == b.shift_y;
}

// How far an object has turned between two transforms, about in radians; growing and shrinking count too. The
// object's own scale does not count: each of its axes is compared in proportion to its length. NaN where
// these lengths cannot be computed.
double turnBetween(const Mat4& a, const Mat4& b) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3d from(a(0, axis), a(1, axis), a(2, axis)), to(b(0, axis), b(1, axis), b(2, axis));
    if (!(from == to)) {
      sum += 2.0 * dot(to - from, to - from) / (dot(from, from) + dot(to, to));
    }
  }
  return std::sqrt(0.5 * sum);  // 2 sin(t / 2) for a turn by t
}

// The last image drawn of a layer, and what decides whether it can be reused.
struct KeptImage {
  View view;  // of the picture with its guard band
  bool peel = false;
  std::vector<Mat4> transforms;  // of the layer's objects when it was drawn
  LayerPoints layer;
  Sprite sprite;
  std::uint64_t drawn_in = 0, used_in = 0;  // frame numbers
};

struct FoundWarp {
  Warp frame_from_kept;  // between pictures with the guard band
  double error_px = 0.0;
};

}  // namespace

struct LayerReuse::Impl {
  Impl(const SceneView& scene, LayerRenderer& r, const ReuseSettings& s)
      : shapes(scene), renderer(&r), settings(s), transforms(scene.objects.size()) {
    const std::uint32_t max_guard = (std::min(r.width(), r.height()) - 1) / 2;
    settings.guard_px = std::min(settings.guard_px, max_guard);
    width = r.width() - 2 * settings.guard_px;
    height = r.height() - 2 * settings.guard_px;
  }

  View guardedView(const View& frame_view) const;
  bool takeObjects(std::span<const ObjectId> given);
  bool isPlaced() const;
  bool isVisible() const;
  bool hasMoved(const KeptImage& kept) const;
  bool hasTurned(const KeptImage& kept) const;
  bool isUsable(const KeptImage& kept, const LayerDraw& how) const;
  bool warpKept(const LayerDraw& how, LayerImage& image);
  bool matchPoints(const KeptImage& kept);
  bool suits(const Warp& frame_from_kept, const LayerPoints& layer) const;
  std::optional<FoundWarp> findWarp(const KeptImage& kept);
  void drawAnew(std::span<const ObjectId> given, const LayerDraw& how, LayerImage& image);
  void keep(bool peel);
  std::uint64_t triangles() const;

  LayerShapes shapes;
  LayerRenderer* renderer;
  ReuseSettings settings;
  std::uint32_t width = 0, height = 0;  // of the frames
  ReuseStats stats;

  // The current frame.
  std::uint64_t frame = 0;
  View view, guarded;
  bool is_view_finite = false;
  Frustum frustum;      // of the frame without the guard band
  PictureView picture;  // of the frame with the guard band
  std::vector<Mat4> transforms;

  std::map<std::vector<ObjectId>, KeptImage> kept_images;  // by each layer's objects, ascending

  // The current layer.
  std::vector<ObjectId> objects;  // ascending
  LayerImage drawn;               // its image with the guard band
  std::vector<PicturePoint> from, to;
};

// The view with the guard band; its middle shows the frame's picture, pixel by pixel.
View LayerReuse::Impl::guardedView(const View& frame_view) const {
  View wide = frame_view;
  const double across = static_cast<double>(renderer->width()) / width;
  const double upwards = static_cast<double>(renderer->height()) / height;
  wide.tan_half_fovy *= upwards;
  wide.ortho_height *= upwards;
  wide.aspect *= across / upwards;
  wide.shift_x /= across;
  wide.shift_y /= upwards;
  return wide;
}

// Sets `objects` to those of the layer, whole or in pieces. True if there are no pieces.
bool LayerReuse::Impl::takeObjects(std::span<const ObjectId> given) {
  bool are_whole = true;
  objects.clear();
  for (const ObjectId id : given) {
    objects.push_back(renderer->objectOf(id));
    are_whole = are_whole && objects.back() == id;
  }
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  std::erase_if(objects, [&](ObjectId object) { return object.value >= shapes.objects(); });
  return are_whole;
}

// Whether the view and the transforms of the layer's objects are finite.
bool LayerReuse::Impl::isPlaced() const {
  return is_view_finite && std::all_of(objects.begin(), objects.end(),
                                       [&](ObjectId object) { return isFinite(transforms[object.value]); });
}

bool LayerReuse::Impl::isVisible() const {
  return std::any_of(objects.begin(), objects.end(), [&](ObjectId object) {
    return shapes.isSeen(object, transforms[object.value], frustum);
  });
}

bool LayerReuse::Impl::hasMoved(const KeptImage& kept) const {
  bool has_moved = !areEqual(kept.view, guarded);
  for (std::size_t i = 0; i < objects.size() && !has_moved; ++i) {
    has_moved = kept.transforms[i].m != transforms[objects[i].value].m;
  }
  return has_moved;
}

bool LayerReuse::Impl::hasTurned(const KeptImage& kept) const {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!(turnBetween(kept.transforms[i], transforms[objects[i].value]) <= settings.max_turn)) {
      return true;
    }
  }
  return false;
}

// Whether the kept image can be reused, as far as this does not depend on its warp.
bool LayerReuse::Impl::isUsable(const KeptImage& kept, const LayerDraw& how) const {
  return how.peel == kept.peel && frame - kept.drawn_in < settings.max_frames &&
         areOfOneKind(kept.view, guarded);
}

// Sets `from` and `to` to the places of the characteristic points then and now. Points far outside the frame
// are left out. False if none is left, or if one cannot be projected.
bool LayerReuse::Impl::matchPoints(const KeptImage& kept) {
  constexpr double kOutside = 0.5;  // "far" as a share of the frame's size
  from.clear();
  to.clear();
  const double guard = settings.guard_px, w = width, h = height;
  for (std::size_t i = 0; i < kept.layer.points.size(); ++i) {
    const CharacteristicPoint& point = kept.layer.points[i];
    const std::optional<PicturePoint> now =
        picture.find(transformPoint(transforms[point.object.value], point.position));
    if (!now) {
      return false;
    }
    if (std::abs(now->x - guard - 0.5 * w) <= (0.5 + kOutside) * w &&
        std::abs(now->y - guard - 0.5 * h) <= (0.5 + kOutside) * h) {
      from.push_back(kept.layer.seen_at[i]);
      to.push_back(*now);
    }
  }
  return !from.empty();
}

// Whether the warp's inverse is defined all over the frame, no point is stretched too much, and the frame
// shows nothing that was outside the picture when it was drawn.
bool LayerReuse::Impl::suits(const Warp& frame_from_kept, const LayerPoints& layer) const {
  constexpr double kBeyond = 0.5;  // pixels beyond the picture that the sprite's margin still covers
  const std::optional<Warp> kept_from_frame = inverseOf(frame_from_kept);
  if (!kept_from_frame || std::any_of(from.begin(), from.end(), [&](PicturePoint p) {
        return !(largestStretch(frame_from_kept, p) <= settings.max_stretch);
      })) {
    return false;
  }
  const double guard = settings.guard_px;
  for (const std::uint32_t corner : {0u, 1u, 2u, 3u}) {
    const PicturePoint at{guard + (corner & 1u ? width : 0.0), guard + (corner & 2u ? height : 0.0)};
    const PicturePoint p = (*kept_from_frame)(at);
    if (!(kept_from_frame->divisor(at) > 0.0) || (layer.cut[kLeftSide] && !(p.x >= -kBeyond)) ||
        (layer.cut[kTopSide] && !(p.y >= -kBeyond)) ||
        (layer.cut[kRightSide] && !(p.x <= renderer->width() + kBeyond)) ||
        (layer.cut[kBottomSide] && !(p.y <= renderer->height() + kBeyond))) {
      return false;
    }
  }
  return true;
}

std::optional<FoundWarp> LayerReuse::Impl::findWarp(const KeptImage& kept) {
  if (!hasMoved(kept)) {
    return FoundWarp{};
  }
  const auto comes_into_view = [&](ObjectId object) {
    return shapes.isSeen(object, transforms[object.value], frustum);
  };
  if (!(settings.tolerance_px > 0.0) || kept.layer.cut_in_depth || hasTurned(kept) ||
      std::any_of(kept.layer.unseen.begin(), kept.layer.unseen.end(), comes_into_view) ||
      !matchPoints(kept)) {
    return std::nullopt;
  }
  for (const bool projective : {false, true}) {
    if (projective && settings.warp == ReuseWarp::kAffine) {
      break;
    }
    const std::optional<Warp> warp = projective ? fitProjective(from, to) : fitAffine(from, to);
    if (!warp) {
      continue;
    }
    const double error = largestDeviation(*warp, from, to);
    if (error <= settings.tolerance_px && suits(*warp, kept.layer)) {
      return FoundWarp{*warp, error};
    }
  }
  return std::nullopt;
}

// Warps the kept image. False if the layer must be drawn.
bool LayerReuse::Impl::warpKept(const LayerDraw& how, LayerImage& image) {
  const auto found = kept_images.find(objects);
  if (found == kept_images.end() || !isUsable(found->second, how)) {
    return false;
  }
  const std::optional<FoundWarp> warp = findWarp(found->second);
  const std::optional<Warp> kept_from_frame = warp ? inverseOf(warp->frame_from_kept) : std::nullopt;
  if (!kept_from_frame) {
    return false;
  }
  const double guard = settings.guard_px;
  const Warp guarded_from_frame{{1, 0, guard, 0, 1, guard, 0, 0, 1}};
  image.width = width;
  image.height = height;
  drawWarped(found->second.sprite, *kept_from_frame * guarded_from_frame, image);
  stats.largest_error_px = std::max(stats.largest_error_px, warp->error_px);
  found->second.used_in = frame;
  return true;
}

void LayerReuse::Impl::drawAnew(std::span<const ObjectId> given, const LayerDraw& how, LayerImage& image) {
  renderer->draw(guarded, given, how, drawn);
  image.clear(width, height);
  const bool has_depths = drawn.depths.size() == drawn.pixels.size();
  if (has_depths) {
    image.depths.resize(image.pixels.size());
  }
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t source = (y + settings.guard_px) * drawn.width + settings.guard_px;
    std::copy_n(drawn.pixels.begin() + static_cast<std::ptrdiff_t>(source), width,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(y * width));
    if (has_depths) {
      std::copy_n(drawn.depths.begin() + static_cast<std::ptrdiff_t>(source), width,
                  image.depths.begin() + static_cast<std::ptrdiff_t>(y * width));
    }
  }
}

// Keeps the image that was just drawn.
void LayerReuse::Impl::keep(bool peel) {
  KeptImage& kept = kept_images[objects];
  kept.view = guarded;
  kept.peel = peel;
  kept.transforms.clear();
  for (const ObjectId object : objects) {
    kept.transforms.push_back(transforms[object.value]);
  }
  kept.layer = shapes.pointsOf(objects, transforms, picture);
  cropSprite(drawn, {0, 0, drawn.width, drawn.height}, kept.layer.cut, kept.sprite);
  kept.drawn_in = kept.used_in = frame;
}

std::uint64_t LayerReuse::Impl::triangles() const {
  std::uint64_t sum = 0;
  for (const ObjectId object : objects) {
    sum += shapes.triangles(object);
  }
  return sum;
}

LayerReuse::LayerReuse(const SceneView& scene, LayerRenderer& renderer, const ReuseSettings& settings)
    : impl_(std::make_unique<Impl>(scene, renderer, settings)) {}
LayerReuse::~LayerReuse() = default;
LayerReuse::LayerReuse(LayerReuse&&) noexcept = default;
LayerReuse& LayerReuse::operator=(LayerReuse&&) noexcept = default;

void LayerReuse::beginFrame(const View& given_view, std::span<const Mat4> scene_from_stored) {
  Impl& r = *impl_;
  const View view = scene::withUnitAxes(given_view);
  r.renderer->setTransforms(scene_from_stored);
  std::fill(r.transforms.begin(), r.transforms.end(), Mat4{});
  std::copy_n(scene_from_stored.begin(), std::min(scene_from_stored.size(), r.transforms.size()),
              r.transforms.begin());
  r.view = view;
  r.guarded = r.guardedView(view);
  r.is_view_finite = isFinite(view);
  r.frustum = frustumOf(view);
  r.picture = PictureView(r.guarded, r.renderer->width(), r.renderer->height());
  std::erase_if(r.kept_images, [&](const auto& entry) { return entry.second.used_in < r.frame; });
  ++r.frame;
}

void LayerReuse::image(std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
  Impl& r = *impl_;
  const bool are_whole = r.takeObjects(objects);
  const bool is_placed = r.isPlaced();
  if (r.objects.empty() || (is_placed && !r.isVisible())) {
    image.clear(r.width, r.height);
    if (how.depths) {
      image.depths.assign(image.pixels.size(), LayerImage::kNoDepth);
    }
    return;
  }
  const std::uint64_t triangles = r.triangles();
  ++r.stats.layers;
  r.stats.triangles += triangles;
  // Points are projected from the eye, so images from other points of the lens are not reused. Images are
  // kept by their objects without an order, so those drawn in a given order are not reused either. What hides
  // a layer, and how its objects are cut into pieces, changes without the layer's objects.
  const bool is_reusable = is_placed && are_whole && !how.depths && !how.as_given && !how.hidden &&
                           how.lens.right == 0.0 && how.lens.up == 0.0;
  if (is_reusable && r.warpKept(how, image)) {
    return;
  }
  ++r.stats.drawn;
  r.stats.drawn_triangles += triangles;
  r.drawAnew(objects, how, image);
  if (is_reusable) {
    r.keep(how.peel);
  }
}

std::uint32_t LayerReuse::width() const {
  return impl_->width;
}
std::uint32_t LayerReuse::height() const {
  return impl_->height;
}
const ReuseStats& LayerReuse::stats() const {
  return impl_->stats;
}

}  // namespace sightline
