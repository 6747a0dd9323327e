#include "mba_vo/simulation/furniture.h"
#include "mba_vo/simulation/scene.h"
#include "mba_vo/simulation/walls.h"

namespace mba_vo {
namespace {

constexpr double kOverlap = 0.01;  // [m], walls reach into each other, so no light falls between them

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

}  // namespace

Scene makeRoom(int seed) {
  RoomBuilder room(seed);
  const double height = room.uniform(2.5, 2.8);
  const std::array<Wall, 4> walls = makeWalls(room.uniform(2.9, 3.3), room.uniform(2.5, 2.8));
  addShell(room, walls, height);
  const int window = room.random().uniform(0, 4);
  int kind = room.random().uniform(0, 5);
  for (std::size_t i = 0; i < walls.size(); ++i) furnishWall(room, walls[i], static_cast<int>(i) == window, kind);
  addLowTable(room, {{room.uniform(-0.3, 0.3), room.uniform(-0.2, 0.2), 0.0}, room.uniform(-0.5, 0.5)});
  return room.build();
}

}  // namespace mba_vo
