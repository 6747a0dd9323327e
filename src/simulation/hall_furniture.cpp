#include "mba_vo/simulation/hall_furniture.h"

#include "mba_vo/simulation/furniture.h"

namespace mba_vo {
namespace {

Skin paintedWood(double gain) { return {Pattern::kWood, 0.002, false, gain}; }

Eigen::Vector3d facing(const Place& place) { return place.at(0.0, 1.0, 0.0).origin - place.origin; }

}  // namespace

void addPillar(RoomBuilder& room, const Place& place, double height) {
  const double side = room.uniform(0.4, 0.6);
  const Pattern patterns[] = {Pattern::kBricks, Pattern::kStone, Pattern::kTiles, Pattern::kCarpet};
  room.addBox(place, {side, side, height}, {patterns[room.random().uniform(0, 4)], 0.003, false, 1.0});
  for (int i = 0; i < 4; ++i) {
    const Place side_of = Place{place.origin, place.yaw + i * 0.5 * CV_PI}.at(0.0, 0.5 * side, 0.0);
    addPoster(room, side_of.at(0.0, 0.0, room.uniform(1.2, 2.0)), 0.8 * side, room.uniform(0.4, 0.8));
  }
}

void addCrates(RoomBuilder& room, const Place& place, int layers) {
  double height = 0.0;
  double side = room.uniform(0.7, 1.05);
  for (int layer = 0; layer < layers; ++layer) {
    const double tall = room.uniform(0.45, 0.8);
    const double offset = 0.1 * layer;
    room.addBox(place.at(room.uniform(-offset, offset), room.uniform(-offset, offset), height, room.uniform(-0.4, 0.4)),
                {side, room.uniform(0.75, 1.0) * side, tall}, printed(room), printed(room));
    height += tall;
    side *= 0.85;
  }
  for (const double x : {-0.85, 0.85}) {
    if (room.chance(0.4)) continue;
    const double small = room.uniform(0.3, 0.5);
    room.addBox(place.at(x, room.uniform(-0.3, 0.3), 0.0, room.uniform(-0.7, 0.7)),
                {small, 0.8 * small, room.uniform(0.25, 0.5)}, printed(room), printed(room));
  }
}

void addBoard(RoomBuilder& room, const Place& place) {
  const double height = room.uniform(1.8, 2.1);
  room.addBox(place.at(0.0, 0.0, 0.15), {2.0, 0.06, height - 0.15}, {Pattern::kFabric, 0.002, false, 1.0});
  for (const double x : {-0.9, 0.9}) room.addBox(place.at(x, 0.0, 0.0), {0.08, 0.6, 0.15}, paintedWood(0.6));
  for (const double turn : {0.0, CV_PI}) {
    const Place front = Place{place.origin, place.yaw + turn}.at(0.0, 0.03, 0.0);
    for (const double x : {-0.6, 0.05, 0.65}) {
      addPoster(room, front.at(x + room.uniform(-0.04, 0.04), 0.0, room.uniform(1.1, 1.35)), room.uniform(0.4, 0.55),
                room.uniform(0.5, 0.9));
    }
  }
}

void addWorkbench(RoomBuilder& room, const Place& place) {
  const double width = room.uniform(1.4, 1.8);
  room.addBox(place.at(0.0, 0.0, 0.78), {width, 0.75, 0.05}, paintedWood(1.0));
  for (const double x : {-0.5, 0.5})
    room.addBox(place.at(x * (width - 0.1), 0.0, 0.0), {0.07, 0.7, 0.78}, paintedWood(0.7));
  room.addBox(place.at(0.1, 0.0, 0.05), {0.8, 0.5, 0.5}, printed(room));
  addClutter(room, place.at(0.0, 0.0, 0.83), width - 0.2, 0.55, 5);
}

void addMat(RoomBuilder& room, const Place& place) {
  const Pattern patterns[] = {Pattern::kCarpet, Pattern::kPicture, Pattern::kPanel, Pattern::kPage};
  room.addBox(place, {room.uniform(1.4, 2.0), room.uniform(1.0, 1.4), 0.015},
              {patterns[room.random().uniform(0, 4)], 0.003, true, 0.9});
}

void addRack(RoomBuilder& room, const Place& place) {
  const double height = room.uniform(1.7, 2.4);
  const int levels = 3;
  for (const double x : {-1.15, 0.0, 1.15}) {
    room.addBox(place.at(x, 0.35, 0.0), {0.06, 0.7, height}, paintedWood(0.6));
  }
  for (int level = 0; level < levels; ++level) {
    const double z = 0.12 + level * (height - 0.15) / levels;
    room.addBox(place.at(0.0, 0.35, z), {2.36, 0.68, 0.04}, paintedWood(0.8));
    for (const double x : {-0.85, -0.28, 0.3, 0.86}) {
      if (room.chance(0.15)) continue;
      room.addBox(place.at(x, 0.35, z + 0.04, room.uniform(-0.15, 0.15)),
                  {room.uniform(0.35, 0.5), 0.5, room.uniform(0.25, 0.5)}, printed(room), printed(room));
    }
  }
}

void addLockers(RoomBuilder& room, const Place& place) {
  const double height = room.uniform(1.6, 2.0);
  for (int door = 0; door < 3; ++door) {
    room.addBox(place.at(0.8 * (door - 1), 0.25, 0.0), {0.78, 0.5, height}, printed(room));
  }
}

void addBanner(RoomBuilder& room, const Place& place, double width, double height) {
  const Pattern patterns[] = {Pattern::kPicture, Pattern::kPicture, Pattern::kPage, Pattern::kCarpet};
  room.addRectangle(place.at(0.0, 0.02, 0.0).origin, facing(place), -Eigen::Vector3d::UnitZ(), width, height,
                    {patterns[room.random().uniform(0, 4)], 0.004, true, 1.0});
}

void addBeam(RoomBuilder& room, const Place& place, double length) {
  constexpr double kDepth = 0.18;  // [m]
  room.addBox(place.at(0.0, 0.0, -kDepth), {length, 0.16, kDepth}, paintedWood(0.9));
}

void addCeilingLamp(RoomBuilder& room, const Place& place) {
  const Place below = place.at(0.0, 0.0, -0.04);
  room.addBox(below, {1.25, 0.62, 0.04}, {Pattern::kPanel, 0.0025, true, 1.1});
}

}  // namespace mba_vo
