#include "tools/sightline/bake/mpi_world.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>

namespace sightline::tool {
namespace {

constexpr std::chrono::milliseconds kNap{1};  // between polls for a message

constexpr int kFarewell = 1000;  // the tag of the last message; no other message has it

// The environment variables by which Open MPI, MPICH and its derivatives, and PMIx number their processes.
constexpr const char* kRankVariables[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"};

const char* rankOfLauncher() {
  for (const char* variable : kRankVariables) {
    if (const char* rank = std::getenv(variable)) {
      return rank;
    }
  }
  return nullptr;
}

}  // namespace

struct MpiWorld::Sending {
  std::vector<std::byte> bytes;
  MPI_Request request{};
};

bool isOtherMpiProcess() {
  const char* rank = rankOfLauncher();
  return rank != nullptr && std::strcmp(rank, "0") != 0;
}

MpiWorld::MpiWorld() {
  if (rankOfLauncher() == nullptr) {
    return;
  }
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  started_ = true;
}

MpiWorld::~MpiWorld() {
  if (!started_) {
    return;
  }
  // MPI_Finalize waits for all processes and occupies a core meanwhile, so it is called when all are ready.
  for (int other = 1; first() && other < size_; ++other) {
    send(other, kFarewell, {});
  }
  while (!first() && wait().tag != kFarewell) {
  }
  for (Sending& sending : sending_) {
    MPI_Wait(&sending.request, MPI_STATUS_IGNORE);
  }
  MPI_Finalize();
}

bool MpiWorld::send(int to, int tag, std::span<const std::byte> bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return false;
  }
  Sending& sending = sending_.emplace_back();
  sending.bytes.assign(bytes.begin(), bytes.end());
  MPI_Isend(sending.bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD,
            &sending.request);
  return true;
}

void MpiWorld::forgetSent() {
  std::erase_if(sending_, [](Sending& sending) {
    int sent = 0;
    MPI_Test(&sending.request, &sent, MPI_STATUS_IGNORE);
    return sent != 0;
  });
}

std::optional<MpiWorld::Message> MpiWorld::receive() {
  if (size_ == 1) {
    return std::nullopt;
  }
  forgetSent();
  int here = 0, count = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &here, &status);
  if (here == 0) {
    return std::nullopt;
  }
  MPI_Get_count(&status, MPI_BYTE, &count);
  Message message{status.MPI_SOURCE, status.MPI_TAG, std::vector<std::byte>(static_cast<std::size_t>(count))};
  MPI_Recv(message.bytes.data(), count, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

MpiWorld::Message MpiWorld::wait() {
  for (;;) {
    if (std::optional<Message> message = receive()) {
      return std::move(*message);
    }
    std::this_thread::sleep_for(kNap);
  }
}

void MpiWorld::abort(int exit_code) {
  if (started_) {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
  }
  std::_Exit(exit_code);
}

MessageWriter& MessageWriter::number(std::uint64_t value) {
  return rest(std::as_bytes(std::span(&value, 1)));
}

MessageWriter& MessageWriter::text(const std::string& value) {
  return block(std::as_bytes(std::span(value)));
}

MessageWriter& MessageWriter::block(std::span<const std::byte> value) {
  return number(value.size()).rest(value);
}

MessageWriter& MessageWriter::rest(std::span<const std::byte> value) {
  bytes_.insert(bytes_.end(), value.begin(), value.end());
  return *this;
}

std::uint64_t MessageReader::number() {
  std::uint64_t value = 0;
  if (left_.size() < sizeof(value)) {
    left_ = {};
    return 0;
  }
  std::memcpy(&value, left_.data(), sizeof(value));
  left_ = left_.subspan(sizeof(value));
  return value;
}

std::string MessageReader::text() {
  const std::span<const std::byte> value = block();
  return {reinterpret_cast<const char*>(value.data()), value.size()};
}

std::span<const std::byte> MessageReader::block() {
  const std::uint64_t size = number();
  const std::span<const std::byte> value = left_.first(std::min<std::size_t>(size, left_.size()));
  left_ = left_.subspan(value.size());
  return value;
}

}  // namespace sightline::tool
