#include "mba_vo/simulation/walls.h"

#include "mba_vo/simulation/furniture.h"

namespace mba_vo {
namespace {

constexpr double kSlot = 1.5;  // [m] of wall for one piece of furniture

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

}  // namespace

std::array<Wall, 4> makeWalls(double half_x, double half_y) {
  return {{{{{0.0, -half_y, 0.0}, 0.0}, 2.0 * half_x},
           {{{half_x, 0.0, 0.0}, 0.5 * CV_PI}, 2.0 * half_y},
           {{{0.0, half_y, 0.0}, CV_PI}, 2.0 * half_x},
           {{{-half_x, 0.0, 0.0}, -0.5 * CV_PI}, 2.0 * half_y}}};
}

void furnishWall(RoomBuilder& room, const Wall& wall, bool window, int& kind) {
  const int slots = static_cast<int>((wall.length - 0.9) / kSlot);
  for (int i = 0; i < slots; ++i) {
    const double x = (i - 0.5 * (slots - 1)) * kSlot;
    if (window && i == slots / 2) {
      room.attempt([&] { addCabinet(room, wall.middle.at(x, 0.02, 0.0)); });
      room.attempt([&] { addWindow(room, wall.middle.at(x, 0.0, 1.75)); });
      continue;
    }
    kind = (kind + 1 + (room.chance(0.3) ? 1 : 0)) % 5;
    room.attempt([&] { addPiece(room, kind, wall.middle.at(x + room.uniform(-0.05, 0.05), 0.02, 0.0)); });
    if (kind == 0) continue;  // a bookshelf reaches up
    room.attempt([&] {
      addPoster(room, wall.middle.at(x - 0.33, 0.0, room.uniform(1.6, 1.85)), room.uniform(0.4, 0.6),
                room.uniform(0.5, 0.75));
    });
    if (room.chance(0.7)) {
      room.attempt([&] {
        addPoster(room, wall.middle.at(x + 0.35, 0.0, room.uniform(1.5, 1.95)), room.uniform(0.3, 0.55),
                  room.uniform(0.35, 0.6));
      });
    }
  }
}

}  // namespace mba_vo
