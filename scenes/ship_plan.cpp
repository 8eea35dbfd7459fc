// Dimensions and colours of the ship.

#include <algorithm>

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {

double halfBreadth(double x, double z) {
  const double depth = 1.0 - std::min(z / kMainDeck, 1.0);
  const double aft = std::max(0.0, (40.0 - x) / 40.0), fore = std::max(0.0, (x - 140.0) / 40.0);
  return kHalfBeam * (1.0 - aft * aft * (0.27 + 0.6 * depth * depth)) *
         (1.0 - fore * fore * (0.8 + 0.14 * depth * depth));
}

double halfBreadthInShell(double x, double z) {
  constexpr double kBilge = 1.5;
  const double bilge = z < kBilge ? 1.0 - 0.08 * (1.0 - z / kBilge) : 1.0;
  return halfBreadth(x, z) * bilge - kShell * 0.5;
}

Room roomAt(const Plan& plan, std::uint32_t deck, std::uint32_t bay, bool port) {
  const double start = plan.bayStart(bay), end = plan.bayStart(bay + 1), half = kInnerWall * 0.5;
  Room room{.deck = deck, .bay = bay, .port = port};
  room.width = end - start - kInnerWall;
  room.depth = kBlockHalf - kRoomStart;
  if (port) {
    room.placement.origin = {start + half, kRoomStart, deckHeight(deck)};
  } else {
    room.placement.origin = {end - half, -kRoomStart, deckHeight(deck)};
    room.placement = room.placement.turned(0.5);
  }
  room.name = "deck " + std::to_string(deck) + " room " + std::to_string(port ? bay : plan.bays() + bay);
  return room;
}

std::array<Room, 2> roomsOnWalk(const Plan& plan) {
  return {roomAt(plan, kMainDeckNumber, 1, true), roomAt(plan, kMainDeckNumber, plan.bays() - 1, false)};
}

bool isOnWalk(const Plan& plan, const Room& room) {
  const std::array<Room, 2> rooms = roomsOnWalk(plan);
  return std::any_of(rooms.begin(), rooms.end(), [&](const Room& other) {
    return other.deck == room.deck && other.bay == room.bay && other.port == room.port;
  });
}

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {
      {"hull", kOpaque, false, {0.30f, 0.09f, 0.07f, 1.0f}},
      {"deck", kOpaque, false, {0.16f, 0.29f, 0.20f, 1.0f}},
      {"floor", kOpaque, false, {0.33f, 0.36f, 0.38f, 1.0f}},
      {"wall", kOpaque, false, {0.74f, 0.73f, 0.66f, 1.0f}},
      {"bulkhead", kOpaque, false, {0.47f, 0.50f, 0.46f, 1.0f}},
      {"door", kOpaque, false, {0.45f, 0.26f, 0.13f, 1.0f}},
      {"frame", kOpaque, false, {0.60f, 0.50f, 0.25f, 1.0f}},
      {"stairs", kOpaque, false, {0.38f, 0.40f, 0.42f, 1.0f}},
      {"rail", kOpaque, false, {0.75f, 0.60f, 0.08f, 1.0f}},
      {"tank", kOpaque, false, {0.62f, 0.64f, 0.66f, 1.0f}},
      {"pipe", kOpaque, false, {0.52f, 0.53f, 0.50f, 1.0f}},
      {"red pipe", kOpaque, false, {0.50f, 0.12f, 0.08f, 1.0f}},
      {"engine", kOpaque, false, {0.22f, 0.38f, 0.30f, 1.0f}},
      {"machine", kOpaque, false, {0.20f, 0.31f, 0.45f, 1.0f}},
      {"console", kOpaque, false, {0.40f, 0.42f, 0.36f, 1.0f}},
      {"screen", kOpaque, false, {0.04f, 0.07f, 0.09f, 1.0f}},
      {"wood", kOpaque, false, {0.42f, 0.27f, 0.14f, 1.0f}},
      {"fabric", kOpaque, false, {0.12f, 0.20f, 0.42f, 1.0f}},
      {"white", kOpaque, false, {0.82f, 0.82f, 0.80f, 1.0f}},
      {"metal", kOpaque, false, {0.36f, 0.38f, 0.40f, 1.0f}},
      {"light", kOpaque, false, {0.95f, 0.92f, 0.80f, 1.0f}},
      {"crate", kOpaque, false, {0.50f, 0.36f, 0.16f, 1.0f}},
  };
}

}  // namespace sightline::scenes::ship
