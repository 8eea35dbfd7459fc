#include "tools/sightline/cull/info_cracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace sightline::tool {
namespace {

// Cracks up to a centimetre: what is wider is meant to be there.
constexpr std::array<double, 5> kWidths{1e-6, 1e-5, 1e-4, 1e-3, 1e-2};

double keptOn(const SceneAndWalk& input, const ParallelFor& parallel_for) {
  Setting setting;
  setting.method = &methodNamed("depth-pyramid");
  CullingData data(input, parallel_for);
  Culler culler = data.makeCuller(setting);
  std::size_t kept = 0;
  for (const std::uint32_t frame : input.walk.frames) {
    culler.cull(input.walk.view(frame, input.scene));
    kept += culler.visible().size();
  }
  return static_cast<double>(kept) / static_cast<double>(input.walk.frames.size());
}

Json pointJson(const Vec3f& p, const Scene& scene) {
  const Vec3d world = Vec3d(p) + scene.origin;
  return {world.x, world.y, world.z};
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

CrackEffect effectOfClosing(const SceneAndWalk& input, double width, const ParallelFor& parallel_for) {
  SceneAndWalk closed = input;
  closed.closing = closeCracksOf(closed.scene, width, parallel_for);
  return {input.walk.frames.size(), keptOn(input, parallel_for), keptOn(closed, parallel_for), width,
          closed.closing.slack};
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
                      {"at", pointJson(place.widest.at, scene)}});
  }
  Json json = {{"counts", counts}, {"places", places}};
  if (facts.effect) {
    json["closed"] = {{"crack_width", facts.effect->width},
                      {"crack_slack", facts.effect->slack},
                      {"frames", facts.effect->frames},
                      {"kept_open", facts.effect->kept_open},
                      {"kept_closed", facts.effect->kept_closed}};
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
    fmt::print(
        "              with those below {} m closed, {:.1f} objects a frame are kept instead of {:.1f} "
        "(depth-pyramid, {} frames)\n",
        facts.effect->width, facts.effect->kept_closed, facts.effect->kept_open, facts.effect->frames);
  }
}

}  // namespace sightline::tool
