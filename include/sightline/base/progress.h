#pragma once

#include <functional>

namespace sightline {

// Called by long work with the finished fraction, 0 to 1, ascending: from any thread, but never from two at
// once. Empty: nobody looks.
using Progress = std::function<void(double fraction)>;

}  // namespace sightline
