// A source of a program that is compiled with -ffast-math and without inlining. It leaves copies of inline
// functions, of which the linker takes the first for the whole program.

#include "sightline/math/box.h"

bool usesBoxes(const sightline::Box& box, const sightline::Box& other) {
  sightline::Box both = box;
  both.extend(other);
  return both.wellFormed() && contains(both, box) && overlaps(both, other) && both == box;
}
