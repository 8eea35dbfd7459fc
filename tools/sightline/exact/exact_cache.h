#pragma once

// Keeps exact visibility from run to run, in a folder with one file for each view.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/scene_id.h"
#include "sightline/scene/camera.h"
#include "tools/sightline/exact/exact_bytes.h"

namespace sightline::tool {

class ExactCache {
 public:
  // folder: is made if it does not exist; empty: nothing is kept and nothing found. Error if it cannot be
  // written to.
  static Result<ExactCache> open(const std::string& folder);
  // $XDG_CACHE_HOME/sightline or ~/.cache/sightline; empty if neither variable is set.
  static std::string usualFolder();

  // Returns what was kept under the key. A file that is damaged or of another key counts as none.
  std::optional<ExactObjects> find(const ExactKey& key) const;
  // Writes the file whole or not at all, over one that is there.
  Status keep(const ExactKey& key, const ExactObjects& frame) const;

  const std::string& folder() const { return folder_; }

 private:
  explicit ExactCache(std::string folder) : folder_(std::move(folder)) {}
  std::string fileOf(const ExactKey& key) const;

  std::string folder_;  // empty: none
};

}  // namespace sightline::tool
