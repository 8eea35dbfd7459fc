#pragma once

// The processes of one bake, started by mpirun or a similar launcher; without a launcher a single process.

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightline::tool {

// Whether an MPI launcher started this process and it is not the first one. Such a process prints nothing.
bool isOtherMpiProcess();

// Sends messages between processes. For the main thread only; there is one MpiWorld at a time. Sending does
// not wait for the receiver. Receiving polls, so that waiting for a message costs no core.
class MpiWorld {
 public:
  // Calls MPI only if a launcher started the process.
  MpiWorld();
  ~MpiWorld();  // the other processes sleep here until the first one gets here
  MpiWorld(const MpiWorld&) = delete;
  MpiWorld& operator=(const MpiWorld&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool first() const { return rank_ == 0; }

  struct Message {
    int from = 0, tag = 0;
    std::vector<std::byte> bytes;
  };
  // False, with nothing sent, if there are more than 2^31 - 1 bytes.
  bool send(int to, int tag, std::span<const std::byte> bytes);
  std::optional<Message> receive();  // the next message that has arrived, if any
  Message wait();                    // the next message; sleeps until it arrives

  // Ends all processes at once and prints nothing.
  [[noreturn]] void abort(int exit_code);

 private:
  struct Sending;
  void forgetSent();

  std::list<Sending> sending_;  // messages that may not have been received yet
  bool started_ = false;
  int rank_ = 0, size_ = 1;
};

// Writes numbers and texts one after another, in the byte order of the machine: all processes run on machines
// of one kind.
class MessageWriter {
 public:
  MessageWriter& number(std::uint64_t value);
  MessageWriter& text(const std::string& value);
  MessageWriter& block(std::span<const std::byte> value);  // with its size
  MessageWriter& rest(std::span<const std::byte> value);
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> bytes) : left_(bytes) {}
  std::uint64_t number();  // 0 beyond the end
  std::string text();
  std::span<const std::byte> block();  // what is left if it is not as long as it says
  std::span<const std::byte> rest() const { return left_; }

 private:
  std::span<const std::byte> left_;
};

}  // namespace sightline::tool
