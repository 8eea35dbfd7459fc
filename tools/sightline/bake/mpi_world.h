#pragma once

// The processes of one bake, started by mpirun or the like; one process alone where they were not.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightline::tool {

// Whether this process is one that an MPI launcher started and that is not the first: it prints nothing.
bool isOtherMpiProcess();

// Messages between processes. By the main thread only; there is one MpiWorld at a time. Sending may wait for
// the receiver; receiving never waits, so that waiting costs no core.
class MpiWorld {
 public:
  // Calls MPI only if a launcher started the process.
  MpiWorld();
  ~MpiWorld();  // the others sleep here until the first gets here
  MpiWorld(const MpiWorld&) = delete;
  MpiWorld& operator=(const MpiWorld&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool first() const { return rank_ == 0; }

  struct Message {
    int from = 0, tag = 0;
    std::vector<std::byte> bytes;
  };
  // False where there are more than 2^31 - 1 bytes, of which none are sent then.
  bool send(int to, int tag, std::span<const std::byte> bytes);
  std::optional<Message> receive();  // the next one that is here
  Message wait();                    // the next one; sleeps until it is here

  // Ends all processes at once, without a word of its own.
  [[noreturn]] void abort(int exit_code);

 private:
  bool started_ = false;
  int rank_ = 0, size_ = 1;
};

// Plain numbers and texts one after the other, as messages hold them. Processes are of one kind of machine.
class MessageWriter {
 public:
  MessageWriter& number(std::uint64_t value);
  MessageWriter& text(const std::string& value);
  MessageWriter& rest(std::span<const std::byte> value);
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> bytes) : left_(bytes) {}
  std::uint64_t number();  // beyond the end: 0
  std::string text();
  std::span<const std::byte> rest() const { return left_; }

 private:
  std::span<const std::byte> left_;
};

}  // namespace sightline::tool
