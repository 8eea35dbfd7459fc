#include "scenes/stairs.h"

namespace sightline::scenes {

std::vector<Point2> flightProfile(std::uint32_t risers, double rise, double tread) {
  constexpr double kThickness = 0.2;
  const double top = rise * (risers - 1), run = tread * (risers - 1);
  std::vector<Point2> profile = {{0, 0}, {kThickness * tread / rise, 0}, {run, top - kThickness}, {run, top}};
  for (std::uint32_t step = risers - 1; step > 0; --step) {
    profile.push_back({tread * (step - 1), rise * step});
    if (step > 1) {
      profile.push_back({tread * (step - 1), rise * (step - 1)});
    }
  }
  return profile;
}

}  // namespace sightline::scenes
