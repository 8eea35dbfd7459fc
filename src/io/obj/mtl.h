#pragma once

// Materials of .mtl files.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/material.h"

namespace sightline::io {

// The colour of a material that states none.
inline constexpr float kMtlColor = 0.6f;

class MtlMaterials {
 public:
  // Adds the materials of a file. What lets light through makes a material blended: d or Tr, Tf below 1,
  // illum 6, 7 or 9. A picture of its opacity (map_d, map_Tr, map_opacity) makes it alpha-tested. Other
  // statements than these and Kd are skipped. If a material is defined several times, it is as little opaque
  // as any of them says.
  Status read(std::string_view bytes, const std::string& name);

  const std::vector<Material>& all() const { return materials_; }
  // The number of the material that a usemtl statement with this value means, or -1. A comment may follow the
  // name, there or where it is defined; but names may have a '#' in them too, and a whole one comes first.
  std::int64_t find(std::string_view value) const;

 private:
  std::vector<Material> materials_;
  std::map<std::string, std::int64_t> by_name_;
  // By what is left of a name without what may be a comment; -1 for several materials.
  std::map<std::string, std::int64_t> by_beginning_;
};

// The names of pictures in a file, each as what follows the keyword: options and a name.
std::vector<std::string> picturesOfMtl(std::string_view bytes);

}  // namespace sightline::io
