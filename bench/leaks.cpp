// How much too much do maps of occluders keep, and at what price? One row for each method, size of map and
// number of occluders: objects kept over objects exactly visible, once of all objects and once of the small
// boxes alone, and the time of a frame (median us of choice, build and walk, as measured in this run).
//
// Exactly visible is what rays through the pixels of 1280 x 720 show, and whatever else in the frustum rays
// to points of its triangles reach (Embree); "by pixels" is the first part. Every object of demo:boxes fills
// its box, so that what is kept too much is due to the occluders and the map alone.
//
// false: objects that were seen but not kept, confirmed in wide arithmetic, in all views together. It is 0
// for all but "rays", which is not conservative.
//
// "focused": the depth pyramid with its finer map; "small too": with the small boxes among the occluders, and
// a finer map of 128 x 64 and of 256 x 128 pixels.
//
//   leaks [--benchmark_min_time=SHORT] [SCENE...]

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/map_methods.h"
#include "bench/measuring.h"
#include "bench/ray_depth.h"
#include "oracle/exact_visibility.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::uint32_t kCounts[] = {32, 64, 256, 1024};
// Enough of the occluders' area for the small boxes to be among them.
constexpr double kSmallToo = 0.999;
constexpr std::size_t kStepsInTurn = kUncounted + 1;  // a view of a path of views
constexpr std::uint32_t kAimedRays = 64;              // at each object that no pixel shows

// What the eye sees in one view.
struct Seen {
  std::vector<SeenPoint> witnesses;  // ascending by id
  std::size_t by_pixels = 0;
};

Seen seeExactly(const ExactVisibility& exact, const View& view, std::span<const ObjectId> in_frustum) {
  Seen seen{exact.visibleThroughPixels(view, 1280, 720)};
  seen.by_pixels = seen.witnesses.size();
  std::vector<ObjectId> others;
  auto next = seen.witnesses.begin();
  for (const ObjectId object : in_frustum) {
    while (next != seen.witnesses.end() && next->object.value < object.value) {
      ++next;
    }
    if (next == seen.witnesses.end() || next->object != object) {
      others.push_back(object);
    }
  }
  const std::vector<SeenPoint> aimed = exact.visibleByAimedRays(view, others, kAimedRays);
  seen.witnesses.insert(seen.witnesses.end(), aimed.begin(), aimed.end());
  std::sort(seen.witnesses.begin(), seen.witnesses.end(),
            [](const SeenPoint& a, const SeenPoint& b) { return a.object.value < b.object.value; });
  return seen;
}

// Objects over all views, all of them and the small boxes alone.
struct Counts {
  std::uint64_t all = 0, small = 0;
  double ratioOfAll(const Counts& exact) const {
    return exact.all == 0 ? 0.0 : static_cast<double>(all) / static_cast<double>(exact.all);
  }
  double ratioOfSmall(const Counts& exact) const {
    return exact.small == 0 ? 0.0 : static_cast<double>(small) / static_cast<double>(exact.small);
  }
};

struct Row {
  Counts kept;
  std::uint64_t false_culls = 0;
  std::vector<double> us;
};

class Comparison {
 public:
  explicit Comparison(const std::string& name)
      : scene_(loadScene(name, "leaks")),
        hierarchy_(buildHierarchy(scene_.bounds, scene_.cost)),
        occluders_(findOccluders(scene_.scene.view())),
        small_too_(findOccluders(scene_.scene.view(), {.area_fraction = kSmallToo})),
        exact_(scene_.scene.view()),
        rays_(scene_.scene.view()),
        frustum_(hierarchy_, scene_.bounds, occluders_, {.method = AnyMethod::kFrustum}) {}

  void run(bool brief) {
    listMethods(brief);
    for (const Method& method : methods_) {
      cullers_.emplace_back(hierarchy_, scene_.bounds, method.small_occluders ? small_too_ : occluders_,
                            method.settings);
    }
    rows_.resize(methods_.size());
    const std::vector<Step> steps = stepsOf(scene_, brief ? 2 : 20, 1);
    for (std::size_t first = 0; first < steps.size(); first += kStepsInTurn) {
      measure(std::span(steps).subspan(first, std::min(kStepsInTurn, steps.size() - first)));
      ++groups_;
    }
  }

  void print(const std::string& name) const {
    const auto views = static_cast<double>(rows_[0].us.size());
    const auto each = [&](std::uint64_t count) { return static_cast<double>(count) / views; };
    fmt::print("\n{}: {} objects, {} occluders, {} views\n", name, scene_.bounds.size(),
               occluders_.occluders.size(), views);
    fmt::print("exactly visible in a view: {:.1f} ({:.1f} by pixels), of them small boxes {:.1f}\n",
               each(exact_count_.all), each(by_pixels_), each(exact_count_.small));
    fmt::print("{:<9}{:>9}{:>6} |{:>10}{:>9} |{:>12}{:>9} |{:>7}{:>10}\n", "", "map", "k", "kept", "/ exact",
               "small boxes", "/ exact", "false", "us");
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      const Method& method = methods_[m];
      const Row& row = rows_[m];
      const bool chooses = method.kind == MethodKind::kCuller && method.settings.occluder_count > 0;
      fmt::print("{:<9}{:>9}{:>6} |{:>10.1f}{:>9.2f} |{:>12.1f}{:>9.2f} |{:>7}{:>10.1f}\n", method.name,
                 method.sizeText(), chooses ? std::to_string(method.settings.occluder_count) : "",
                 each(row.kept.all), row.kept.ratioOfAll(exact_count_), each(row.kept.small),
                 row.kept.ratioOfSmall(exact_count_), row.false_culls, medianOf(row.us));
    }
    std::fflush(stdout);
  }

 private:
  void listMethods(bool brief) {
    const auto counts = std::span(kCounts).first(brief ? 2 : std::size(kCounts));
    methods_.push_back(cullerMethod("frustum", AnyMethod::kFrustum, 0));
    for (const std::uint32_t count : counts) {
      methods_.push_back(cullerMethod("tree", AnyMethod::kOcclusionTree, count));
    }
    for (const std::uint32_t count : counts) {
      methods_.push_back(cullerMethod("planes", AnyMethod::kSupportingPlanes, count));
    }
    const auto sizes = std::span(kMapSizes).first(std::size(kMapSizes) - (brief ? 1 : 0));
    addMapMethods(methods_, sizes, counts);
    for (const MapSize size : sizes) {
      for (const std::uint32_t width : {128u, 256u}) {
        FocusSettings focus;
        focus.raster = {.width = width, .height = width / 2};
        focus.occluder_count = 2 * width;
        methods_.push_back(focusedMethod("small too", 64, size, focus));
        methods_.back().small_occluders = true;
      }
    }
  }

  bool isSmall(ObjectId object) const {
    return scene_.scene.object_names[object.value].rfind("box ", 0) == 0;
  }
  Counts count(std::span<const ObjectId> objects) const {
    Counts counts{objects.size()};
    for (const ObjectId object : objects) {
      counts.small += isSmall(object) ? 1 : 0;
    }
    return counts;
  }

  // Each method has all the steps in a row, so that it finds its own data in the caches.
  void measure(std::span<const Step> steps) {
    std::vector<Seen> seen(steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (steps[i].counted) {
        seen[i] = see(steps[i].view);
      }
    }
    confirmed_.clear();
    confirmed_.resize(steps.size());
    for (std::size_t turn = 0; turn < methods_.size(); ++turn) {
      const std::size_t m = (turn + groups_) % methods_.size();
      for (std::size_t i = 0; i < steps.size(); ++i) {
        const Step& step = steps[i];
        double us = 0.0;
        if (methods_[m].kind == MethodKind::kCuller) {
          cullers_[m].cull(step.view);
          kept_.assign(cullers_[m].visible().begin(), cullers_[m].visible().end());
          us = cullers_[m].stats().totalUs();
        } else if (step.counted) {
          const MapSize size = methods_[m].size;
          const RayTimes times =
              cullByRays(rays_, frustum_, scene_.bounds, step.view, size.width, size.height, kept_);
          us = times.rays_us + times.boxes_us;
        }
        if (step.counted) {
          add(rows_[m], step.view, seen[i], confirmed_[i], us);
        }
      }
    }
  }

  Seen see(const View& view) {
    frustum_.cull(view);
    Seen seen = seeExactly(exact_, view, frustum_.visible());
    for (const SeenPoint& witness : seen.witnesses) {
      ++exact_count_.all;
      exact_count_.small += isSmall(witness.object) ? 1 : 0;
    }
    by_pixels_ += seen.by_pixels;
    return seen;
  }

  using Confirmed = std::map<std::uint32_t, bool>;  // objects seen but not kept, of one view

  void add(Row& row, const View& view, const Seen& seen, Confirmed& confirmed, double us) {
    const Counts kept = count(kept_);
    row.kept.all += kept.all;
    row.kept.small += kept.small;
    row.us.push_back(us);
    auto next = kept_.begin();
    for (const SeenPoint& witness : seen.witnesses) {
      while (next != kept_.end() && next->value < witness.object.value) {
        ++next;
      }
      if (next == kept_.end() || *next != witness.object) {
        row.false_culls += confirm(view, witness, confirmed) ? 1 : 0;
      }
    }
  }

  // Once for all methods: wide arithmetic takes its time.
  bool confirm(const View& view, const SeenPoint& witness, Confirmed& confirmed) const {
    const auto [at, added] = confirmed.try_emplace(witness.object.value, false);
    if (added) {
      at->second = exact_.confirm(view, witness);
    }
    return at->second;
  }

  BenchmarkScene scene_;
  Hierarchy hierarchy_;
  OccluderSet occluders_, small_too_;
  ExactVisibility exact_;
  RayDepth rays_;
  AnyCuller frustum_;
  std::vector<Method> methods_;
  std::vector<AnyCuller> cullers_;

  std::size_t groups_ = 0;  // of steps
  std::vector<Row> rows_;
  Counts exact_count_;
  std::uint64_t by_pixels_ = 0;
  std::vector<ObjectId> kept_;        // by the method at hand
  std::vector<Confirmed> confirmed_;  // by step of the group at hand
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  std::vector<std::string> scenes = arguments.words;
  if (scenes.empty()) {
    scenes = {"demo:boxes"};
  }
  for (const std::string& scene : scenes) {
    Comparison comparison(scene);
    comparison.run(arguments.brief);
    comparison.print(scene);
  }
}
