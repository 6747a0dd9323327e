#pragma once

#include <array>

#include "mba_vo/simulation/room_builder.h"

namespace mba_vo {

struct Wall {
  Place middle;   // on the floor, y into the room
  double length;  // [m]
};

/// The walls of a room with its middle at the origin; half sizes in [m].
std::array<Wall, 4> makeWalls(double half_x, double half_y);

/// Furniture along the wall and pictures, or one window, above it. `kind` was the piece before and becomes the last.
void furnishWall(RoomBuilder& room, const Wall& wall, bool window, int& kind);

}  // namespace mba_vo
