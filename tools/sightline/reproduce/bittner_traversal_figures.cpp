// Bittner, Havran and Slavik 1998, figures 5 and 6: what the traversal of a scene's kd-tree finds, in plan,
// and which of its nodes temporal coherence leaves untested.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sightline/comparison/traversal_record.h"
#include "tools/sightline/report/markup.h"
#include "tools/sightline/reproduce/bittner.h"
#include "tools/sightline/reproduce/figure_colors.h"
#include "tools/sightline/reproduce/tree_diagram.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool::bittner {
namespace {

constexpr double kLargestReach = 60.0;  // metres around the eye that figure 5 shows at most
constexpr std::uint32_t kFigure6Levels = 5;

// The setting of figures 9 and 10.
Setting plottedSetting() {
  for (const Case& one : allCases()) {
    if (one.method == kPlotted && one.occluders == kPlottedOccluders) {
      return one.setting;
    }
  }
  return {};
}

std::vector<OccluderId> chosenFor(Culler& culler, const View& view) {
  culler.cull(view);
  const std::span<const OccluderId> used = culler.occludersUsed();
  return {used.begin(), used.end()};
}

// Where the scene's plan lies on the canvas.
struct Plan {
  double min_x = 0.0, min_z = 0.0;  // scene space, metres
  double scale = 10.0;              // pixels a metre
  SvgPoint corner{};                // of the paper, pixels
  SvgPoint size{};

  SvgPoint operator()(double x, double z) const {
    return {corner.x + scale * (x - min_x), corner.y + scale * (z - min_z)};
  }
};

// A rectangle in plan, scene space, metres.
struct Extent {
  double min_x = 1e300, max_x = -1e300, min_z = 1e300, max_z = -1e300;

  void add(double x, double z) {
    min_x = std::min(min_x, x);
    max_x = std::max(max_x, x);
    min_z = std::min(min_z, z);
    max_z = std::max(max_z, z);
  }
  void keepWithin(const Extent& other) {
    min_x = std::max(min_x, other.min_x);
    max_x = std::min(max_x, other.max_x);
    min_z = std::max(min_z, other.min_z);
    max_z = std::min(max_z, other.max_z);
  }
};

// Where a polygon cuts a height: two points, or none.
std::vector<Vec3d> cutAt(std::span<const Vec3f> corners, double height) {
  std::vector<Vec3d> ends;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d p(corners[i]), q(corners[(i + 1) % corners.size()]);
    if ((p.y <= height) != (q.y <= height)) {
      ends.push_back(p + (q - p) * ((height - p.y) / (q.y - p.y)));
    }
  }
  return ends.size() == 2 ? ends : std::vector<Vec3d>{};
}

// The plan around the nodes that were tested, as far as there are walls at the eye's height.
Plan planOf(const Hierarchy& hierarchy, std::span<const NodeVisit> visits, const OccluderSet& occluders,
            const Vec3d& eye) {
  Extent extent, walls, near;
  for (std::size_t n = 0; n < visits.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (visits[n] == NodeVisit::kHidden || (visits[n] == NodeVisit::kPartial && node.leaf())) {
      extent.add(node.bounds.min.x, node.bounds.min.z);
      extent.add(node.bounds.max.x, node.bounds.max.z);
    }
  }
  for (const Occluder& occluder : occluders.occluders) {
    for (const Vec3d& end : cutAt(occluders.verticesOf(occluder), eye.y)) {
      walls.add(end.x, end.z);
    }
  }
  near.add(eye.x - kLargestReach, eye.z - kLargestReach);
  near.add(eye.x + kLargestReach, eye.z + kLargestReach);
  extent.keepWithin(walls);
  extent.keepWithin(near);
  extent.add(eye.x, eye.z);
  constexpr double kBorder = 1.0, kWidth = 920.0, kHeight = 560.0;
  const double width = extent.max_x - extent.min_x + 2.0 * kBorder;
  const double depth = extent.max_z - extent.min_z + 2.0 * kBorder;
  Plan plan{extent.min_x - kBorder,
            extent.min_z - kBorder,
            std::min(kWidth / width, kHeight / depth),
            {20.0, 20.0}};
  plan.size = {plan.scale * width, plan.scale * depth};
  return plan;
}

// Draws a line of the plan as far as it is on the paper.
void drawLine(SvgCanvas& canvas, const Plan& plan, SvgPoint from, SvgPoint to, const SvgPaint& paint) {
  const double x0 = plan.corner.x, x1 = x0 + plan.size.x, y0 = plan.corner.y, y1 = y0 + plan.size.y;
  double begin = 0.0, end = 1.0;
  const auto cut = [&](double at, double along, double low, double high) {
    if (along == 0.0) {
      end = at < low || at > high ? -1.0 : end;
      return;
    }
    const double t0 = (low - at) / along, t1 = (high - at) / along;
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  };
  const double along_x = to.x - from.x, along_y = to.y - from.y;
  cut(from.x, along_x, x0, x1);
  cut(from.y, along_y, y0, y1);
  if (begin < end) {
    canvas.line({from.x + begin * along_x, from.y + begin * along_y},
                {from.x + end * along_x, from.y + end * along_y}, paint);
  }
}

// Draws where a polygon cuts the height of the eye.
void drawCut(SvgCanvas& canvas, const Plan& plan, std::span<const Vec3f> corners, double height,
             const SvgPaint& paint) {
  const std::vector<Vec3d> ends = cutAt(corners, height);
  if (!ends.empty()) {
    drawLine(canvas, plan, plan(ends[0].x, ends[0].z), plan(ends[1].x, ends[1].z), paint);
  }
}

void drawRegion(SvgCanvas& canvas, const Plan& plan, const Box& box, const SvgPaint& paint) {
  SvgPoint low = plan(box.min.x, box.min.z), high = plan(box.max.x, box.max.z);
  low = {std::max(low.x, plan.corner.x), std::max(low.y, plan.corner.y)};
  high = {std::min(high.x, plan.corner.x + plan.size.x), std::min(high.y, plan.corner.y + plan.size.y)};
  constexpr double kThinnest = 1.0;  // pixels, so that the box of a wall can be seen
  if (low.x <= high.x && low.y <= high.y) {
    canvas.rectangle(low, {std::max(high.x - low.x, kThinnest), std::max(high.y - low.y, kThinnest)}, paint);
  }
}

const char* colorOf(NodeVisit visit) {
  return visit == NodeVisit::kHidden    ? kHiddenNode
         : visit == NodeVisit::kVisible ? kVisibleNode
                                        : kPartialNode;
}

// Draws the nodes at which the traversal ended, where they cut the eye's height.
void drawNodes(SvgCanvas& canvas, const Plan& plan, const Hierarchy& hierarchy,
               std::span<const NodeVisit> visits, double height) {
  for (const NodeVisit wanted : {NodeVisit::kHidden, NodeVisit::kPartial, NodeVisit::kVisible}) {
    for (std::size_t n = 0; n < visits.size(); ++n) {
      const HierarchyNode& node = hierarchy.nodes[n];
      const bool ends_here = wanted != NodeVisit::kPartial || node.leaf();
      if (visits[n] == wanted && ends_here && node.bounds.min.y <= height && node.bounds.max.y >= height) {
        drawRegion(canvas, plan, node.bounds,
                   {.fill = colorOf(wanted), .stroke = "#ffffff", .width = 0.6, .fill_opacity = 0.85});
      }
    }
  }
}

void drawFrustum(SvgCanvas& canvas, const Plan& plan, const View& view) {
  const SvgPoint eye = plan(view.eye.x, view.eye.z);
  for (const double side : {-1.0, 1.0}) {
    const Vec3d along = view.forward + view.right * (side * view.tan_half_fovy * view.aspect);
    constexpr double kFar = 1000.0;
    const Vec3d far = view.eye + along * kFar;
    drawLine(canvas, plan, eye, plan(far.x, far.z), {.stroke = kInk, .width = 1.2, .dashes = "7 4"});
  }
  canvas.circle(eye, 5.0, {.fill = kInk});
}

struct Legend {
  const char* color;
  const char* words;
};

void drawLegend(SvgCanvas& canvas, SvgPoint at, std::span<const Legend> entries, double step) {
  for (const auto& [color, words] : entries) {
    canvas.rectangle({at.x, at.y - 7.0}, {14.0, 14.0}, {.fill = color, .stroke = kInk, .width = 0.6});
    canvas.text({at.x + 20.0, at.y}, words, {.size = 12.0, .anchor = SvgText::Anchor::kStart});
    at.x += step;
  }
}

ReportPicture figurePicture(std::uint32_t figure, std::string caption) {
  ReportPicture picture;
  picture.file = fmt::format("figure-{}.svg", figure);
  picture.caption = std::move(caption);
  picture.frame = figure;
  picture.heading = fmt::format("Figure {}", figure);
  return picture;
}

// How many nodes had each visit.
std::size_t countOf(std::span<const NodeVisit> visits, NodeVisit visit) {
  return static_cast<std::size_t>(std::count(visits.begin(), visits.end(), visit));
}

// The frame of the walk whose traversal finds the most nodes hidden and the most partial: the larger the
// smaller of the two numbers, the more there is to see.
std::uint32_t telltaleFrame(Measured& measured, const Hierarchy& hierarchy) {
  constexpr std::size_t kTried = 20;
  const std::vector<std::uint32_t>& frames = measured.input.walk.frames;
  Culler culler = measured.data.makeCuller(plottedSetting());
  RecordedTraversal traversal(hierarchy, measured.data.bounds(), {.temporal_coherence = false});
  std::uint32_t best = frames.front();
  std::size_t best_count = 0;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / kTried)) {
    const View view = measured.input.walk.view(frames[i], measured.input.scene);
    culler.reset();
    const std::vector<OccluderId> chosen = chosenFor(culler, view);
    const auto visits = traversal.traverse(view, measured.data.occluders(), chosen);
    const std::size_t count =
        std::min(countOf(visits, NodeVisit::kHidden), countOf(visits, NodeVisit::kPartial));
    if (count > best_count) {
      best = frames[i];
      best_count = count;
    }
  }
  return best;
}

void addFigure5(Measured& measured, Figures& figures) {
  const Hierarchy& hierarchy = measured.data.hierarchy(HierarchyKind::kKdTree);
  const std::uint32_t frame = telltaleFrame(measured, hierarchy);
  const View view = measured.input.walk.view(frame, measured.input.scene);
  const OccluderSet& occluders = measured.data.occluders();
  Culler culler = measured.data.makeCuller(plottedSetting());
  const std::vector<OccluderId> chosen = chosenFor(culler, view);
  RecordedTraversal traversal(hierarchy, measured.data.bounds());
  const std::span<const NodeVisit> visits = traversal.traverse(view, occluders, chosen);
  const Plan plan = planOf(hierarchy, visits, occluders, view.eye);
  SvgCanvas canvas(std::max(plan.size.x + 40.0, 760.0), plan.size.y + 80.0,
                   "Figure 5: hierarchical visibility culling in plan");
  canvas.rectangle(plan.corner, plan.size, {.fill = "#f7f7f5", .stroke = kInk, .width = 0.6});
  drawNodes(canvas, plan, hierarchy, visits, view.eye.y);
  for (const Occluder& occluder : occluders.occluders) {
    drawCut(canvas, plan, occluders.verticesOf(occluder), view.eye.y, {.stroke = kWallInk, .width = 0.9});
  }
  for (const OccluderId occluder : chosen) {
    drawCut(canvas, plan, occluders.verticesOf(occluders[occluder]), view.eye.y,
            {.stroke = kOccluderInk, .width = 2.6});
  }
  drawFrustum(canvas, plan, view);
  const Legend legend[] = {{kHiddenNode, "hidden: the search ends"},
                           {kPartialNode, "leaf, partly visible"},
                           {kVisibleNode, "wholly visible"},
                           {kOccluderInk, "occluders used"}};
  drawLegend(canvas, {24.0, plan.size.y + 52.0}, legend, 185.0);
  figures.pictures.push_back(figurePicture(
      5,
      fmt::format(
          "Frame {}: the nodes of the kd-tree at which the search ends, at the height of the eye. {} nodes "
          "are hidden, {} wholly visible, {} partly visible, with {} occluders. White: outside the frustum "
          "or empty.",
          frame, grouped(countOf(visits, NodeVisit::kHidden)), grouped(countOf(visits, NodeVisit::kVisible)),
          grouped(countOf(visits, NodeVisit::kPartial)), chosen.size())));
  figures.files.push_back({.name = "figure-5.svg", .text = canvas.file()});
}

// Three frames in a row of a small kd-tree.
using ThreeFrames = std::array<std::vector<NodeVisit>, 3>;

// The three frames between which the marks change the most.
struct Coherence {
  std::uint32_t first_frame = 0;
  ThreeFrames visits{};
};
std::optional<Coherence> mostTelling(Measured& measured, const Hierarchy& small) {
  const std::vector<std::uint32_t>& frames = measured.input.walk.frames;
  constexpr std::size_t kTried = 40;
  std::optional<Coherence> best;
  long best_score = -1;
  for (std::size_t i = 0; i + 2 < frames.size(); i += std::max<std::size_t>(1, frames.size() / kTried)) {
    Culler culler = measured.data.makeCuller(plottedSetting());
    RecordedTraversal traversal(small, measured.data.bounds());
    Coherence tried{frames[i]};
    for (std::size_t k = 0; k < tried.visits.size(); ++k) {
      const View view = measured.input.walk.view(frames[i + k], measured.input.scene);
      const auto visits = traversal.traverse(view, measured.data.occluders(), chosenFor(culler, view));
      tried.visits[k].assign(visits.begin(), visits.end());
    }
    const auto second = static_cast<long>(countOf(tried.visits[1], NodeVisit::kSkipped));
    const auto third = static_cast<long>(countOf(tried.visits[2], NodeVisit::kSkipped));
    const auto ended = static_cast<long>(countOf(tried.visits[2], NodeVisit::kHidden));
    const long score = second == 0 || third == 0 ? 0 : 2 * std::abs(second - third) + second + ended;
    if (score > best_score) {
      best_score = score;
      best = std::move(tried);
    }
  }
  return best;
}

std::vector<DiagramNode> visitDiagram(const Hierarchy& hierarchy, std::span<const NodeVisit> visits) {
  std::vector<DiagramNode> nodes(hierarchy.nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const char* const fill = visits[n] == NodeVisit::kNone      ? "#ffffff"
                             : visits[n] == NodeVisit::kSkipped ? kMarked
                                                                : colorOf(visits[n]);
    const bool reached = visits[n] != NodeVisit::kNone;
    nodes[n].paint = {.fill = fill, .stroke = reached ? kInk : kWallInk};
    nodes[n].square = hierarchy.nodes[n].leaf();
    if (!hierarchy.nodes[n].leaf()) {
      const NodeIndex node(n);
      nodes[n].children = {hierarchy.left(node).value, hierarchy.right(node).value};
    }
  }
  return nodes;
}

void addFigure6(Measured& measured, Figures& figures) {
  const Hierarchy small =
      buildHierarchy(measured.data.bounds(), measured.data.triangles(),
                     {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 8, .max_depth = kFigure6Levels});
  const std::optional<Coherence> found = mostTelling(measured, small);
  if (!found) {
    return;  // fewer than three frames
  }
  SvgCanvas canvas(1000, 640, "Figure 6: temporal coherence in three frames");
  std::string counts;
  for (std::size_t k = 0; k < found->visits.size(); ++k) {
    const auto& visits = found->visits[k];
    const std::size_t skipped = countOf(visits, NodeVisit::kSkipped);
    const std::size_t tested = countOf(visits, NodeVisit::kHidden) + countOf(visits, NodeVisit::kVisible) +
                               countOf(visits, NodeVisit::kPartial);
    const double top = 10.0 + 195.0 * static_cast<double>(k);
    canvas.text({20.0, top + 20.0}, fmt::format("frame {}: {} skipped, {} tested", k + 1, skipped, tested),
                {.anchor = SvgText::Anchor::kStart, .bold = true});
    drawDiagram(canvas, visitDiagram(small, visits),
                {.corner = {20.0, top + 10.0}, .size = {960.0, 180.0}, .radius = 9.0});
    counts += fmt::format("{}{} skipped and {} tested", k == 0 ? "" : ", then ", skipped, tested);
  }
  const Legend legend[] = {{kMarked, "skipped: partial before"},
                           {kPartialNode, "tested: partial"},
                           {kHiddenNode, "tested: hidden"},
                           {kVisibleNode, "tested: visible"},
                           {"#ffffff", "not reached"}};
  drawLegend(canvas, {24.0, 618.0}, legend, 190.0);
  figures.pictures.push_back(figurePicture(
      6, fmt::format(
             "The top {} levels of a kd-tree over the scene in three frames from {} on: {}. A node is marked "
             "where it was partial and no child's state was certain; marked nodes are skipped in the next "
             "frame. Leaves (squares) are always tested.",
             kFigure6Levels, found->first_frame, counts)));
  figures.files.push_back({.name = "figure-6.svg", .text = canvas.file()});
}

}  // namespace

Figures traversalFigures(Measured& measured) {
  Figures figures;
  addFigure5(measured, figures);
  addFigure6(measured, figures);
  return figures;
}

}  // namespace sightline::tool::bittner
