// The URLs of the procedural scenes.

#include "scenes/procedural.h"

#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightline {
namespace {

constexpr std::string_view kPrefix = "demo:";

// A number that a scene's URL may give.
struct Key {
  std::string_view name;
  std::uint32_t min, max;
  std::uint32_t* value;
  bool given = false;
};

std::string listOf(std::span<const Key> keys) {
  std::string list;
  for (const Key& key : keys) {
    list += (list.empty() ? "" : ", ") + std::string(key.name) + " (" + std::to_string(key.min) + " to " +
            std::to_string(key.max) + ")";
  }
  return list;
}

Status readPair(std::string_view pair, std::string_view scene, std::span<Key> keys) {
  const std::size_t equals = pair.find('=');
  const std::string_view name = pair.substr(0, equals);
  const std::string where = std::string(kPrefix) + std::string(scene) + ": ";
  if (equals == std::string_view::npos) {
    return Error{where + "'" + std::string(pair) + "' is not of the form key=number; keys: " + listOf(keys)};
  }
  const std::string_view text = pair.substr(equals + 1);
  for (Key& key : keys) {
    if (key.name != name) {
      continue;
    }
    if (key.given) {
      return Error{where + "the key '" + std::string(name) + "' is given twice; give it once"};
    }
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || number < key.min || number > key.max) {
      return Error{where + "'" + std::string(text) + "' is no value for '" + std::string(name) +
                   "'; give a whole number from " + std::to_string(key.min) + " to " +
                   std::to_string(key.max)};
    }
    *key.value = static_cast<std::uint32_t>(number);
    key.given = true;
    return Success{};
  }
  return Error{where + "unknown key '" + std::string(name) + "'; keys: " + listOf(keys)};
}

// The part of a URL behind the '?'.
Status readQuery(std::string_view query, std::string_view scene, std::span<Key> keys) {
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const Status status = readPair(query.substr(0, end), scene, keys);
    if (!status) {
      return status;
    }
    query = end == std::string_view::npos ? std::string_view() : query.substr(end + 1);
  }
  return Success{};
}

constexpr std::uint32_t kAnySeed = 0xffffffffu;

Result<Scene> makeDemoCity(std::string_view query) {
  CityOptions options;
  Key keys[] = {{"copies", 1, 2000, &options.copies}, {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "city", keys);
  return status ? Result<Scene>(makeCity(options)) : status.error();
}

Result<Scene> makeDemoBuilding(std::string_view query) {
  BuildingOptions options;
  Key keys[] = {{"floors", 1, 20, &options.floors},
                {"plants", 0, 10000, &options.plants},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "building", keys);
  return status ? Result<Scene>(makeBuilding(options)) : status.error();
}

Result<Scene> makeDemoBoxes(std::string_view query) {
  BoxCityOptions options;
  Key keys[] = {{"buildings", 1, 100000, &options.buildings},
                {"boxes", 0, 1000000, &options.boxes},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "boxes", keys);
  return status ? Result<Scene>(makeBoxCity(options)) : status.error();
}

Result<Scene> makeDemoShip(std::string_view query) {
  ShipOptions options;
  Key keys[] = {{"decks", 3, 12, &options.decks},
                {"rooms", 4, 16, &options.rooms},
                {"machinery", 0, 1000, &options.machinery},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "ship", keys);
  return status ? Result<Scene>(makeShip(options)) : status.error();
}

}  // namespace

bool isDemoUrl(std::string_view url) {
  return url.substr(0, kPrefix.size()) == kPrefix;
}

Result<Scene> makeDemoScene(std::string_view url) {
  if (!isDemoUrl(url)) {
    return Error{"'" + std::string(url) +
                 "' is no demo scene; its URL begins with demo:, as demo:city?copies=30"};
  }
  const std::string_view rest = url.substr(kPrefix.size());
  const std::size_t mark = rest.find('?');
  const std::string_view scene = rest.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? std::string_view() : rest.substr(mark + 1);
  if (scene == "city") {
    return makeDemoCity(query);
  }
  if (scene == "building") {
    return makeDemoBuilding(query);
  }
  if (scene == "boxes") {
    return makeDemoBoxes(query);
  }
  if (scene == "ship") {
    return makeDemoShip(query);
  }
  return Error{"unknown demo scene '" + std::string(scene) + "'; scenes: city, building, boxes, ship"};
}

}  // namespace sightline
