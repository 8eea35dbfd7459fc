#include "tools/sightline/input/doors.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>
#include <string_view>

#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/parse_text.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxListed = 20;  // doors in an error

// Whether the pattern, in which * stands for any text, is the whole name.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0;
  std::optional<std::size_t> star;  // the last * that was passed
  std::size_t after_star = 0;       // where in the name the text after it was tried
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after_star = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p, ++n;
    } else if (star) {
      p = *star + 1;
      n = ++after_star;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

// The objects that a word names.
Result<std::vector<ObjectId>> objectsOf(const std::string& word, const Scene& scene) {
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  if (const std::optional<std::uint32_t> number = parseWhole(word)) {
    if (*number >= count) {
      return Error{fmt::format("--doors {}: the scene has {} objects, from 0 to {}", word, count, count - 1)};
    }
    return std::vector<ObjectId>{ObjectId(*number)};
  }
  std::vector<ObjectId> found;
  for (std::uint32_t object = 0; object < count; ++object) {
    if (!word.empty() && matches(word, scene.object_names[object])) {
      found.push_back(ObjectId(object));
    }
  }
  if (found.empty()) {
    return Error{fmt::format(
        "--doors '{}': no object has this number or name; give numbers or names, where * stands for any "
        "text; `sightline info SCENE --json FILE` lists them",
        word)};
  }
  return found;
}

std::string listOf(std::span<const ObjectId> doors) {
  std::string list;
  for (std::size_t i = 0; i < std::min(doors.size(), kMaxListed); ++i) {
    list += (i > 0 ? ", " : "") + std::to_string(doors[i].value);
  }
  return list + (doors.size() > kMaxListed ? ", ..." : "");
}

}  // namespace

void addClosedOption(CLI::App& command, std::string& closed) {
  command
      .add_option(
          "--closed", closed,
          "doors of the baked file that are closed, by number (several: a,b,c), or all; the others are "
          "open and hide nothing")
      ->check(isNotEmpty());
}

Result<std::vector<std::vector<ObjectId>>> doorsOf(const std::string& text, const Scene& scene) {
  std::vector<std::vector<ObjectId>> groups;
  if (text.empty()) {
    return groups;
  }
  for (const std::string& item : splitAt(text, ',')) {
    const std::vector<std::string> words = splitAt(item, '+');
    std::vector<ObjectId> group;
    for (const std::string& word : words) {
      const Result<std::vector<ObjectId>> objects = objectsOf(word, scene);
      if (!objects) {
        return objects.error();
      }
      group.insert(group.end(), objects->begin(), objects->end());
    }
    if (words.size() > 1) {
      groups.push_back(std::move(group));
      continue;
    }
    for (const ObjectId door : group) {
      groups.push_back({door});
    }
  }
  return groups;
}

Result<std::vector<ObjectId>> closedDoors(const std::string& text, const SightFile& baked,
                                          const std::string& name) {
  std::vector<ObjectId> closed;
  if (text.empty()) {
    return closed;
  }
  const std::vector<ObjectId> all = allDoors(baked.doors());
  if (all.empty()) {
    return Error{fmt::format("--closed {}: {} has no doors; bake it with --doors", text, name)};
  }
  if (text == "all") {
    return all;
  }
  for (const std::string& word : splitAt(text, ',')) {
    const std::optional<std::uint32_t> number = parseWhole(word);
    if (!number || !std::binary_search(all.begin(), all.end(), ObjectId(*number))) {
      return Error{fmt::format("--closed '{}': is no door of {}; its doors are {}", word, name, listOf(all))};
    }
    closed.push_back(ObjectId(*number));
  }
  std::sort(closed.begin(), closed.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  return closed;
}

void openOtherDoors(const DoorsView& doors, std::span<const ObjectId> closed, Scene& scene) {
  for (const ObjectId door : doors.doors) {
    if (!std::binary_search(closed.begin(), closed.end(), door)) {
      scene.objects[door.value].mark = OccluderMark::kNever;
    }
  }
}

Status readSeen(const SightFile& baked, std::uint32_t set, std::span<const ObjectId> closed,
                std::vector<std::uint8_t>& is_seen) {
  const BoxTreeView boxes = baked.boxes();
  is_seen.assign(boxes.objects.size(), 0);
  std::vector<std::uint32_t> nodes;
  const auto mark = [&](std::uint32_t one, std::uint8_t flag) {
    nodes.clear();
    const Status ok = baked.readSet(one, nodes);
    for (const std::uint32_t node : nodes) {
      const BoxNode& n = boxes.nodes[node];
      std::fill_n(is_seen.begin() + n.first_object, n.object_count, flag);
    }
    return ok;
  };
  if (const Status ok = mark(set, 1); !ok) {
    return ok;
  }
  const DoorsView doors = baked.doors();
  for (const DoorSet& door : doors.hiddenOf(set)) {
    if (!isClosed(doors, door.group, closed)) {
      continue;
    }
    if (const Status ok = mark(door.hidden, 0); !ok) {
      return ok;
    }
  }
  return Success{};
}

}  // namespace sightline::tool
