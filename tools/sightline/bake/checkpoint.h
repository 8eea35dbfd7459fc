#pragma once

// Keeps the finished parts of a bake in a file beside its output, and not in memory. Whenever the process
// ends, each part is there whole or not at all. Whatever happens to the file, no altered part comes back.

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/bake/bake.h"

namespace sightline::tool {

enum class CheckpointUse : std::uint8_t {
  kNew,      // error if there is a checkpoint
  kResume,   // continues from the checkpoint, if there is one
  kRestart,  // discards the checkpoint
};

// What an earlier run left.
struct KeptParts {
  std::vector<std::uint64_t> parts{};  // ids, ascending
  std::uint64_t unreadable = 0;        // further parts, of which the file has not the bytes that were written
  bool damaged = false;                // by more than an end that is missing
  bool no_header = false;              // the file has a beginning, but ends within its header
};

// A line that says what of the file could not be read; empty if all could.
std::string lossText(const std::string& file, const KeptParts& kept);

class Checkpoint {
 public:
  // Opens or makes the file, and locks it as long as this object lives: two bakes of one output are an error.
  // Does not change the file's content.
  static Result<Checkpoint> open(const std::string& file, CheckpointUse use);
  Checkpoint(Checkpoint&& other) noexcept;
  Checkpoint& operator=(Checkpoint&&) = delete;
  ~Checkpoint();  // an empty file is removed

  // Finds the parts in the file and leaves the file with those alone: what is cut off or altered is dropped
  // and counted. Error if the file was made by another plan. Called once, before append().
  Result<KeptParts> begin(std::uint64_t plan);

  // Reads a part that is in the file; nothing if there is none, or if its bytes are not those that were
  // written.
  std::optional<BakedPart> read(std::uint64_t part) const;

  // Appends a part. It survives the end of the process at once, and a crash of the machine after the next
  // flush, of which this function makes at most one a second.
  Status append(std::uint64_t part, const BakedPart& bytes);
  Status flush();   // writes everything to the disk
  Status remove();  // called when the bake is complete

 private:
  Checkpoint(std::string file, int descriptor, CheckpointUse use)
      : file_(std::move(file)), descriptor_(descriptor), use_(use) {}
  // Where the record of a part is in the file, and how many bytes the part has.
  struct Place {
    std::uint64_t offset = 0, length = 0;
  };

  // Finds all whole records behind the header of a file of this size and moves them together. Returns the end
  // of the last one.
  Result<std::uint64_t> gather(std::uint64_t size, KeptParts& kept);
  Status writeRecord(std::uint64_t part, const BakedPart& bytes);
  Status writeAll(const void* bytes, std::size_t count);
  Error failure(const std::string& what) const;  // adds the reason from errno

  std::string file_;
  int descriptor_ = -1;
  CheckpointUse use_;
  std::map<std::uint64_t, Place> places_;  // by part: its last record
  std::uint64_t size_ = 0;                 // of the file, bytes
  std::chrono::steady_clock::time_point flushed_{};
};

}  // namespace sightline::tool
