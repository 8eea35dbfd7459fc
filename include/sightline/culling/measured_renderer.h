#pragma once

#include <cstdint>
#include <optional>

namespace sightline {

// What a renderer takes for a triangle, from the times of the frames that it drew. The caller reports each
// frame; methods that weigh culling against drawing read the result. One thread at a time.
//
// Frames far back count ever less, a frame 32 frames ago about a third. As long as frames differ in how many
// triangles they have, what counts is by how much more the ones with more triangles take: a frame's fixed
// time, for clearing the picture say, is no triangle's. The times of a frame with culling and of one without,
// reported one after the other, so tell what culled triangles would have taken.
class MeasuredRenderer {
 public:
  // A frame was drawn. draw_us: microseconds from the first command to the last pixel. Times that are
  // negative or not finite are ignored.
  void frame(double draw_us, std::uint64_t triangles);

  // Microseconds for a triangle, 0 or more. Nothing before the first frame with triangles. While all frames
  // have about as many triangles it is a frame's time divided by them, which is too much by the fixed time.
  std::optional<double> triangleUs() const;

 private:
  // Sums over all frames, each frame's part smaller with its age.
  double weight_ = 0.0, triangles_ = 0.0, us_ = 0.0, triangles_squared_ = 0.0, products_ = 0.0;
};

}  // namespace sightline
