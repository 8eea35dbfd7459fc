#pragma once

// What the options of `layers` ask for together: which of them do not go with each other, which files they
// name, and which parts they need sorted.

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/base/result.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/layers/layers_options.h"

namespace sightline::tool {

// Which parts --parts sorts.
enum class PartChoice : std::uint8_t { kAll, kSeeThrough };
inline constexpr std::array<Name<PartChoice>, 2> kPartChoices{{
    {"all", PartChoice::kAll},
    {"see-through", PartChoice::kSeeThrough},
}};
PartChoice partChoiceOf(const LayersOptions& options);

// Whether there are drawings with outlines, whose order may be one by outlines.
bool isDrawn(const LayersOptions& options);

// Checks what can be checked before the scene is read.
Status checkLayersOptions(const LayersOptions& options);
// Checks the files of each frame, whose names are known once the camera path has been read.
Status checkFilesOfFrames(const LayersOptions& options, const std::vector<std::uint32_t>& frames);

}  // namespace sightline::tool
