#include "tools/sightline/layers/layer_line_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "sightline/drawing/feature_edges.h"
#include "sightline/io/image.h"
#include "tools/sightline/command_line/output_files.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kFinest = 4;        // greatest number of fine pixels along each side of a pixel
constexpr std::uint32_t kMaxPixels = 8192;  // greatest width and height of LayerRenderer's pictures
constexpr double kRounding = 1e-6;          // relative to the depth, or to the far distance (orthographic)
constexpr double kEven = 0.25;              // changes that differ by less than this share belong to one plane

// Returns the greatest number of fine pixels along a side of a pixel that the renderer can draw.
std::uint32_t finenessFor(std::uint32_t width, std::uint32_t height) {
  return std::clamp(kMaxPixels / std::max({width, height, 1u}), 1u, kFinest);
}

// The reciprocal depth of the nearest surface at the centre of each fine pixel: 1 / depth or, in an
// orthographic view, -depth. It is linear in the picture over a plane.
class NearestSurfaces {
 public:
  // Takes over the image's depths.
  NearestSurfaces(const View& view, LayerImage& image)
      : width_(static_cast<int>(image.width)),
        height_(static_cast<int>(image.height)),
        orthographic_(view.orthographic),
        far_(view.z_far),
        reciprocal_depth_(std::move(image.depths)) {
    for (float& value : reciprocal_depth_) {
      value = static_cast<float>(reciprocalDepthOf(value));
    }
  }

  double reciprocalDepthOf(double depth) const { return orthographic_ ? -depth : 1.0 / depth; }

  // Whether the surfaces hide a point at x, y in fine pixels.
  bool hides(double x, double y, double reciprocal_depth) const {
    const double rounding = kRounding * (orthographic_ ? far_ : reciprocal_depth);
    const int left = static_cast<int>(std::floor(x - 0.5)), top = static_cast<int>(std::floor(y - 0.5));
    for (const int row : {top, top + 1}) {
      for (const int column : {left, left + 1}) {
        // There are no surfaces beyond the border.
        if (contains(column, row) && at(column, row) - slope(column, row) <= reciprocal_depth + rounding) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  double at(int x, int y) const {
    return reciprocal_depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                             static_cast<std::size_t>(x)];
  }
  // Returns by how much the surface's reciprocal depth changes within a fine pixel. It uses the steeper side
  // of those on which the surface continues evenly, since across an edge there is another slope or another
  // surface.
  double slope(int x, int y) const { return slopeAlong(x, y, 1, 0) + slopeAlong(x, y, 0, 1); }
  double slopeAlong(int x, int y, int dx, int dy) const {
    double steepest = 0.0;
    std::optional<double> min_change;  // for surfaces of one or two fine pixels
    for (const int sign : {-1, 1}) {
      const int u = x + sign * dx, v = y + sign * dy, far_u = u + sign * dx, far_v = v + sign * dy;
      if (!contains(far_u, far_v)) {
        continue;
      }
      const double change = at(u, v) - at(x, y), next = at(far_u, far_v) - at(u, v);
      if (std::abs(change - next) <= kEven * std::abs(change)) {
        steepest = std::max(steepest, std::abs(change));
      }
      min_change = std::min(min_change.value_or(std::abs(change)), std::abs(change));
    }
    const double change = steepest > 0.0 ? steepest : min_change.value_or(0.0);
    return std::isfinite(change) ? change : 0.0;
  }

  int width_, height_;
  bool orthographic_;
  double far_;
  std::vector<float> reciprocal_depth_;
};

// A point in camera space, sheared so that the middle of the picture is at x = y = 0. The unit of x and y is
// half the picture, at depth 1 unless the view is orthographic.
struct CameraPoint {
  double x = 0.0, y = 0.0, depth = 0.0;
};

CameraPoint cameraPoint(const View& view, const Vec3f& position) {
  const Vec3d from_eye = Vec3d(position) - view.eye;
  const double half = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  const double depth = dot(from_eye, view.forward), w = view.orthographic ? 1.0 : depth;
  return {dot(from_eye, view.right) / (half * view.aspect) - view.shift_x * w,
          dot(from_eye, view.up) / half - view.shift_y * w, depth};
}

CameraPoint between(const CameraPoint& a, const CameraPoint& b, double share) {
  return {std::lerp(a.x, b.x, share), std::lerp(a.y, b.y, share), std::lerp(a.depth, b.depth, share)};
}

// Clips a line to the view. Returns false if nothing is left or a number is not finite.
bool clip(const View& view, CameraPoint& a, CameraPoint& b) {
  // Distances from the planes of the view volume, positive inside.
  const auto distances = [&](const CameraPoint& p) {
    const double w = view.orthographic ? 1.0 : p.depth;
    return std::array{p.depth - view.z_near, view.z_far - p.depth, w - p.x, w + p.x, w - p.y, w + p.y};
  };
  const std::array at_a = distances(a), at_b = distances(b);
  double from = 0.0, to = 1.0;
  for (std::size_t i = 0; i < at_a.size(); ++i) {
    if (!(at_a[i] >= 0.0 || at_b[i] >= 0.0) || !std::isfinite(at_a[i] - at_b[i])) {
      return false;
    }
    const double zero = at_a[i] / (at_a[i] - at_b[i]);
    from = at_a[i] < 0.0 ? std::max(from, zero) : from;
    to = at_b[i] < 0.0 ? std::min(to, zero) : to;
  }
  if (from > to) {
    return false;
  }
  const CameraPoint start = between(a, b, from), end = between(a, b, to);
  a = start;
  b = end;
  return true;
}

Image whitePicture(std::uint32_t width, std::uint32_t height) {
  return {width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height, 255)};
}

std::uint64_t inkOf(const Image& picture) {
  std::uint64_t ink = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    ink += picture.rgba[i] == 0 ? 1 : 0;
  }
  return ink;
}

class LinePicture : public FrameMaker {
 public:
  LinePicture(const LayerDrawingOptions& options, const FrameMakerInput& input, LayerRenderer renderer)
      : file_(options.line_picture),
        features_(featuresOf(options)),
        input_(input),
        renderer_(std::move(renderer)) {
    const SceneView scene = input.input.moving.scene.view();
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      if (scene.materialOf(scene.objects[i]).opaque()) {
        opaque_.emplace_back(i);
      }
    }
  }

  Result<Json> make(const SortedFrame& frame) override {
    const MovingScene& moving = input_.input.moving;
    if (!edges_ || moving.pose) {
      posedScene(moving, frame.number, posed_);
    }
    if (!edges_) {
      edges_.emplace(posed_.view());
    }
    renderer_.setTransforms(frame.scene_from_stored);
    renderer_.draw(frame.view, opaque_, {.depths = true}, image_);
    const NearestSurfaces surfaces(frame.view, image_);
    Image picture = whitePicture(input_.width, input_.height);
    const std::uint64_t lines = drawLines(frame.view, surfaces, picture), ink = inkOf(picture);
    const std::string file = frameFile(file_, frame.number, input_.several_frames);
    if (const Status ok = savePicture(picture, file); !ok) {
      return ok.error();
    }
    ++frames_;
    lines_ += lines;
    ink_ += ink;
    return Json{{"line_picture", {{"file", file}, {"lines", lines}, {"fineness", fineness()}, {"ink", ink}}}};
  }

  void print() const override {
    const auto frames = static_cast<double>(std::max<std::uint64_t>(frames_, 1));
    fmt::print("line pictures, means of a frame:\n  {:<38}{:12.1f}\n  {:<38}{:12.1f}\n", "lines",
               static_cast<double>(lines_) / frames, "pixels of the visible ones",
               static_cast<double>(ink_) / frames);
  }

 private:
  std::uint32_t fineness() const { return renderer_.width() / input_.width; }

  // Draws all lines and returns their number, including hidden ones.
  std::uint64_t drawLines(const View& view, const NearestSurfaces& surfaces, Image& picture) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < posed_.objects.size(); ++i) {
      edges_->select(posed_.view(), ObjectId(i), view, features_, feature_lines_);
      count += feature_lines_.size();
      for (const FeatureLine& line : feature_lines_) {
        CameraPoint a = cameraPoint(view, posed_.positions[line.a]);
        CameraPoint b = cameraPoint(view, posed_.positions[line.b]);
        if (clip(view, a, b)) {
          drawLine(view, surfaces, a, b, picture);
        }
      }
    }
    return count;
  }

  // Draws a line. The reciprocal depth is linear along it in the picture.
  void drawLine(const View& view, const NearestSurfaces& surfaces, const CameraPoint& a, const CameraPoint& b,
                Image& picture) const {
    const auto place = [&](const CameraPoint& p) {
      const double w = view.orthographic ? 1.0 : p.depth;
      return Vec3d((0.5 + 0.5 * p.x / w) * renderer_.width(), (0.5 - 0.5 * p.y / w) * renderer_.height(),
                   surfaces.reciprocalDepthOf(p.depth));
    };
    const Vec3d from = place(a), step = place(b) - from;
    const double steps = std::max(1.0, std::ceil(std::max(std::abs(step.x), std::abs(step.y))));
    for (double i = 0.0; i <= steps; i += 1.0) {
      const Vec3d p = from + step * (i / steps);
      const auto x = static_cast<std::uint32_t>(std::max(p.x, 0.0)) / fineness();
      const auto y = static_cast<std::uint32_t>(std::max(p.y, 0.0)) / fineness();
      if (x < picture.width && y < picture.height && !surfaces.hides(p.x, p.y, p.z)) {
        std::fill_n(&picture.rgba[4 * (std::size_t{y} * picture.width + x)], 3, std::uint8_t{0});
      }
    }
  }

  std::string file_;
  FeatureSettings features_;
  const FrameMakerInput& input_;
  LayerRenderer renderer_;  // draws fine pixels
  std::vector<ObjectId> opaque_;
  std::optional<FeatureEdges> edges_;
  Scene posed_;
  LayerImage image_;
  std::vector<FeatureLine> feature_lines_;
  std::uint64_t frames_ = 0, lines_ = 0, ink_ = 0;
};

}  // namespace

Result<std::unique_ptr<FrameMaker>> makeLinePicture(const LayerDrawingOptions& options,
                                                    const FrameMakerInput& input) {
  if (options.line_picture.empty()) {
    return std::unique_ptr<FrameMaker>();
  }
  if (const Status ok = checkLines(options); !ok) {
    return ok.error();
  }
  const std::uint32_t fineness = finenessFor(input.width, input.height);
  Result<LayerRenderer> renderer = LayerRenderer::create(
      input.input.moving.scene.view(), {.width = fineness * input.width, .height = fineness * input.height});
  if (!renderer) {
    return renderer.error();
  }
  return std::unique_ptr<FrameMaker>(std::make_unique<LinePicture>(options, input, std::move(*renderer)));
}

}  // namespace sightline::tool
