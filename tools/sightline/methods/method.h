#pragma once

// A table of the culling methods: each row has the method's name, the function that makes it and the options
// that it has. Whether it needs occluders or sets is told by the library's MethodTraits.

#include <algorithm>
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
  // Names, in the table of method_options.cpp, of the options that only some methods have, this one included.
  std::vector<std::string_view> options;
  // Groups of statistics that the tool does not show.
  std::vector<std::string_view> hidden_statistics{};

  // Whether it has the option, at least for some values of its other options.
  bool has(std::string_view option) const {
    return std::find(options.begin(), options.end(), option) != options.end();
  }
};

// Returns all methods in the order in which they are listed.
std::span<const Method> allMethods();
// Returns the method of this name. Precondition: there is one.
const Method& methodNamed(std::string_view name);

}  // namespace sightline::tool
