#include "src/layers/hull/qhull_candidates.h"

#include <algorithm>
#include <cstdio>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace sightline::layers {
namespace {

// A stream that discards what is written. Qhull reports errors to a stream and ends the program without one.
// The stream is in memory, so it needs neither a file nor a device, and each hull has its own.
class Discarded {
 public:
#if defined(_WIN32)
  Discarded() : stream_(std::fopen("NUL", "w")) {}
#else
  Discarded() : stream_(fmemopen(bytes_, sizeof bytes_, "w")) {}
#endif
  ~Discarded() {
    if (stream_ != nullptr) {
      std::fclose(stream_);
    }
  }
  Discarded(const Discarded&) = delete;
  Discarded& operator=(const Discarded&) = delete;
  std::FILE* get() const {
    return stream_;
  }  // null: no memory

 private:
  char bytes_[16] = {};  // buffer of the stream, which drops what does not fit
  std::FILE* stream_;
};

void release(qhT* qh) {
  qh_freeqhull(qh, !qh_ALL);
  int blocks = 0;
  int bytes = 0;
  qh_memfreeshort(qh, &blocks, &bytes);
}

}  // namespace

std::vector<std::uint32_t> qhullCandidates(std::span<const Vec3d> points, const Vec3d& middle) {
  std::vector<std::uint32_t> candidates;
  const Discarded discarded;
  if (discarded.get() == nullptr) {
    return candidates;
  }
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3d& p : points) {
    const Vec3d d = p - middle;
    coordinates.insert(coordinates.end(), {d.x, d.y, d.z});
  }
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, discarded.get());
  char command[] = "qhull";
  // Qhull's long jumps end within this call.
  if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, command,
                   discarded.get(), discarded.get()) == qh_ERRnone) {
    vertexT* vertex = nullptr;
    FORALLvertices {
      const int number = qh_pointid(qh, vertex->point);
      if (number >= 0) {
        candidates.push_back(static_cast<std::uint32_t>(number));
      }
    }
    std::sort(candidates.begin(), candidates.end());
  }
  release(qh);
  return candidates;
}

}  // namespace sightline::layers
