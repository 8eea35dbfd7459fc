#include "tools/sightline/methods/method_choice.h"

#include <fmt/format.h>

namespace sightline::tool {
namespace {

// Below these, a method takes longer than the objects that it could remove.
constexpr double kFewObjects = 64.0;
constexpr double kAlmostAllSeeThrough = 0.9;
constexpr double kLittleToHideBehind = 0.3;

MethodChoice frustumAlone(const SceneFacts& facts, std::string why) {
  return {facts, "frustum", {}, std::move(why)};
}

MethodChoice wholeSurfaces(const SceneFacts& facts, std::string why) {
  return {facts, "depth-pyramid", {{"surfaces", "alone"}}, std::move(why)};
}

MethodChoice byRules(const SceneFacts& facts) {
  const std::string in_frustum = fmt::format("{:.0f} objects are in the frustum", facts.in_frustum);
  const std::string area =
      fmt::format("polygons that can hide are {:.2f} times the scene's box", facts.occluder_area);
  if (facts.in_frustum < kFewObjects) {
    return frustumAlone(facts, in_frustum + ", fewer than pay for a test");
  }
  if (facts.see_through >= kAlmostAllSeeThrough) {
    return frustumAlone(facts,
                        fmt::format("{:.0f} % of the triangles are see-through", 100.0 * facts.see_through));
  }
  if (facts.occluder_area < kLittleToHideBehind) {
    return frustumAlone(facts, area + ", so there is little to hide behind");
  }
  return wholeSurfaces(facts, fmt::format("{}, and {}, so the tightest method pays", area, in_frustum));
}

}  // namespace

MethodChoice chooseMethod(const SceneFacts& facts) {
  MethodChoice choice = byRules(facts);
  if (facts.baked && choice.method != "frustum") {
    choice.options.emplace_back("visible-sets", "on");
    choice.why += "; the baked sets leave it less to test";
  }
  return choice;
}

void addChoice(Json& json, const Setting& setting) {
  if (setting.choice == nullptr) {
    return;
  }
  const SceneFacts& facts = setting.choice->facts;
  json["chosen"] = {{"by", kAutomaticMethod},
                    {"why", setting.choice->why},
                    {"see_through_share", facts.see_through},
                    {"occluder_area", facts.occluder_area},
                    {"in_frustum", facts.in_frustum}};
}

std::string choiceText(const std::vector<Setting>& settings) {
  for (const Setting& setting : settings) {
    if (setting.choice != nullptr) {
      return fmt::format("auto is {} ({}): {}", methodName(setting), optionsText(setting),
                         setting.choice->why);
    }
  }
  return "";
}

}  // namespace sightline::tool
