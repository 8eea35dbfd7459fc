#pragma once

#include <array>

namespace sightline::tool {

// A curve's colour and dashes. Colours have a middle lightness, which contrasts with white and black, and
// hues that colour-blind readers can distinguish.
struct Pen {
  const char* color;
  const char* dashes;
};
inline constexpr std::array<Pen, 8> kPens{{{"#808790", "none"},
                                           {"#2b7fd4", "none"},
                                           {"#d9700a", "8 3"},
                                           {"#1f9e77", "2 3"},
                                           {"#c44fa5", "10 3 2 3"},
                                           {"#9a7d0a", "5 5"},
                                           {"#7c5cd6", "14 4"},
                                           {"#d64545", "1 5"}}};

}  // namespace sightline::tool
