#pragma once

#include <functional>
#include <string_view>

namespace sightline {

// Called now and then from long operations with the stage's name and the done fraction in [0, 1]. May be
// empty.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace sightline
