#include "src/pvs/bake/object_mask.h"

#include <algorithm>

namespace sightline::pvs {

void ObjectMask::reset(std::uint32_t count) {
  count_ = count;
  words_.assign((count + 63) / 64, 0);
}

void ObjectMask::resetWithout(std::span<const ObjectRun> runs, std::uint32_t count) {
  reset(count);
  std::uint32_t begin = 0;
  for (const ObjectRun& run : runs) {
    addRun({begin, run.begin});
    begin = run.end;
  }
  addRun({begin, count});
}

void ObjectMask::add(std::span<const ObjectRun> runs) {
  for (const ObjectRun& run : runs) {
    addRun(run);
  }
}

void ObjectMask::remove(const ObjectMask& others) {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    words_[i] &= ~others.words_[i];
  }
}

void ObjectMask::addRun(const ObjectRun& run) {
  if (run.begin == run.end) {
    return;
  }
  const std::uint32_t first = run.begin / 64, last = (run.end - 1) / 64;
  const std::uint64_t low = ~std::uint64_t{0} << run.begin % 64;
  const std::uint64_t high = ~std::uint64_t{0} >> (63 - (run.end - 1) % 64);
  if (first == last) {
    words_[first] |= low & high;
    return;
  }
  words_[first] |= low;
  std::fill(words_.begin() + first + 1, words_.begin() + last, ~std::uint64_t{0});
  words_[last] |= high;
}

bool ObjectMask::containsAll(const ObjectRun& run) const {
  std::uint32_t i = run.begin;
  while (i < run.end && contains(i)) {
    // Whole words at once.
    i += i % 64 == 0 && i + 64 <= run.end && words_[i / 64] == ~std::uint64_t{0} ? 64 : 1;
  }
  return i >= run.end;
}

void ObjectMask::complement(Runs& out) const {
  out.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (i % 64 == 0 && words_[i / 64] == ~std::uint64_t{0}) {
      i += 63;
    } else if (!contains(i)) {
      appendRun({i, i + 1}, out);
    }
  }
}

}  // namespace sightline::pvs
