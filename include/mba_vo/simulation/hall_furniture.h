#pragma once

#include "mba_vo/simulation/room_builder.h"

namespace mba_vo {

/// Things for the middle of a room or for a hall: larger and of fewer parts than furniture. Centred on `place`, within
/// a circle of 1.2 m.
void addPillar(RoomBuilder& room, const Place& place, double height);
void addCrates(RoomBuilder& room, const Place& place, int layers);
void addBoard(RoomBuilder& room, const Place& place);  // a partition with pictures on both sides
void addWorkbench(RoomBuilder& room, const Place& place);
void addMat(RoomBuilder& room, const Place& place);  // flat on the floor

/// With its back at y = 0 of `place`, 2.4 m wide.
void addRack(RoomBuilder& room, const Place& place);
void addLockers(RoomBuilder& room, const Place& place);
/// A large printed cloth on a wall with its middle at `place`, facing y.
void addBanner(RoomBuilder& room, const Place& place, double width, double height);

/// A beam under a ceiling along x of `place`, hanging down from its origin.
void addBeam(RoomBuilder& room, const Place& place, double length);
/// A lamp in a ceiling at `place`, looking down.
void addCeilingLamp(RoomBuilder& room, const Place& place);

}  // namespace mba_vo
