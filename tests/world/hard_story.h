#pragma once

// A World that is changed in every way at once, also in those that a careful program would avoid, and what
// must be seen of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/world/world_story.h"

namespace sightline::world_story {

// Far from the world's zero: matrices and eyes are told relative to `base`, and the world gets their sums.
// All of these are exact.
struct HardStory {
  struct Piece {
    std::size_t shape = 0;
    Mat4 base_from_mesh{};
    Vec3d shift{};  // by which it is drawn elsewhere than its matrix says, no more than its displacement
    std::uint32_t groups = 1;
    bool shown = true;
    bool placed = true;  // it has a matrix of which a box can be told
  };

  Chance chance;
  Vec3d base;
  World world;
  std::vector<Shape> shapes = allShapes();
  std::vector<MeshId> meshes;
  std::map<std::uint32_t, Piece> pieces;  // by InstanceId
  std::optional<JoinInput> prepared;
  std::vector<JoinId> joins;
  Vec3d eye;  // from the base
  double heading = 0.0;

  bool all_placed;  // no matrix is one of which no box can be told

  HardStory(std::uint32_t seed, const Vec3d& far_away, bool all_have_boxes = false)
      : chance(seed), base(far_away), all_placed(all_have_boxes) {
    for (const Shape& shape : shapes) {
      meshes.push_back(addShape(world, shape));
    }
    for (int i = 0; i < 50; ++i) {
      addOne();
    }
    eye = {chance.eighths(-5, 5), 1.5, chance.eighths(-5, 5)};
    heading = chance.number(0.0, 6.0);
  }

  Mat4 inWorld(const Mat4& m) const { return movedBy(m, base); }
  View inWorld(View view) const {
    view.eye = view.eye + base;
    return view;
  }

  // A placement of all sorts; placed: whether it is one at all.
  Mat4 anyPlacement(bool& placed) {
    Mat4 m = chance.placement(20.0, 6.0);
    const std::uint32_t kind = all_placed ? 3 + chance.below(21) : chance.below(24);
    const auto row = static_cast<int>(chance.below(3)), column = static_cast<int>(chance.below(3));
    placed = kind > 2;
    if (kind == 0) {
      m(row, column) = std::numeric_limits<double>::quiet_NaN();
    } else if (kind == 1) {
      m(row, 3) = chance.below(2) == 0 ? std::numeric_limits<double>::infinity() : -1e300;
    } else if (kind == 2) {
      m(3, column) = 0.5;
    } else if (kind == 3 || kind == 4) {  // flat, or a line, or a point
      for (int i = 0; i < 3; ++i) {
        m(i, column) = 0.0;
        m(i, kind == 3 ? column : (column + 1) % 3) = 0.0;
        m(i, row) = kind == 3 ? m(i, row) : 0.0;
      }
    } else if (kind == 5) {  // a wall of a kilometre
      for (int i = 0; i < 3; ++i) {
        m(i, column) *= 256.0;
      }
    }
    return m;
  }

  Instance next(Piece& piece) {
    piece = {.shape = chance.below(5), .base_from_mesh = anyPlacement(piece.placed), .placed = piece.placed};
    piece.groups = 1 + chance.below(3);
    piece.shown = chance.below(5) != 0;
    Instance instance{.mesh = meshes[piece.shape],
                      .world_from_mesh = inWorld(piece.base_from_mesh),
                      .groups = piece.groups,
                      .shown = piece.shown,
                      .occludes = chance.below(8) != 0,
                      .moves = chance.below(3) == 0};
    if (chance.below(8) == 0) {
      piece.shift = {chance.eighths(-0.5, 0.5), chance.eighths(-0.5, 0.5), chance.eighths(-0.5, 0.5)};
      instance.displacement = length(piece.shift) + 0.0625;
    }
    return instance;
  }
  void addOne() {
    Piece piece;
    const InstanceId id = world.add(next(piece));
    pieces[id.value] = piece;
  }
  void addList() {
    std::vector<Piece> added(1 + chance.below(6));
    std::vector<Instance> list;
    for (Piece& piece : added) {
      list.push_back(next(piece));
    }
    std::vector<InstanceId> ids;
    world.add(list, ids);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      pieces[ids[i].value] = added[i];
    }
  }
  InstanceId any() {
    const auto at = std::next(pieces.begin(), chance.below(static_cast<std::uint32_t>(pieces.size())));
    return InstanceId(at->first);
  }
  // The next matrix of a piece: a step from the last one, or anywhere.
  void goOn(Piece& piece) {
    if (!piece.placed || chance.below(4) == 0) {
      piece.base_from_mesh = anyPlacement(piece.placed);
      return;
    }
    Mat4& m = piece.base_from_mesh;
    for (const int axis : {0, 2}) {
      m(axis, 3) = std::clamp(m(axis, 3) + chance.eighths(-1.0, 1.0), -30.0, 30.0);
    }
  }
  void moveSeveral() {
    std::vector<InstanceId> ids;
    std::vector<Mat4> to;
    for (auto& [id, piece] : pieces) {
      if (chance.below(5) == 0) {
        goOn(piece);
        ids.emplace_back(id);
        to.push_back(inWorld(piece.base_from_mesh));
      }
    }
    world.setTransforms(ids, to);
  }
  void newMesh() {
    const std::size_t shape = chance.below(5);
    world.removeMesh(meshes[shape]);
    std::erase_if(pieces, [&](const auto& piece) { return piece.second.shape == shape; });
    meshes[shape] = addShape(world, shapes[shape]);
  }
  void newOrigin() {
    Vec3d origin{chance.eighths(-50, 50), chance.eighths(-9, 9), chance.eighths(-50, 50)};
    const std::uint32_t kind = chance.below(8);
    origin = kind == 0 ? origin : kind == 1 ? origin * 0x1p60 : origin + base;
    if (chance.below(3) == 0) {
      world.setOrigin(origin);
    } else {
      world.moveOrigin(origin);
    }
  }
  void prepare() {
    std::vector<InstanceId> some;
    for (const auto& [id, piece] : pieces) {
      if (chance.below(2) == 0) {
        some.emplace_back(id);
      }
    }
    prepared = world.joinInput(some);
  }
  void dropOne() {
    const std::size_t dropped = chance.below(static_cast<std::uint32_t>(joins.size()));
    world.removeJoin(joins[dropped]);
    joins[dropped] = joins.back();
    joins.pop_back();
  }

  void change() {
    if (pieces.size() < 30) {
      addList();
      return;
    }
    const InstanceId id = any();
    Piece& piece = pieces.at(id.value);
    switch (chance.below(16)) {
      case 0:
        if (pieces.size() < 90) {
          addList();
        }
        break;
      case 1:
        world.remove(id);
        pieces.erase(id.value);
        if (chance.below(2) == 0) {
          addOne();  // which gets the same number
        }
        break;
      case 2:
        world.replace(id, next(piece));
        break;
      case 3:
      case 4:
        piece.shown = !piece.shown;
        world.setShown(id, piece.shown);
        break;
      case 5:
        piece.groups = 1 + chance.below(3);
        world.setGroups(id, piece.groups);
        break;
      case 6:
        if (prepared && joins.size() < 8) {
          joins.push_back(world.addJoin(makeJoin(*std::exchange(prepared, std::nullopt))));
        } else if (!joins.empty()) {
          dropOne();
        }
        break;
      case 7:
        prepare();
        if (chance.below(2) == 0 && joins.size() < 8) {
          joins.push_back(world.addJoin(makeJoin(*std::exchange(prepared, std::nullopt))));
        }
        break;
      case 8:
        moveSeveral();
        break;
      default:
        goOn(piece);
        world.setTransform(id, inWorld(piece.base_from_mesh));
    }
    if (chance.below(150) == 0) {
      newMesh();
    }
    if (chance.below(60) == 0) {
      newOrigin();
    }
  }

  // A frame: changes, and the next view, from the base.
  View next() {
    for (std::uint32_t changes = chance.below(chance.below(6) == 0 ? 40 : 6); changes > 0; --changes) {
      change();
    }
    if (chance.below(4) != 0) {
      world.tidy(chance.below(3) == 0 ? 10000 : chance.below(200));
    } else if (chance.below(40) == 0) {
      world.rebuild();
    }
    const auto stay = [](double x) { return std::clamp(x, -25.0, 25.0); };
    eye = {stay(eye.x + chance.eighths(-0.5, 0.5)), 1.5, stay(eye.z + chance.eighths(-0.5, 0.5))};
    heading += chance.number(-0.1, 0.1) + (chance.below(16) == 0 ? 2.5 : 0.0);
    return viewFrom(eye, {std::sin(heading), 0.0, std::cos(heading)});
  }

  // All that is drawn in views of these groups.
  ToldScene drawn(std::uint32_t groups) const {
    ToldScene drawn{shapes};
    for (const auto& [id, piece] : pieces) {
      if (piece.shown && piece.placed && (piece.groups & groups) != 0) {
        drawn.told[id] = {piece.shape, movedBy(piece.base_from_mesh, piece.shift), true};
      }
    }
    return drawn;
  }

  // What cullers of these groups, which have culled the world for this view from the base, did wrong.
  Judged judged(const View& view, std::initializer_list<const WorldCuller*> cullers,
                std::uint32_t groups) const {
    Judged judged = judge(drawn(groups), view, cullers);
    for (const WorldCuller* culler : cullers) {
      judged.wrong += whatIsWrong(*culler, groups);
    }
    return judged;
  }
  Judged judged(const View& view, const WorldCuller& culler, std::uint32_t groups) const {
    return judged(view, {&culler}, groups);
  }

 private:
  // What a culler keeps although it is not drawn, or leaves out although it has no place.
  std::string whatIsWrong(const WorldCuller& culler, std::uint32_t groups) const {
    std::string wrong;
    for (const auto& [id, piece] : pieces) {
      const bool draws = piece.shown && (piece.groups & groups) != 0;
      const bool kept = keeps(culler, InstanceId(id));
      if (kept != draws && !(draws && piece.placed)) {
        wrong += "instance " + std::to_string(id) + (kept ? " is not drawn; " : " has no place; ");
      }
    }
    for (const InstanceId id : culler.visible()) {
      wrong += pieces.contains(id.value) ? "" : "instance " + std::to_string(id.value) + " is not there; ";
    }
    return wrong;
  }
};

}  // namespace sightline::world_story
