#pragma once

namespace sightline::base {

// While one of these exists, large memory that is freed, by any thread, is kept for what asks for large
// memory next. What the system hands out is filled with zeros first, which takes as long as all other work
// where one step after the other needs memory for a moment. With the last one, all that is kept goes back to
// the system. The memory is shared by the whole process, as that of operator new is.
class MemoryReuse {
 public:
  MemoryReuse();
  ~MemoryReuse();
  MemoryReuse(const MemoryReuse&) = delete;
  MemoryReuse& operator=(const MemoryReuse&) = delete;
};

}  // namespace sightline::base
