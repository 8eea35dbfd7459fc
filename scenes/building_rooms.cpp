// Places the furniture of a room: along the three walls without a door, and in some rooms in the middle.

#include "scenes/building_parts.h"
#include "scenes/furniture.h"

namespace sightline::scenes {
namespace {

struct Arrangement {
  MeshBuilder& mesh;
  const Room& room;
  Random& random;
  std::uint32_t count = 0;

  void add(Piece piece, const Placement& at) {
    addPiece(mesh, piece, at, random, room.name + " " + std::to_string(count++));
  }
  // Places a piece along the wall on the left or right of the door, y metres into the room.
  void left(Piece piece, double y) { add(piece, room.placement.moved({0, y, 0}).turned(-0.25)); }
  void right(Piece piece, double y) { add(piece, room.placement.moved({room.width, y, 0}).turned(0.25)); }
  // Places a piece along the wall opposite the door, at this fraction of the wall's length.
  void back(Piece piece, double part) {
    add(piece, room.placement.moved({room.width * part, room.depth, 0}).turned(0.5));
  }
  void side(bool on_left, Piece piece, double y) { on_left ? left(piece, y) : right(piece, y); }
};

constexpr double kNear = 1.5, kFar = 2.85, kMiddle = 2.2;  // metres from the door's wall

void arrangeOffice(Arrangement& in, bool flip) {
  in.side(flip, Piece::kDesk, kFar);
  in.side(flip, Piece::kChair, kFar);
  const bool shared = in.random.chance(0.5);
  in.side(flip, shared ? Piece::kDesk : Piece::kShelf, kNear);
  if (shared) {
    in.side(flip, Piece::kChair, kNear);
  }
  in.side(!flip, Piece::kShelf, kNear);
  in.side(!flip, Piece::kCupboard, kFar);
  in.back(in.room.has_window ? Piece::kRadiator : Piece::kShelf, 0.5);
}

void arrangeBedroom(Arrangement& in, bool flip) {
  in.side(flip, Piece::kBed, kMiddle);
  in.side(!flip, Piece::kCupboard, kNear);
  in.side(!flip, Piece::kDesk, kFar);
  in.side(!flip, Piece::kChair, kFar);
  in.back(Piece::kBedside, flip ? 0.12 : 0.88);
  in.back(in.room.has_window ? Piece::kRadiator : Piece::kShelf, 0.5);
  in.back(Piece::kFloorLamp, flip ? 0.85 : 0.15);
}

void arrangeMeeting(Arrangement& in, bool flip) {
  in.add(Piece::kTable, in.room.placement.moved({in.room.width / 2, in.room.depth * 0.56, 0}));
  in.side(flip, Piece::kCupboard, kFar);
  in.back(in.room.has_window ? Piece::kRadiator : Piece::kCupboard, 0.5);
}

void arrangeStore(Arrangement& in, bool) {
  for (const double y : {kNear, kFar}) {
    in.left(Piece::kRack, y);
    in.right(Piece::kRack, y);
  }
  in.back(in.room.has_window ? Piece::kRadiator : Piece::kRack, 0.5);
}

void arrangeBathroom(Arrangement& in, bool flip) {
  for (const double y : {1.2, 2.1, 3.0}) {
    in.side(flip, Piece::kBasin, y);
    in.side(!flip, Piece::kToilet, y);
  }
  // Partitions between the toilets.
  in.mesh.place(in.room.placement);
  const double low = flip ? in.room.width - 0.85 : 0.0, high = flip ? in.room.width : 0.85;
  for (const double y : {1.65, 2.55, 3.45}) {
    in.mesh.startObject(in.room.name + " partition " + std::to_string(in.count++),
                        id(BuildingMaterial::kWhite));
    in.mesh.box({low, y - 0.015, 0.12}, {high, y + 0.015, 2.1});
  }
}

void arrangeLounge(Arrangement& in, bool flip) {
  in.side(flip, Piece::kSofa, kMiddle);
  in.side(!flip, Piece::kSofa, kMiddle);
  in.back(Piece::kFloorLamp, 0.1);
  in.back(in.room.has_window ? Piece::kRadiator : Piece::kShelf, 0.5);
  in.back(Piece::kFloorLamp, 0.9);
}

}  // namespace

Rectangle furnish(MeshBuilder& mesh, const Room& room, Random random) {
  Arrangement in{mesh, room, random};
  const double kind = random.uniform();
  const bool flip = random.chance(0.5);
  in.add(Piece::kCeilingLight, room.placement.moved({room.width / 2, room.depth / 2, kStorey - kSlab}));
  Rectangle free{{1.5, 1.4}, {room.width - 1.5, room.depth - 1.3}};
  if (room.on_walk || kind < 0.4) {
    arrangeOffice(in, flip);
  } else if (kind < 0.55) {
    arrangeBedroom(in, flip);
  } else if (kind < 0.7) {
    arrangeMeeting(in, flip);
    free = {{0.5, 0.5}, {0.9, 0.9}};
  } else if (kind < 0.8) {
    arrangeStore(in, flip);
  } else if (kind < 0.9) {
    arrangeBathroom(in, flip);
  } else {
    arrangeLounge(in, flip);
  }
  if (room.on_walk) {
    free = {{1, 1}, {0, 0}};
  }
  return free;
}

}  // namespace sightline::scenes
