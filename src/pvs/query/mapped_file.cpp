#include "src/pvs/query/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace sightline::pvs {
namespace {

// Closes the file in its destructor.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) {
      ::close(number_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

Error unreadable() {
  return Error{std::string("cannot be read: ") + std::strerror(errno)};
}

}  // namespace

MappedFile::~MappedFile() {
  if (begin_ != nullptr) {
    ::munmap(const_cast<std::byte*>(begin_), size_);
  }
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(size_, other.size_);
  return *this;
}

Result<MappedFile> MappedFile::open(const std::string& file, Pages pages) {
  // Opens without blocking; otherwise a pipe without a writer would block forever.
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (descriptor.number() < 0 || ::fstat(descriptor.number(), &status) != 0) {
    return unreadable();
  }
  if (!S_ISREG(status.st_mode)) {
    return Error{"cannot be read: it is not a regular file"};
  }
  MappedFile mapped;
  if (status.st_size == 0) {
    return mapped;
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  // No memory is reserved for copies of pages, because the file may be larger than memory.
  const int access = pages == Pages::kReadOnly ? PROT_READ : PROT_READ | PROT_WRITE;
  void* begin = ::mmap(nullptr, size, access, MAP_PRIVATE | MAP_NORESERVE, descriptor.number(), 0);
  if (begin == MAP_FAILED) {
    return unreadable();
  }
  mapped.begin_ = static_cast<const std::byte*>(begin);
  mapped.size_ = size;
  return mapped;
}

void MappedFile::release(std::span<const std::byte> part) const {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = static_cast<std::size_t>(part.data() - begin_);
  // The pages at both ends stay, since they may hold other bytes that are in use.
  const std::size_t first = (begin + page - 1) / page * page, last = (begin + part.size()) / page * page;
  if (first < last) {
    ::madvise(const_cast<std::byte*>(begin_) + first, last - first, MADV_DONTNEED);
  }
}

}  // namespace sightline::pvs
