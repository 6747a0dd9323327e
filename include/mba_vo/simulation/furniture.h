#pragma once

#include "mba_vo/simulation/room_builder.h"

namespace mba_vo {

/// A side full of detail.
Skin printed(RoomBuilder& room);

/// Pieces of furniture, each about 1.4 m wide, with its back at y = 0 of `place`.
void addBookshelf(RoomBuilder& room, const Place& place);
void addDesk(RoomBuilder& room, const Place& place);
void addCabinet(RoomBuilder& room, const Place& place);
void addSofa(RoomBuilder& room, const Place& place);
void addStack(RoomBuilder& room, const Place& place);
/// Centred on `place`.
void addLowTable(RoomBuilder& room, const Place& place);
/// Small things strewn over a width by depth [m] centred on `place`.
void addClutter(RoomBuilder& room, const Place& place, double width, double depth, int count);
/// A framed picture with its middle at `place`, facing y.
void addPoster(RoomBuilder& room, const Place& place, double width, double height);
/// A window with its middle at `place`, facing y.
void addWindow(RoomBuilder& room, const Place& place);

}  // namespace mba_vo
