#pragma once

// Doors on the command line: which objects are doors of a bake, and which doors of a baked file are closed.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"

namespace CLI {
class App;
}

namespace sightline::tool {

// --closed, for commands that read a baked file.
void addClosedOption(CLI::App& command, std::string& closed);

// The groups of doors that --doors names, for BakeSettings::doors. The text is a list, separated by commas,
// of objects by number or by name, where * stands for any text; each is a door by itself, and those that are
// joined by + are one group. None if it is empty.
Result<std::vector<std::vector<ObjectId>>> doorsOf(const std::string& text, const Scene& scene);

// The doors of the file that --closed names, ascending: a list of numbers, or `all`. None if it is empty.
// name: of the file, for errors.
Result<std::vector<ObjectId>> closedDoors(const std::string& text, const SightFile& baked,
                                          const std::string& name);

// Makes all other doors of the file open: in the scene, nothing is hidden by them any more.
void openOtherDoors(const DoorsView& doors, std::span<const ObjectId> closed, Scene& scene);

// Says for each place in BoxTree::objects, with 1, that its object is in the set while exactly these doors
// are closed, ascending. Error if a set is corrupt.
Status readSeen(const SightFile& baked, std::uint32_t set, std::span<const ObjectId> closed,
                std::vector<std::uint8_t>& is_seen);

}  // namespace sightline::tool
