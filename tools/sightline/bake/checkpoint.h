#pragma once

// The parts that an unfinished bake has baked, in a file beside its output: each is there whole or not at
// all, whenever the process ends.

#include <chrono>
#include <cstdint>
#include <string>

#include "sightline/base/result.h"
#include "sightline/pvs/bake/bake.h"

namespace sightline::tool {

enum class CheckpointUse : std::uint8_t {
  kNew,      // an error where there is one
  kResume,   // goes on from it, if there is one
  kRestart,  // begins anew
};

class Checkpoint {
 public:
  // Opens or makes the file, and locks it as long as this lives: two bakes of one output are an error.
  // Changes nothing in it yet.
  static Result<Checkpoint> open(const std::string& file, CheckpointUse use);
  Checkpoint(Checkpoint&& other) noexcept;
  Checkpoint& operator=(Checkpoint&&) = delete;
  ~Checkpoint();  // an empty file is removed

  // The parts that are in it. An error where it was made by another plan. What follows a broken record is
  // dropped. To be called once, before append.
  Result<BakedParts> begin(std::uint64_t plan);

  // Survives the process at once, the machine after the next flush: one a second at most is made here.
  Status append(std::uint64_t part, const BakedPart& bytes);
  Status flush();   // on the disk
  Status remove();  // the bake is complete

 private:
  Checkpoint(std::string file, int descriptor, CheckpointUse use)
      : file_(std::move(file)), descriptor_(descriptor), use_(use) {}
  Status writeAll(const void* bytes, std::size_t count);
  Error failure(const std::string& what) const;  // with the reason in errno

  std::string file_;
  int descriptor_ = -1;
  CheckpointUse use_;
  std::chrono::steady_clock::time_point flushed_{};
};

}  // namespace sightline::tool
