// Parses the URLs of the procedural scenes.

#include "scenes/procedural.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenes/boiler_house.h"
#include "scenes/glass.h"
#include "scenes/landscapes.h"
#include "scenes/moving_scene.h"

namespace sightline {
namespace {

constexpr std::string_view kPrefix = "demo:";

// A key of a scene's URL: its value is a number, or one of several words.
struct Key {
  std::string_view name;
  std::uint32_t min, max;
  std::uint32_t* value;                          // the number, or the index of the word
  std::span<const std::string_view> words = {};  // if not empty, min and max are ignored
  bool given = false;
};

std::string choiceOf(const Key& key) {
  std::string choice;
  for (const std::string_view word : key.words) {
    choice += (choice.empty() ? "" : " or ") + std::string(word);
  }
  return key.words.empty() ? std::to_string(key.min) + " to " + std::to_string(key.max) : choice;
}

std::string listOf(std::span<const Key> keys) {
  std::string list;
  for (const Key& key : keys) {
    list += (list.empty() ? "" : ", ") + std::string(key.name) + " (" + choiceOf(key) + ")";
  }
  return list;
}

// Parses the value of a key; returns false if it is invalid.
bool readValue(std::string_view text, const Key& key) {
  if (!key.words.empty()) {
    const auto word = std::find(key.words.begin(), key.words.end(), text);
    *key.value = static_cast<std::uint32_t>(word - key.words.begin());
    return word != key.words.end();
  }
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  *key.value = static_cast<std::uint32_t>(number);
  return error == std::errc() && end == text.data() + text.size() && number >= key.min && number <= key.max;
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
    if (!readValue(text, key)) {
      return Error{where + "'" + std::string(text) + "' is no value for '" + std::string(name) + "'; give " +
                   (key.words.empty() ? "a whole number from " : "") + choiceOf(key)};
    }
    key.given = true;
    return Success{};
  }
  return Error{where + "unknown key '" + std::string(name) + "'; keys: " + listOf(keys)};
}

// Parses the part of a URL after the '?'.
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
  static constexpr std::string_view kDoors[] = {"ajar", "shut"};
  BuildingOptions options;
  std::uint32_t doors = 0;
  Key keys[] = {{"floors", 1, 20, &options.floors},
                {"plants", 0, 10000, &options.plants},
                {"doors", 0, 0, &doors, kDoors},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "building", keys);
  options.shut_doors = doors == 1;
  return status ? Result<Scene>(makeBuilding(options)) : status.error();
}

Result<Scene> makeDemoBoxes(std::string_view query) {
  static constexpr std::string_view kQuarters[] = {"open", "walled"};
  BoxCityOptions options;
  std::uint32_t quarters = 0;
  Key keys[] = {{"buildings", 1, 100000, &options.buildings},
                {"boxes", 0, 1000000, &options.boxes},
                {"quarters", 0, 0, &quarters, kQuarters},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "boxes", keys);
  options.walled = quarters == 1;
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

Result<Scene> makeDemoGlass(std::string_view query) {
  GlassOptions options;
  Key keys[] = {{"panes", 0, 10000, &options.panes},
                {"bottles", 0, 10000, &options.bottles},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "glass", keys);
  return status ? Result<Scene>(makeGlass(options)) : status.error();
}

Result<Scene> makeDemoTerrain(std::string_view query) {
  TerrainOptions options;
  Key keys[] = {{"triangles", 10000, 10000000, &options.triangles}, {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "terrain", keys);
  return status ? Result<Scene>(makeTerrain(options)) : status.error();
}

Result<Scene> makeDemoCave(std::string_view query) {
  CaveOptions options;
  Key keys[] = {{"halls", 4, 100, &options.halls},
                {"triangles", 10000, 400000, &options.triangles},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "cave", keys);
  return status ? Result<Scene>(makeCave(options)) : status.error();
}

Result<Scene> makeDemoVoxels(std::string_view query) {
  VoxelOptions options;
  Key keys[] = {{"halls", 4, 100, &options.halls}, {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "voxels", keys);
  return status ? Result<Scene>(makeVoxels(options)) : status.error();
}

Result<Scene> makeDemoVillage(std::string_view query) {
  VillageOptions options;
  Key keys[] = {{"houses", 1, 1000, &options.houses}, {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "village", keys);
  return status ? Result<Scene>(makeVillage(options)) : status.error();
}

Result<Scene> makeDemoJungle(std::string_view query) {
  JungleOptions options;
  Key keys[] = {{"buttes", 0, 100, &options.buttes},
                {"trees", 0, 10000, &options.trees},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "jungle", keys);
  return status ? Result<Scene>(makeJungle(options)) : status.error();
}

Result<Scene> makeDemoBoilerHouse(std::string_view query) {
  BoilerHouseOptions options;
  Key keys[] = {{"boilers", 1, 50, &options.boilers},
                {"pipes", 0, 20000, &options.pipes},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "boilerhouse", keys);
  return status ? Result<Scene>(makeBoilerHouse(options)) : status.error();
}

Result<MovingScene> makeDemoToothpicks(std::string_view query) {
  static constexpr std::string_view kScalings[] = {"us", "ud"};
  ToothpickOptions options;
  std::uint32_t scaling = 0;
  Key keys[] = {{"n", 1, 100000, &options.count},
                {"scaling", 0, 0, &scaling, kScalings},
                {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "toothpicks", keys);
  options.uniform_density = scaling == 1;
  return status ? Result<MovingScene>(makeToothpicks(options)) : status.error();
}

Result<MovingScene> makeDemoCanyon(std::string_view query) {
  CanyonOptions options;
  Key keys[] = {{"grid", 1, 100, &options.grid}, {"seed", 0, kAnySeed, &options.seed}};
  const Status status = readQuery(query, "canyon", keys);
  return status ? Result<MovingScene>(makeCanyon(options)) : status.error();
}

template <typename S>
struct Maker {
  std::string_view name;
  Result<S> (*make)(std::string_view query);
};
constexpr Maker<Scene> kStillScenes[] = {{"city", makeDemoCity},
                                         {"building", makeDemoBuilding},
                                         {"boxes", makeDemoBoxes},
                                         {"ship", makeDemoShip},
                                         {"glass", makeDemoGlass},
                                         {"terrain", makeDemoTerrain},
                                         {"cave", makeDemoCave},
                                         {"village", makeDemoVillage},
                                         {"jungle", makeDemoJungle},
                                         {"voxels", makeDemoVoxels},
                                         {"boilerhouse", makeDemoBoilerHouse}};
constexpr Maker<MovingScene> kMovingScenes[] = {{"toothpicks", makeDemoToothpicks},
                                                {"canyon", makeDemoCanyon}};

// Splits a URL without its prefix into the scene's name and the part after the '?'.
std::pair<std::string_view, std::string_view> split(std::string_view url) {
  const std::string_view rest = url.substr(std::min(kPrefix.size(), url.size()));
  const std::size_t mark = rest.find('?');
  return {rest.substr(0, mark), mark == std::string_view::npos ? std::string_view() : rest.substr(mark + 1)};
}

template <typename S>
const Maker<S>* find(std::span<const Maker<S>> makers, std::string_view name) {
  const auto found =
      std::find_if(makers.begin(), makers.end(), [&](const Maker<S>& m) { return m.name == name; });
  return found == makers.end() ? nullptr : &*found;
}

template <typename S>
std::string namesOf(std::span<const Maker<S>> makers) {
  std::string names;
  for (const Maker<S>& maker : makers) {
    names += (names.empty() ? "" : ", ") + std::string(maker.name);
  }
  return names;
}

}  // namespace

bool isDemoUrl(std::string_view url) {
  return url.substr(0, kPrefix.size()) == kPrefix;
}

bool isMovingDemoUrl(std::string_view url) {
  return isDemoUrl(url) && find<MovingScene>(kMovingScenes, split(url).first) != nullptr;
}

Result<MovingScene> makeMovingDemoScene(std::string_view url) {
  const auto [name, query] = split(url);
  const Maker<MovingScene>* maker = isDemoUrl(url) ? find<MovingScene>(kMovingScenes, name) : nullptr;
  if (maker == nullptr) {
    return Error{"'" + std::string(url) + "' is no demo scene with moving parts; there are " +
                 namesOf<MovingScene>(kMovingScenes) + ", as demo:toothpicks?n=200"};
  }
  return maker->make(query);
}

Result<Scene> makeDemoScene(std::string_view url) {
  if (!isDemoUrl(url)) {
    return Error{"'" + std::string(url) +
                 "' is no demo scene; its URL begins with demo:, as demo:city?copies=30"};
  }
  const auto [name, query] = split(url);
  if (const Maker<Scene>* maker = find<Scene>(kStillScenes, name)) {
    return maker->make(query);
  }
  if (const Maker<MovingScene>* maker = find<MovingScene>(kMovingScenes, name)) {
    Result<MovingScene> moving = maker->make(query);
    return moving ? Result<Scene>(std::move(moving->scene)) : moving.error();
  }
  return Error{"unknown demo scene '" + std::string(name) + "'; scenes: " + namesOf<Scene>(kStillScenes) +
               ", " + namesOf<MovingScene>(kMovingScenes)};
}

}  // namespace sightline
