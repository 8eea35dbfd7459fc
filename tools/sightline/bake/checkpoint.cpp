// The file: a header, then records, each of a RecordHead and the part's bytes. Little-endian.

#include "tools/sightline/bake/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "sightline/io/file.h"

namespace sightline::tool {
namespace {

constexpr char kMagic[8] = {'S', 'L', 'p', 'a', 'r', 't', 's', '2'};
constexpr std::chrono::seconds kFlushEvery{1};

struct Header {
  char magic[8];
  std::uint64_t plan;
};
static_assert(sizeof(Header) == 16);

struct RecordHead {
  std::uint64_t part;
  std::uint64_t length;
  std::uint64_t checksum;  // of part, length and bytes
};
static_assert(sizeof(RecordHead) == 24);

std::uint64_t checksumOf(std::uint64_t part, const std::byte* bytes, std::uint64_t length) {
  return XXH3_64bits_withSeed(bytes, length, XXH3_64bits_withSeed(&length, sizeof(length), part));
}

// Reads the record at the beginning of `bytes`. Returns its size, or 0 if it is incomplete or broken.
std::size_t readRecord(std::string_view bytes, BakedParts& parts) {
  RecordHead head;
  if (bytes.size() < sizeof(head)) {
    return 0;
  }
  std::memcpy(&head, bytes.data(), sizeof(head));
  const auto* begin = reinterpret_cast<const std::byte*>(bytes.data()) + sizeof(head);
  if (head.length > bytes.size() - sizeof(head) ||
      checksumOf(head.part, begin, head.length) != head.checksum) {
    return 0;
  }
  parts.insert_or_assign(head.part, BakedPart(begin, begin + head.length));
  return sizeof(head) + head.length;
}

}  // namespace

Result<Checkpoint> Checkpoint::open(const std::string& file, CheckpointUse use) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  Checkpoint checkpoint(file, descriptor, use);
  struct stat facts {};
  if (descriptor < 0 || ::fstat(descriptor, &facts) != 0) {
    return checkpoint.failure("cannot be written");
  }
  if (!S_ISREG(facts.st_mode)) {
    return Error{fmt::format("{}: is not a file; the parts of an unfinished bake go there", file)};
  }
  // Where files cannot be locked, nothing prevents two bakes of one output.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(std::exchange(checkpoint.descriptor_,
                          -1));  // the file belongs to the other bake, even if it is empty
    return Error{fmt::format("{}: another bake to the same file is running; wait for it or end it", file)};
  }
  char magic[sizeof(kMagic)] = {};
  const ssize_t read = ::pread(descriptor, magic, sizeof(magic), 0);
  if (read > 0 && std::memcmp(magic, kMagic, static_cast<std::size_t>(read)) != 0) {
    return Error{fmt::format("{}: is not what a bake leaves; remove it, or name another output", file)};
  }
  // A file that is no more than a header was left by a bake that had finished nothing.
  if (use == CheckpointUse::kNew && facts.st_size > static_cast<off_t>(sizeof(Header))) {
    return Error{fmt::format(
        "{}: an unfinished bake left its parts here; go on with --resume, or begin anew with --restart",
        file)};
  }
  return checkpoint;
}

Checkpoint::Checkpoint(Checkpoint&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      use_(other.use_),
      flushed_(other.flushed_) {}

Checkpoint::~Checkpoint() {
  struct stat facts {};
  if (descriptor_ >= 0 && ::fstat(descriptor_, &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_size == 0) {
    ::unlink(file_.c_str());
  }
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

Result<BakedParts> Checkpoint::begin(std::uint64_t plan) {
  BakedParts parts;
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.plan = plan;
  const std::string_view wanted(reinterpret_cast<const char*>(&header), sizeof(header));
  std::size_t whole = 0;
  if (use_ == CheckpointUse::kResume) {
    const Result<std::string> bytes = readFile(file_);
    if (!bytes) {
      return bytes.error();
    }
    // A file that ends within the header was left by a bake that had finished nothing.
    const std::string_view start = std::string_view(*bytes).substr(0, sizeof(header));
    if (start.size() == sizeof(header)) {
      if (start != wanted) {
        return Error{fmt::format(
            "{}: is of another scene or other settings; go on with those, or begin anew with --restart",
            file_)};
      }
      whole = sizeof(header);
      while (const std::size_t record = readRecord(std::string_view(*bytes).substr(whole), parts)) {
        whole += record;
      }
    }
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
    return failure("cannot be written");
  }
  if (whole == 0) {
    if (const Status ok = writeAll(&header, sizeof(header)); !ok) {
      return ok.error();
    }
  }
  return parts;
}

Status Checkpoint::append(std::uint64_t part, const BakedPart& bytes) {
  const RecordHead head{part, bytes.size(), checksumOf(part, bytes.data(), bytes.size())};
  if (const Status ok = writeAll(&head, sizeof(head)); !ok) {
    return ok;
  }
  if (const Status ok = writeAll(bytes.data(), bytes.size()); !ok) {
    return ok;
  }
  return std::chrono::steady_clock::now() - flushed_ < kFlushEvery ? Status(Success{}) : flush();
}

Status Checkpoint::flush() {
  flushed_ = std::chrono::steady_clock::now();
  return ::fdatasync(descriptor_) == 0 ? Status(Success{}) : failure("cannot be written to the disk");
}

Status Checkpoint::remove() {
  return ::unlink(file_.c_str()) == 0 ? Status(Success{}) : failure("cannot be removed");
}

Status Checkpoint::writeAll(const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(descriptor_, next, count);
    if (written < 0 && errno != EINTR) {
      return failure("cannot be written");
    }
    if (written > 0) {
      next += written;
      count -= static_cast<std::size_t>(written);
    }
  }
  return Success{};
}

Error Checkpoint::failure(const std::string& what) const {
  return Error{fmt::format("{}: {}: {}", file_, what, std::strerror(errno))};
}

}  // namespace sightline::tool
