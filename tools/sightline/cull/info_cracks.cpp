#include "tools/sightline/cull/info_cracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "src/io/point_json.h"
#include "tools/sightline/command_line/progress_bar.h"

namespace sightline::tool {
namespace {

// Cracks up to a centimetre: what is wider is meant to be there.
constexpr std::array<double, 5> kWidths{1e-6, 1e-5, 1e-4, 1e-3, 1e-2};

// Objects kept a frame. done(part): the part of the walk that is done.
template <typename Done>
double keptOn(const SceneAndWalk& input, const ParallelFor& parallel_for, const Done& done) {
  Setting setting;
  setting.method = &methodNamed("depth-pyramid");
  CullingData data(input, parallel_for);
  Culler culler = data.makeCuller(setting);
  const auto frames = static_cast<double>(input.walk.frames.size());
  std::size_t kept = 0;
  double walked = 0.0;
  for (const std::uint32_t frame : input.walk.frames) {
    culler.cull(input.walk.view(frame, input.scene));
    kept += culler.visible().size();
    done(++walked / frames);
  }
  return static_cast<double>(kept) / frames;
}

}  // namespace

CrackFacts crackFactsOf(const Scene& scene, const ParallelFor& parallel_for) {
  CrackFacts facts;
  for (const double width : kWidths) {
    facts.counts.push_back({width, 0});
  }
  std::map<std::pair<ObjectId, ObjectId>, CrackPlace> places;
  for (const Crack& crack : findCracks(scene.view(), kWidths.back(), parallel_for)) {
    const auto below = std::upper_bound(kWidths.begin(), kWidths.end(), crack.width);
    facts.counts[static_cast<std::size_t>(below - kWidths.begin())].count += 1;
    CrackPlace& place = places[std::minmax(crack.object, crack.other)];
    place.count += 1;
    place.widest = crack.width > place.widest.width ? crack : place.widest;
  }
  for (const auto& [objects, place] : places) {
    facts.places.push_back(place);
  }
  std::stable_sort(facts.places.begin(), facts.places.end(),
                   [](const CrackPlace& a, const CrackPlace& b) { return a.count > b.count; });
  facts.places.resize(std::min(facts.places.size(), CrackFacts::kMostPlaces));
  return facts;
}

CrackEffect effectOfClosing(const SceneAndWalk& input, std::span<const double> widths,
                            const ParallelFor& parallel_for) {
  ProgressBar progress("closing cracks");
  const auto walks = static_cast<double>(widths.size() + 1);
  double walked = 0.0;
  const auto keep = [&](const SceneAndWalk& of) {
    const double kept =
        keptOn(of, parallel_for, [&](double part) { progress.update((walked + part) / walks); });
    ++walked;
    return kept;
  };
  CrackEffect effect{.frames = input.walk.frames.size(), .kept_open = keep(input)};
  for (const double width : widths) {
    SceneAndWalk closed = input;
    closed.closing = closeCracksOf(closed.scene, width, parallel_for);
    effect.closed.push_back({closed.closing.note(), keep(closed)});
  }
  return effect;
}

Json cracksJson(const CrackFacts& facts, const Scene& scene) {
  Json counts = Json::array(), places = Json::array();
  for (const CrackCount& count : facts.counts) {
    counts.push_back({{"below", count.below}, {"count", count.count}});
  }
  for (const CrackPlace& place : facts.places) {
    places.push_back({{"count", place.count},
                      {"objects", {place.widest.object.value, place.widest.other.value}},
                      {"widest", place.widest.width},
                      {"at", io::pointJson(Vec3d(place.widest.at) + scene.origin)}});
  }
  Json json = {{"counts", counts}, {"places", places}};
  if (facts.effect) {
    const CrackEffect& effect = *facts.effect;
    Json all = Json::array();
    for (const CrackEffect::Closed& closed : effect.closed) {
      Json item = {{"frames", effect.frames}, {"kept_open", effect.kept_open}, {"kept_closed", closed.kept}};
      addCracks(item, closed.note);
      all.push_back(item);
    }
    json["closed"] = all.front();
    json["closings"] = all;
  }
  return json;
}

void printCracks(const CrackFacts& facts, const Scene& scene) {
  std::size_t all = 0;
  for (const CrackCount& count : facts.counts) {
    all += count.count;
  }
  fmt::print("cracks        {} corners lie less than {} m beside an edge\n", all, facts.counts.back().below);
  for (const CrackCount& count : facts.counts) {
    if (count.count > 0) {
      fmt::print("              {:10} below {} m\n", count.count, count.below);
    }
  }
  for (const CrackPlace& place : facts.places) {
    const auto& [at, width, object, other] = place.widest;
    const Vec3d world = Vec3d(at) + scene.origin;
    fmt::print("              {:10} {} '{}'{}, the widest, {:.2g} m, at {:.3f} {:.3f} {:.3f}\n", place.count,
               object == other ? "within" : "between", scene.object_names[object.value],
               object == other ? "" : fmt::format(" and '{}'", scene.object_names[other.value]), width,
               world.x, world.y, world.z);
  }
  if (facts.effect) {
    for (const CrackEffect::Closed& closed : facts.effect->closed) {
      fmt::print(
          "              with those below {} m closed, {:.1f} objects a frame are kept instead of {:.1f} "
          "(depth-pyramid, {} frames; closing moves nothing by more than {:.3g} m)\n",
          closed.note.width, closed.kept, facts.effect->kept_open, facts.effect->frames, closed.note.slack);
    }
  }
}

}  // namespace sightline::tool
