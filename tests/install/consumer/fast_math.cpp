// The library calculates as it was compiled, whatever other sources of the program are compiled with: it
// refuses boxes that are not finite, which with -ffast-math cannot be told from others.

#include <cstdio>
#include <limits>

#include "sightline/scene/object_boxes.h"

using namespace sightline;

bool usesBoxes(const Box& box, const Box& other);

int main() {
  const Box endless{{-std::numeric_limits<float>::infinity(), 0, 0}, {1, 1, 1}};
  ObjectBoxes boxes;
  boxes.first = {0, 2};
  boxes.boxes = {endless, endless};
  const bool refused = !objectBoxesFrom(objectBoxesBytes(boxes), 1);
  std::printf("%s, %s\n", refused ? "refused" : "taken", usesBoxes(endless, endless) ? "equal" : "not equal");
  return refused ? 0 : 1;
}
