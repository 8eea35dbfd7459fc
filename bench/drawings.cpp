// What does a hidden-line drawing cost, and how large is its file? In the same run, of the same view, with
// the same lines:
//
//   painter    HiddenLineRenderer::paint: sort, outlines filled back to front, whole strokes
//   plot       HiddenLineRenderer::plot: sort with all arcs, visible pieces
//   gl2ps      its BSP tree (GL2PS_BEST_ROOT) of all triangles and lines, which splits what crosses; far ones
//              first
//   culled     the same with its occlusion culling (GL2PS_OCCLUSION_CULL), which leaves out what is hidden
//
// gl2ps gets the triangles and lines that are in the view, projected and clipped, without OpenGL: the time of
// its feedback buffer is not counted. It runs in a process of its own, which is ended when it takes too long.
//
//   drawings [SCENE...]        demo:NAME, or a file with walk.path.json beside it, which is drawn from
//   outside

#include <fmt/format.h>
#include <gl2ps.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/drawing/drawing.h"
#include "sightline/io/file.h"
#include "sightline/layers/layer_sorter.h"
#include "src/geometry/clip_convex.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr int kHeight = 720;
constexpr float kDepthRange = 1000.0f;  // what gl2ps makes of OpenGL's 0 to 1
constexpr rlim_t kMaxMemory = rlim_t{8} << 30;

struct Limits {
  rlim_t seconds = 120;
};

struct Measured {
  double svg_bytes = 0.0, pdf_bytes = 0.0, time_us = 0.0, strokes = 0.0;
};

// The scene from outside, a little from above.
View overview(const Scene& scene) {
  const Box bounds = sceneBounds(scene.view());
  const Vec3d centre = (Vec3d(bounds.min) + Vec3d(bounds.max)) * 0.5;
  const double radius = 0.5 * length(Vec3d(bounds.max) - Vec3d(bounds.min));
  View view;
  const Vec3d aside = normalized(Vec3d(1.0, 0.55, -0.6));
  view.tan_half_fovy = std::tan(0.35);
  view.eye = centre + aside * (1.6 * radius);
  view.aspect = 16.0 / 9.0;
  view.z_near = 0.05 * radius;
  view.z_far = 4.0 * radius;
  setOrientation(view, -aside, {0, 1, 0});
  return view;
}

LayerSorter sorterOf(const Scene& scene, bool all_arcs) {
  LayerSorter sorter({.arcs = all_arcs ? LayerArcs::kAll : LayerArcs::kWithinGroups});
  for (const Object& object : scene.objects) {
    std::vector<std::uint32_t> corners(scene.indices.begin() + object.first_index,
                                       scene.indices.begin() + object.first_index + object.index_count);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<Vec3d> points;
    for (const std::uint32_t corner : corners) {
      points.emplace_back(scene.positions[corner]);
    }
    const HullId hull = sorter.addHull(valueOrExit(buildHull(points), "drawings"));
    sorter.addPart({&hull, 1});
  }
  return sorter;
}

// The first sort of a view, not one from the frame before, with hulls and edges made before.
Measured measureOurs(const Scene& scene, const View& view, bool plot) {
  HiddenLineRenderer renderer(scene.view());
  LayerSorter sorter = sorterOf(scene, plot);
  Drawing drawing;
  Measured result;
  std::string svg;
  result.time_us = microseconds([&] {
    const LayerOrder& order = sorter.update(view);
    const DrawingSettings settings{.page_height = kHeight};
    drawing = plot ? renderer.plot(scene.view(), scene.object_names, view, order, settings)
                   : renderer.paint(scene.view(), scene.object_names, view, order, settings);
    svg = toSvg(drawing);
  });
  result.svg_bytes = static_cast<double>(svg.size());
  result.pdf_bytes = static_cast<double>(toPdf(drawing).size());
  result.strokes = static_cast<double>(countStrokes(drawing));
  return result;
}

// What gl2ps is given: in pixels from the lower left corner, depth from 0 to kDepthRange (spreadDepths).
struct Primitive {
  std::vector<GL2PSvertex> corners;  // 3, or 2 of a line
};

class Projector {
 public:
  explicit Projector(const View& view) : view_(view), frustum_(frustumOf(view)), clip_(clipFromScene(view)) {}

  std::optional<std::vector<Vec3d>> clip(std::vector<Vec3d> points) const {
    struct Corner {
      Vec3d position;
    };
    std::vector<Corner> polygon, scratch;
    for (const Vec3d& point : points) {
      polygon.push_back({point});
    }
    for (const Plane& plane : frustum_.planes) {
      if (!geometry::clipConvex(polygon, scratch, Corner{},
                                [&](const Vec3d& p) { return plane.evaluate(p); })) {
        return std::nullopt;
      }
    }
    points.clear();
    for (const Corner& corner : polygon) {
      points.push_back(corner.position);
    }
    return points;
  }
  bool clip(Vec3d& a, Vec3d& b) const {
    for (const Plane& plane : frustum_.planes) {
      const double da = plane.evaluate(a), db = plane.evaluate(b);
      if (da < 0.0 && db < 0.0) {
        return false;
      }
      if (da < 0.0 || db < 0.0) {
        (da < 0.0 ? a : b) = a + (b - a) * (da / (da - db));
      }
    }
    return true;
  }
  GL2PSvertex project(const Vec3d& p, float grey) const {
    std::array<double, 4> c{};
    for (int row = 0; row < 4; ++row) {
      c[static_cast<std::size_t>(row)] =
          clip_(row, 0) * p.x + clip_(row, 1) * p.y + clip_(row, 2) * p.z + clip_(row, 3);
    }
    GL2PSvertex vertex{};
    vertex.xyz[0] = static_cast<float>((c[0] / c[3] * 0.5 + 0.5) * kHeight * view_.aspect);
    vertex.xyz[1] = static_cast<float>((c[1] / c[3] * 0.5 + 0.5) * kHeight);
    vertex.xyz[2] = static_cast<float>(c[2] / c[3] * 0.5 + 0.5);
    vertex.rgba[0] = vertex.rgba[1] = vertex.rgba[2] = grey;
    vertex.rgba[3] = 1.0f;
    return vertex;
  }
  bool isFront(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
    return dot(cross(b - a, c - a), view_.orthographic ? -view_.forward : view_.eye - a) > 0.0;
  }

 private:
  View view_;
  Frustum frustum_;
  Mat4 clip_;
};

// gl2ps's tree has a fixed tolerance, made for pixels: it multiplies depths that it has from OpenGL by 1000,
// and takes those that it is given as they are. Filling the whole range suits it best.
void spreadDepths(std::vector<Primitive>& primitives) {
  float low = 1.0f, high = 0.0f;
  for (const Primitive& primitive : primitives) {
    for (const GL2PSvertex& corner : primitive.corners) {
      low = std::min(low, corner.xyz[2]);
      high = std::max(high, corner.xyz[2]);
    }
  }
  for (Primitive& primitive : primitives) {
    for (GL2PSvertex& corner : primitive.corners) {
      corner.xyz[2] = high > low ? kDepthRange * (corner.xyz[2] - low) / (high - low) : 0.0f;
    }
  }
}

// Triangles that no pixel shows have planes of rounding alone, by which gl2ps would split all others.
bool hasArea(const std::vector<GL2PSvertex>& corners) {
  const auto& a = corners[0].xyz;
  const auto& b = corners[1].xyz;
  const auto& c = corners[2].xyz;
  return std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) > 1e-3f;
}

// White triangles and black lines.
std::vector<Primitive> primitivesOf(const Scene& scene, const View& view) {
  const Projector projector(view);
  const FeatureEdges edges(scene.view());
  std::vector<Primitive> primitives;
  std::vector<FeatureLine> lines;
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id) {
    const Object& object = scene.objects[id];
    const Material& material = scene.materials[object.material.value];
    for (std::uint32_t i = 0; material.opaque() && i < object.index_count; i += 3) {
      const std::uint32_t* corner = &scene.indices[object.first_index + i];
      const Vec3d a(scene.positions[corner[0]]), b(scene.positions[corner[1]]), c(scene.positions[corner[2]]);
      if (!material.double_sided && !projector.isFront(a, b, c)) {
        continue;
      }
      const std::optional<std::vector<Vec3d>> polygon = projector.clip({a, b, c});
      for (std::size_t k = 2; polygon && k < polygon->size(); ++k) {
        Primitive triangle{{projector.project((*polygon)[0], 1.0f),
                            projector.project((*polygon)[k - 1], 1.0f),
                            projector.project((*polygon)[k], 1.0f)}};
        if (hasArea(triangle.corners)) {
          primitives.push_back(std::move(triangle));
        }
      }
    }
    edges.select(scene.view(), ObjectId(id), view, {}, lines);
    for (const FeatureLine& line : lines) {
      Vec3d a(scene.positions[line.a]), b(scene.positions[line.b]);
      if (projector.clip(a, b)) {
        primitives.push_back({{projector.project(a, 0.0f), projector.project(b, 0.0f)}});
      }
    }
  }
  spreadDepths(primitives);
  return primitives;
}

// Returns the time, in microseconds.
double printWithGl2ps(std::vector<Primitive>& primitives, const View& view, GLint format, bool culled,
                      const std::string& file) {
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  GLint viewport[4] = {0, 0, static_cast<GLint>(std::lround(kHeight * view.aspect)), kHeight};
  const GLint options = GL2PS_NO_OPENGL_CONTEXT | GL2PS_NO_BLENDING | GL2PS_SIMPLE_LINE_OFFSET |
                        GL2PS_SILENT | GL2PS_BEST_ROOT | (culled ? GL2PS_OCCLUSION_CULL : 0) |
                        (format == GL2PS_PDF ? GL2PS_COMPRESS : 0);
  const double time_us = microseconds([&] {
    gl2psBeginPage("drawing", "sightline", viewport, format, GL2PS_BSP_SORT, options, GL_RGBA, 0, nullptr, 0,
                   0, 0, 0, stream, file.c_str());
    for (Primitive& primitive : primitives) {
      const bool is_line = primitive.corners.size() == 2;
      gl2psAddPolyPrimitive(is_line ? GL2PS_LINE : GL2PS_TRIANGLE,
                            static_cast<GLshort>(primitive.corners.size()), primitive.corners.data(), 0, 0.0f,
                            0.0f, 0xffff, 0, 1.0f, GL2PS_LINE_CAP_ROUND, GL2PS_LINE_JOIN_ROUND, 0);
    }
    gl2psEndPage();
  });
  std::fclose(stream);
  return time_us;
}

double linesIn(const std::string& svg) {
  std::size_t count = 0;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos; at = svg.find("<polyline", at + 1)) {
    ++count;
  }
  return static_cast<double>(count);
}

// Runs it in a process with limits. Nothing: it went beyond them.
std::optional<double> limitedGl2ps(std::vector<Primitive>& primitives, const View& view, GLint format,
                                   bool culled, const std::string& file, const Limits& limits) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    return std::nullopt;
  }
  const pid_t child = fork();
  if (child == 0) {
    const rlimit cpu{limits.seconds, limits.seconds}, memory{kMaxMemory, kMaxMemory}, core{0, 0},
        stack{rlim_t{1} << 30, rlim_t{1} << 30};
    setrlimit(RLIMIT_CPU, &cpu);
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
    setrlimit(RLIMIT_STACK, &stack);  // its tree is walked by recursion
    const double time_us = printWithGl2ps(primitives, view, format, culled, file);
    const bool written = write(ends[1], &time_us, sizeof time_us) == sizeof time_us;
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  double time_us = 0.0;
  const bool finished = read(ends[0], &time_us, sizeof time_us) == sizeof time_us;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return finished && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? std::optional(time_us) : std::nullopt;
}

std::optional<Measured> measureGl2ps(std::vector<Primitive>& primitives, const View& view, bool culled,
                                     const Limits& limits) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path();
  const std::string stem = (folder / ("sightline-drawings-" + std::to_string(getpid()))).string();
  const std::string svg = stem + ".svg", pdf = stem + ".pdf";
  const std::optional<double> time_us = limitedGl2ps(primitives, view, GL2PS_SVG, culled, svg, limits);
  std::optional<Measured> result;
  if (time_us && limitedGl2ps(primitives, view, GL2PS_PDF, culled, pdf, limits)) {
    result = Measured{.svg_bytes = static_cast<double>(fs::file_size(svg)),
                      .pdf_bytes = static_cast<double>(fs::file_size(pdf)),
                      .time_us = *time_us,
                      .strokes = linesIn(valueOrExit(readFile(svg), "drawings"))};
  }
  std::error_code ignored;
  fs::remove(svg, ignored);
  fs::remove(pdf, ignored);
  return result;
}

void print(const char* method, const std::optional<Measured>& result, const Limits& limits) {
  if (result) {
    fmt::print("  {:<10}{:12.1f}{:12.1f}{:12.1f}{:10.0f}\n", method, result->time_us / 1000.0,
               result->svg_bytes / 1000.0, result->pdf_bytes / 1000.0, result->strokes);
  } else {
    fmt::print("  {:<10}not finished within {} s and {} GiB\n", method, limits.seconds, kMaxMemory >> 30);
  }
  std::fflush(stdout);
}

void measure(const std::string& name, const Limits& limits) {
  const BenchmarkScene loaded = loadScene(name, "drawings");
  const Scene& scene = loaded.scene;
  const View view = isDemoUrl(name) ? loaded.path.view(0, scene.origin) : overview(scene);
  std::vector<Primitive> primitives = primitivesOf(scene, view);
  const auto lines = std::count_if(primitives.begin(), primitives.end(),
                                   [](const Primitive& p) { return p.corners.size() == 2; });
  fmt::print("{}: {} objects; in view {} triangles, {} lines\n", name, scene.objects.size(),
             primitives.size() - static_cast<std::size_t>(lines), lines);
  fmt::print("  {:<10}{:>12}{:>12}{:>12}{:>10}\n", "", "time, ms", "SVG, kB", "PDF, kB", "strokes");
  print("painter", measureOurs(scene, view, false), limits);
  print("plot", measureOurs(scene, view, true), limits);
  print("gl2ps", measureGl2ps(primitives, view, false, limits), limits);
  print("culled", measureGl2ps(primitives, view, true, limits), limits);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  std::vector<std::string> scenes = arguments.words;
  if (scenes.empty()) {
    scenes = arguments.brief ? std::vector<std::string>{"demo:toothpicks?n=40"}
                             : std::vector<std::string>{"demo:toothpicks", "demo:canyon", "demo:city"};
  }
  const Limits limits{.seconds = arguments.brief ? rlim_t{20} : rlim_t{120}};
  for (const std::string& scene : scenes) {
    measure(scene, limits);
  }
}
