#include <algorithm>
#include <array>

#include "mba_vo/simulation/furniture.h"
#include "mba_vo/simulation/scene.h"

namespace mba_vo {
namespace {

constexpr double kSlot = 1.5;      // [m] of wall for one piece of furniture
constexpr double kOverlap = 0.01;  // [m], walls reach into each other, so no light falls between them

struct Wall {
  Place middle;   // on the floor, y into the room
  double length;  // [m]
};

std::array<Wall, 4> makeWalls(double half_x, double half_y) {
  return {{{{{0.0, -half_y, 0.0}, 0.0}, 2.0 * half_x},
           {{{half_x, 0.0, 0.0}, 0.5 * CV_PI}, 2.0 * half_y},
           {{{0.0, half_y, 0.0}, CV_PI}, 2.0 * half_x},
           {{{-half_x, 0.0, 0.0}, -0.5 * CV_PI}, 2.0 * half_y}}};
}

void addShell(RoomBuilder& room, const std::array<Wall, 4>& walls, double height) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const int first_plain = room.random().uniform(0, 4);  // this wall and the opposite one are plain
  const Pattern papers[] = {Pattern::kBricks, Pattern::kFabric, Pattern::kTiles};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const bool plain = (static_cast<int>(i) - first_plain) % 2 == 0;
    const Skin skin = plain ? Skin{Pattern::kPlaster, 0.003, false, 1.0}
                            : Skin{papers[room.random().uniform(0, 3)], 0.003, false, 1.1};
    const Place& middle = walls[i].middle;
    const Eigen::Vector3d normal = middle.at(0.0, 1.0, 0.0).origin - middle.origin;
    room.addRectangle(middle.origin + 0.5 * height * up, normal, -up, walls[i].length + kOverlap, height + kOverlap,
                      skin);
  }
  const double x = walls[0].length + kOverlap;
  const double y = walls[1].length + kOverlap;
  const Pattern floors[] = {Pattern::kWood, Pattern::kTiles, Pattern::kStone};
  room.addRectangle(Eigen::Vector3d::Zero(), up, Eigen::Vector3d::UnitY(), x, y,
                    {floors[room.random().uniform(0, 3)], 0.0025, false, 0.9});
  room.addRectangle(height * up, -up, Eigen::Vector3d::UnitY(), x, y, {Pattern::kPlaster, 0.004, false, 1.1});
}

void addPiece(RoomBuilder& room, int kind, const Place& place) {
  switch (kind) {
    case 0:
      return addBookshelf(room, place);
    case 1:
      return addDesk(room, place);
    case 2:
      return addCabinet(room, place);
    case 3:
      return addSofa(room, place);
    default:
      return addStack(room, place);
  }
}

/// Furniture along the wall and pictures, or one window, above it.
void furnish(RoomBuilder& room, const Wall& wall, bool window, int& kind) {
  const int slots = static_cast<int>((wall.length - 0.9) / kSlot);
  for (int i = 0; i < slots; ++i) {
    const double x = (i - 0.5 * (slots - 1)) * kSlot;
    if (window && i == slots / 2) {
      addCabinet(room, wall.middle.at(x, 0.02, 0.0));
      addWindow(room, wall.middle.at(x, 0.0, 1.75));
      continue;
    }
    kind = (kind + 1 + (room.chance(0.3) ? 1 : 0)) % 5;
    addPiece(room, kind, wall.middle.at(x + room.uniform(-0.05, 0.05), 0.02, 0.0));
    if (kind == 0) continue;  // a bookshelf reaches up
    addPoster(room, wall.middle.at(x - 0.33, 0.0, room.uniform(1.6, 1.85)), room.uniform(0.4, 0.6),
              room.uniform(0.5, 0.75));
    if (room.chance(0.7)) {
      addPoster(room, wall.middle.at(x + 0.35, 0.0, room.uniform(1.5, 1.95)), room.uniform(0.3, 0.55),
                room.uniform(0.35, 0.6));
    }
  }
}

}  // namespace

Scene makeRoom(int seed) {
  RoomBuilder room(seed);
  const double height = room.uniform(2.5, 2.8);
  const std::array<Wall, 4> walls = makeWalls(room.uniform(2.9, 3.3), room.uniform(2.5, 2.8));
  addShell(room, walls, height);
  const int window = room.random().uniform(0, 4);
  int kind = room.random().uniform(0, 5);
  for (std::size_t i = 0; i < walls.size(); ++i) furnish(room, walls[i], static_cast<int>(i) == window, kind);
  addLowTable(room, {{room.uniform(-0.3, 0.3), room.uniform(-0.2, 0.2), 0.0}, room.uniform(-0.5, 0.5)});
  return room.build();
}

}  // namespace mba_vo
