#include <algorithm>
#include <cmath>

#include "mba_vo/simulation/clearance.h"
#include "mba_vo/simulation/furniture.h"
#include "mba_vo/simulation/hall_furniture.h"
#include "mba_vo/simulation/scene.h"
#include "mba_vo/simulation/walls.h"

namespace mba_vo {
namespace {

constexpr double kClearance = 0.45;     // [m]; 0.4 and what the camera moves between two points of its path
constexpr double kLongestRoom = 12.0;   // [m], a longer one is a hall
constexpr double kPanelOverlap = 5e-4;  // [m] of neighbouring panels, so no light falls between them
constexpr double kLampSpacing = 3.5;    // [m]

struct RoomSize {
  double half_x, half_y, height;  // [m]
  bool hall;
};

RoomSize chooseSize(const std::vector<Eigen::Vector3d>& path, RoomBuilder& room) {
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : path) reach = reach.cwiseMax(p.cwiseAbs());
  const double margin = room.uniform(1.9, 2.3);
  RoomSize size{reach.x() + margin, reach.y() + margin, 0.0, false};
  size.hall = 2.0 * std::max(size.half_x, size.half_y) > kLongestRoom;
  if (size.hall) {
    size.half_x += 0.5;
    size.half_y += 0.5;
  }
  size.height = std::max(size.hall ? room.uniform(4.5, 5.5) : room.uniform(2.5, 2.8), reach.z() + 0.8);
  return size;
}

/// As many equal parts of `length` as are at most `longest`; calls part(middle, length of one).
template <typename Part>
void divide(double length, double longest, Part part) {
  const int count = std::max(1, static_cast<int>(std::ceil(length / longest)));
  const double each = length / count;
  for (int i = 0; i < count; ++i) part((i + 0.5) * each - 0.5 * length, each);
}

void hangLamps(RoomBuilder& room, const RoomSize& size) {
  std::vector<Lamp> lamps;
  divide(2.0 * size.half_x, kLampSpacing, [&](double x, double) {
    divide(2.0 * size.half_y, kLampSpacing, [&](double y, double) {
      lamps.push_back(
          {{x + room.uniform(-0.4, 0.4), y + room.uniform(-0.4, 0.4), size.height - 0.4}, room.uniform(0.4, 1.1)});
    });
  });
  room.setLamps(std::move(lamps));
}

Skin floorSkin(RoomBuilder& room, bool hall) {
  const Pattern patterns[] = {Pattern::kWood, Pattern::kTiles, Pattern::kStone, Pattern::kCarpet};
  return {patterns[room.random().uniform(0, hall ? 4 : 3)], hall ? 0.0045 : 0.0025, false, 0.9};
}

void addFloorAndCeiling(RoomBuilder& room, const RoomSize& size) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Skin floor = floorSkin(room, size.hall);
  const double longest = size.hall ? 4.0 : 20.0;  // [m]; a room has one floor
  divide(2.0 * size.half_x, longest, [&](double x, double length) {
    divide(2.0 * size.half_y, longest, [&](double y, double width) {
      room.addRectangle({x, y, 0.0}, up, Eigen::Vector3d::UnitY(), length + kPanelOverlap, width + kPanelOverlap,
                        size.hall ? floorSkin(room, true) : floor);
    });
  });
  room.addRectangle(size.height * up, -up, Eigen::Vector3d::UnitY(), 2.0 * size.half_x + kPanelOverlap,
                    2.0 * size.half_y + kPanelOverlap, {Pattern::kPlaster, 0.004, false, 1.1});
  // Lamps in rows, and beams between the rows.
  const double spacing = size.hall ? 3.5 : 1.8;  // longest [m]
  divide(2.0 * size.half_x, spacing, [&](double x, double length) {
    if (x > 0.75 * length - size.half_x) {
      addBeam(room, {{x - 0.5 * length, 0.0, size.height}, 0.5 * CV_PI}, 2.0 * size.half_y);
    }
    divide(2.0 * size.half_y, spacing, [&](double y, double) {
      addCeilingLamp(room, {{x, y, size.height}, 0.5 * CV_PI * room.random().uniform(0, 2)});
    });
  });
}

void addWalls(RoomBuilder& room, const std::array<Wall, 4>& walls, const RoomSize& size) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Pattern papers[] = {Pattern::kBricks, Pattern::kFabric, Pattern::kTiles};
  const double texel = size.hall ? 0.005 : 0.003;
  const int first_plain = room.random().uniform(0, 4);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const bool plain = !size.hall && (static_cast<int>(i) - first_plain) % 2 == 0;
    const Place& middle = walls[i].middle;
    const Eigen::Vector3d normal = middle.at(0.0, 1.0, 0.0).origin - middle.origin;
    const Skin paper{papers[room.random().uniform(0, 3)], texel, false, 1.1};
    divide(walls[i].length, size.hall ? 5.0 : 20.0, [&](double x, double length) {
      const Skin skin = plain ? Skin{Pattern::kPlaster, 0.003, false, 1.0} : paper;
      room.addRectangle(middle.at(x, 0.0, 0.5 * size.height).origin, normal, -up, length + kPanelOverlap,
                        size.height + kPanelOverlap, skin);
    });
  }
}

void furnishHallWall(RoomBuilder& room, const Wall& wall, double height) {
  divide(wall.length - 1.2, 3.2, [&](double x, double) {
    const Place place = wall.middle.at(x, 0.03, 0.0);
    room.attempt([&] {
      switch (room.random().uniform(0, 3)) {
        case 0:
          return addRack(room, place);
        case 1:
          return addLockers(room, place);
        default:
          return addCrates(room, place.at(0.0, 0.7, 0.0), room.random().uniform(2, 4));
      }
    });
    for (double z = 2.9; z < height - 0.7; z += 1.5) {
      room.attempt([&] {
        addBanner(room, wall.middle.at(x + room.uniform(-0.3, 0.3), 0.0, z), room.uniform(1.2, 2.6),
                  room.uniform(0.8, 1.3));
      });
    }
  });
}

/// The things that may stand in the middle of a room, from the tallest, of which the path forbids most, to the
/// flattest.
void addThing(RoomBuilder& room, int kind, const Place& place, const RoomSize& size) {
  switch (kind) {
    case 0:
      return addPillar(room, place, size.height);
    case 1:
      return addBoard(room, place);
    case 2:
      return addCrates(room, place, size.hall ? room.random().uniform(2, 5) : 2);
    case 3:
      return addWorkbench(room, place);
    case 4:
      return size.hall ? addCrates(room, place, 1) : addLowTable(room, place);
    default:
      return addMat(room, place);
  }
}
constexpr int kThings = 6;

void fillMiddle(RoomBuilder& room, const RoomSize& size) {
  const double strip = size.hall ? 1.6 : 1.5;  // of the walls' own furniture
  const double cell = size.hall ? 2.7 : 2.4;   // longest [m]
  divide(std::max(0.5, 2.0 * (size.half_x - strip)), cell, [&](double x, double length) {
    divide(std::max(0.5, 2.0 * (size.half_y - strip)), cell, [&](double y, double width) {
      const double slack_x = std::max(0.0, 0.5 * length - 1.1);
      const double slack_y = std::max(0.0, 0.5 * width - 1.1);
      const double height = room.uniform(0.0, 0.01);  // carpets of neighbours may overlap: one has to lie above
      const Place place{{x + room.uniform(-slack_x, slack_x), y + room.uniform(-slack_y, slack_y), height},
                        room.uniform(0.0, 2.0 * CV_PI)};
      // A hall needs things that stand up before its far walls; in a room they would hide the furniture.
      for (int kind = room.random().uniform(0, size.hall ? 4 : kThings); kind < kThings; ++kind) {
        if (room.attempt([&] { addThing(room, kind, place, size); })) break;
      }
    });
  });
}

}  // namespace

Scene makeRoomAround(const std::vector<Eigen::Vector3d>& path, int seed) {
  RoomBuilder room(seed);
  const RoomSize size = chooseSize(path, room);
  hangLamps(room, size);
  const Clearance clearance(path, kClearance);
  room.forbid([&](const Surface& surface) { return clearance.violatedBy(surface); });
  const std::array<Wall, 4> walls = makeWalls(size.half_x, size.half_y);
  addFloorAndCeiling(room, size);
  addWalls(room, walls, size);
  const int window = room.random().uniform(0, 4);
  int kind = room.random().uniform(0, 5);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (size.hall) {
      furnishHallWall(room, walls[i], size.height);
    } else {
      furnishWall(room, walls[i], static_cast<int>(i) == window, kind);
    }
  }
  fillMiddle(room, size);
  return room.build();
}

}  // namespace mba_vo
