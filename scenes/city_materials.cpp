// The city's palette: linear base colours.

#include "scenes/city_parts.h"

namespace sightline::scenes {

std::vector<Material> cityMaterials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  std::vector<Material> materials = {
      {"asphalt", kOpaque, false, {0.075f, 0.078f, 0.085f, 1.0f}},
      {"pavement", kOpaque, false, {0.33f, 0.32f, 0.30f, 1.0f}},
      {"marking", kOpaque, false, {0.78f, 0.78f, 0.74f, 1.0f}},
      {"grass", kOpaque, false, {0.13f, 0.26f, 0.07f, 1.0f}},
      {"sand", kOpaque, false, {0.48f, 0.40f, 0.27f, 1.0f}},
      {"brick", kOpaque, false, {0.36f, 0.13f, 0.09f, 1.0f}},
      {"stucco", kOpaque, false, {0.68f, 0.62f, 0.52f, 1.0f}},
      {"sandstone", kOpaque, false, {0.56f, 0.43f, 0.27f, 1.0f}},
      {"concrete", kOpaque, false, {0.40f, 0.41f, 0.42f, 1.0f}},
      {"ochre plaster", kOpaque, false, {0.62f, 0.38f, 0.13f, 1.0f}},
      {"slate blue plaster", kOpaque, false, {0.22f, 0.31f, 0.40f, 1.0f}},
      {"roof tiles", kOpaque, false, {0.38f, 0.11f, 0.06f, 1.0f}},
      {"slate", kOpaque, false, {0.13f, 0.15f, 0.19f, 1.0f}},
      {"gravel", kOpaque, false, {0.30f, 0.29f, 0.27f, 1.0f}},
      {"light trim", kOpaque, false, {0.74f, 0.72f, 0.67f, 1.0f}},
      {"dark trim", kOpaque, false, {0.10f, 0.11f, 0.13f, 1.0f}},
      {"window", kOpaque, false, {0.09f, 0.16f, 0.24f, 1.0f}},
      {"glass", Opacity::kBlended, false, {0.28f, 0.45f, 0.58f, 0.55f}},
      {"door", kOpaque, false, {0.20f, 0.10f, 0.05f, 1.0f}},
      {"metal", kOpaque, false, {0.17f, 0.19f, 0.20f, 1.0f}},
      {"wood", kOpaque, false, {0.38f, 0.21f, 0.10f, 1.0f}},
      {"stone", kOpaque, false, {0.54f, 0.52f, 0.48f, 1.0f}},
      {"bark", kOpaque, false, {0.17f, 0.11f, 0.07f, 1.0f}},
      {"crown", Opacity::kAlphaTested, true, {0.10f, 0.27f, 0.06f, 1.0f}},
      {"light crown", Opacity::kAlphaTested, true, {0.25f, 0.37f, 0.08f, 1.0f}},
      {"red paint", kOpaque, false, {0.55f, 0.05f, 0.04f, 1.0f}},
      {"blue paint", kOpaque, false, {0.06f, 0.17f, 0.46f, 1.0f}},
      {"white paint", kOpaque, false, {0.80f, 0.80f, 0.80f, 1.0f}},
      {"green paint", kOpaque, false, {0.08f, 0.24f, 0.11f, 1.0f}},
      {"rubber", kOpaque, false, {0.03f, 0.03f, 0.035f, 1.0f}},
      {"lamp", kOpaque, false, {0.90f, 0.72f, 0.25f, 1.0f}},
  };
  return materials;
}

}  // namespace sightline::scenes
