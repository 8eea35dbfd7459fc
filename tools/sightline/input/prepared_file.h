#pragma once

// What preparing a scene makes, in a file, so that the next start need not make it again.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/base/result.h"
#include "sightline/pvs/format/scene_id.h"

namespace sightline::tool {

class PreparedFile {
 public:
  PreparedFile() = default;  // none: nothing is found and nothing is kept

  // The file of this name; empty: none. Where there is no such file, or one of another scene or version, or
  // another crack_width (metres), or a damaged one, nothing will be found, and stderr says why. Error if the
  // file is something else, which must not be written over.
  static Result<PreparedFile> open(const std::string& name, const SceneView& scene, double crack_width);

  // What the file has under a name of at most 15 letters, if from(bytes) can read it. If not, what make()
  // returns, which keep() is going to write as to_bytes(made).
  template <typename Make, typename From, typename ToBytes>
  auto get(const std::string& name, Make&& make, From&& from, ToBytes&& to_bytes) {
    if (const std::optional<SharedBytes> bytes = find(name)) {
      if (auto found = from(*bytes)) {
        return std::move(*found);
      } else {
        refuse(found.error().message);
      }
    }
    auto made = make();
    if (!name_.empty()) {
      add(name, to_bytes(made));
    }
    return made;
  }
  // If get() has made something, writes the file whole or not at all, with what it had before. A failure is
  // told on stderr and changes nothing else.
  void keep();

 private:
  PreparedFile(std::string name, const SceneId& scene, double crack_width)
      : name_(std::move(name)), scene_(scene), crack_width_(crack_width) {}

  struct Section {
    std::string name;
    SharedBytes bytes;
    std::optional<std::uint64_t> checksum{};  // that the bytes must have, if that is not known yet
  };

  // Maps the file, if there is one, and reads which sections it has.
  Status map();
  // Why the sections of the file cannot be used; empty if they can.
  std::string read(const SharedBytes& file);
  std::optional<SharedBytes> find(const std::string& name);
  void add(const std::string& name, LargeVector<std::byte> bytes);
  void refuse(const std::string& reason) const;

  std::string name_;
  SceneId scene_{};
  double crack_width_ = 0.0;  // with which the scene's cracks were closed, metres
  std::vector<Section> sections_;
  bool grown_ = false;  // since it was read or written
};

}  // namespace sightline::tool
