#pragma once

// The methods of culling, one row each: name, what makes it, and which options it has. What a method needs
// (occluders, sets) is asked of the library.

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sightline/culling/culling_method.h"

namespace sightline::tool {

struct Setting;

struct Method {
  std::string_view name;  // on the command line and in JSON
  MethodTraits traits;
  std::unique_ptr<CullingMethod> (*make)(const Setting& setting);
  // The options that this method has beyond those that all methods, and all methods with occluders, have:
  // names in the table of method_options.cpp.
  std::vector<std::string_view> options;
  // Groups of its statistics that are for the library's users alone.
  std::vector<std::string_view> hidden_statistics{};
};

// In the order in which they are listed.
std::span<const Method> allMethods();
// One of their names.
const Method& methodNamed(std::string_view name);

}  // namespace sightline::tool
