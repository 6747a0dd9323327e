#include "mba_vo/simulation/furniture.h"

namespace mba_vo {
namespace {

Skin wood(double gain = 1.0) { return {Pattern::kWood, 0.0015, false, gain}; }
Skin fabric(double gain = 1.0) { return {Pattern::kFabric, 0.0015, false, gain}; }

void addLegs(RoomBuilder& room, const Place& center, double width, double depth, double height) {
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      room.addBox(center.at(x * (width - 0.06), y * (depth - 0.06), 0.0), {0.05, 0.05, height}, wood(0.7));
    }
  }
}

void addChair(RoomBuilder& room, const Place& center) {
  addLegs(room, center, 0.44, 0.44, 0.44);
  room.addBox(center.at(0.0, 0.0, 0.44), {0.46, 0.46, 0.05}, fabric());
  for (const double x : {-0.19, 0.19}) room.addBox(center.at(x, 0.2, 0.49), {0.04, 0.04, 0.45}, wood(0.7));
  room.addBox(center.at(0.0, 0.2, 0.68), {0.42, 0.03, 0.22}, fabric());
}

void addMonitor(RoomBuilder& room, const Place& foot) {
  const Skin dark{Pattern::kStone, 0.004, false, 0.35};
  room.addBox(foot, {0.24, 0.18, 0.015}, dark);
  room.addBox(foot.at(0.0, -0.03, 0.015), {0.05, 0.03, 0.12}, dark);
  room.addBox(foot.at(0.0, 0.0, 0.12), {0.56, 0.03, 0.34}, dark);
  const Place screen = foot.at(0.0, 0.017, 0.29);
  const Eigen::Vector3d normal = foot.at(0.0, 1.0, 0.0).origin - foot.origin;
  room.addRectangle(screen.origin, normal, -Eigen::Vector3d::UnitZ(), 0.52, 0.3,
                    {room.chance(0.5) ? Pattern::kPage : Pattern::kPicture, 0.001, true, 0.9});
}

}  // namespace

Skin printed(RoomBuilder& room) {
  const Pattern patterns[] = {Pattern::kPicture, Pattern::kPicture, Pattern::kPage,
                              Pattern::kPanel,   Pattern::kStone,   Pattern::kCarpet};
  const Pattern pattern = patterns[room.random().uniform(0, 6)];
  return {pattern, 0.0012, pattern != Pattern::kStone, room.uniform(0.7, 1.1)};
}

void addClutter(RoomBuilder& room, const Place& place, double width, double depth, int count) {
  for (int i = 0; i < count; ++i) {
    // One strip of the width each, so that things do not run into each other.
    const double strip = width / count;
    const double x = -0.5 * width + (i + room.uniform(0.4, 0.6)) * strip;
    const double y = room.uniform(-0.3, 0.3) * depth;
    const Place spot = place.at(x, y, 0.0, room.uniform(-0.6, 0.6));
    const double base = std::min(0.75 * strip, room.uniform(0.1, 0.22));
    if (room.chance(0.3)) {
      room.addBox(spot, {base, 1.35 * base, 0.004}, {Pattern::kPage, 0.001, true, 1.0});
    } else if (room.chance(0.4)) {
      double height = 0.0;
      for (int book = 0; book < 4; ++book) {
        const double thickness = room.uniform(0.02, 0.045);
        room.addBox(spot.at(0.0, 0.0, height, room.uniform(-0.3, 0.3)), {base, 0.75 * base, thickness},
                    {Pattern::kBooks, 0.0006, false, 1.0}, printed(room));
        height += thickness;
      }
    } else {
      room.addBox(spot, {base, 0.8 * base, room.uniform(0.08, 0.3)}, printed(room), printed(room));
    }
  }
}

void addBookshelf(RoomBuilder& room, const Place& place) {
  const double width = room.uniform(1.0, 1.35);
  const double depth = 0.32;
  const double pitch = 0.36;
  const int shelves = room.random().uniform(4, 6);
  const double height = shelves * pitch + 0.03;
  for (const double x : {-0.5, 0.5}) room.addBox(place.at(x * width, 0.5 * depth, 0.0), {0.03, depth, height}, wood());
  room.addBox(place.at(0.0, 0.01, 0.0), {width, 0.01, height}, wood(0.6));
  for (int i = 0; i <= shelves; ++i) {
    const Place shelf = place.at(0.0, 0.5 * depth, i * pitch);
    room.addBox(shelf, {width - 0.03, depth, 0.025}, wood());
    if (i == shelves) continue;
    const double filled = room.uniform(0.45, 0.8) * width;
    const Skin spines{Pattern::kBooks, 0.001, true, room.uniform(0.8, 1.1)};
    room.addBox(shelf.at(-0.5 * (width - filled) + 0.03, -0.03, 0.025), {filled, 0.22, room.uniform(0.22, 0.3)}, spines,
                {Pattern::kPage, 0.001, false, 0.8});
    const double rest = width - filled - 0.12;
    addClutter(room, shelf.at(0.5 * (width - rest) - 0.03, 0.0, 0.025), rest, 0.2, rest > 0.3 ? 2 : 1);
  }
  addClutter(room, place.at(0.0, 0.5 * depth, height), width, 0.25, 3);
}

void addDesk(RoomBuilder& room, const Place& place) {
  const double width = room.uniform(1.2, 1.4);
  const double depth = 0.68;
  const Place middle = place.at(0.0, 0.5 * depth + 0.02, 0.0);
  room.addBox(middle.at(0.0, 0.0, 0.71), {width, depth, 0.03}, wood());
  addLegs(room, middle, width, depth, 0.71);
  room.addBox(middle.at(0.5 * width - 0.25, 0.0, 0.08), {0.4, depth - 0.1, 0.63}, {Pattern::kPanel, 0.0015, true, 0.9},
              wood());
  const Place top = middle.at(0.0, 0.0, 0.74);
  addMonitor(room, top.at(-0.1, -0.15, 0.0, room.uniform(-0.2, 0.2)));
  room.addBox(top.at(-0.1, 0.16, 0.0, room.uniform(-0.1, 0.1)), {0.42, 0.14, 0.02},
              {Pattern::kPanel, 0.0007, false, 0.8});
  addClutter(room, top.at(0.42, 0.0, 0.0), 0.4, 0.5, 2);
  addClutter(room, top.at(-0.5, 0.1, 0.0), 0.25, 0.4, 1);
  addChair(room, place.at(-0.1, depth + 0.22, 0.0, room.uniform(-0.5, 0.5)));
}

void addCabinet(RoomBuilder& room, const Place& place) {
  const double width = room.uniform(0.9, 1.3);
  const double depth = room.uniform(0.4, 0.5);
  const double height = room.uniform(0.7, 1.15);
  const Place middle = place.at(0.0, 0.5 * depth, 0.0);
  room.addBox(middle, {width, depth, height}, wood(), wood());
  const Eigen::Vector3d normal = place.at(0.0, 1.0, 0.0).origin - place.origin;
  for (int door = 0; door < 3; ++door) {
    const Place center = middle.at((door - 1) * width / 3.0, 0.5 * depth + 0.008, 0.0);
    room.addBox(center.at(0.0, 0.0, 0.06), {width / 3.0 - 0.03, 0.016, height - 0.12},
                {room.chance(0.5) ? Pattern::kWood : Pattern::kPanel, 0.002, false, room.uniform(0.8, 1.2)});
    room.addRectangle(center.at(0.0, 0.012, 0.5 * height).origin, normal, -Eigen::Vector3d::UnitZ(), 0.02, 0.14,
                      {Pattern::kPlaster, 0.002, false, 0.25});
  }
  addClutter(room, middle.at(0.0, 0.0, height), width, depth, 4);
}

void addSofa(RoomBuilder& room, const Place& place) {
  const double width = 1.45;
  const Place middle = place.at(0.0, 0.42, 0.0);
  const Skin cover = fabric(0.9);
  room.addBox(middle.at(0.0, 0.0, 0.08), {width, 0.8, 0.34}, cover);
  room.addBox(middle.at(0.0, -0.31, 0.42), {width, 0.18, 0.42}, cover);
  for (const double x : {-0.5, 0.5}) room.addBox(middle.at(x * (width - 0.16), 0.0, 0.42), {0.16, 0.8, 0.2}, cover);
  for (const double x : {-0.35, 0.05, 0.4}) {
    const Pattern pattern = room.chance(0.5) ? Pattern::kCarpet : Pattern::kPicture;
    room.addBox(middle.at(x, -0.12, 0.42, room.uniform(-0.35, 0.35)), {0.34, 0.12, 0.32}, {pattern, 0.001, true, 0.9});
  }
}

void addStack(RoomBuilder& room, const Place& place) {
  for (int column = 0; column < 3; ++column) {
    const int boxes = room.random().uniform(1, 5);
    double height = 0.0;
    for (int i = 0; i < boxes; ++i) {
      const double side = room.uniform(0.28, 0.4);
      const double tall = room.uniform(0.2, 0.42);
      room.addBox(place.at(-0.45 + 0.45 * column, 0.3, height, room.uniform(-0.3, 0.3)), {side, 0.9 * side, tall},
                  printed(room), printed(room));
      height += tall;
    }
  }
}

void addLowTable(RoomBuilder& room, const Place& place) {
  room.addBox(place.at(0.0, 0.0, 0.0, 0.2), {2.2, 1.6, 0.01}, {Pattern::kCarpet, 0.002, false, 0.9});
  addLegs(room, place, 1.0, 0.6, 0.4);
  room.addBox(place.at(0.0, 0.0, 0.4), {1.1, 0.65, 0.03}, wood());
  addClutter(room, place.at(0.0, 0.0, 0.43), 1.0, 0.5, 4);
}

void addPoster(RoomBuilder& room, const Place& place, double width, double height) {
  const Eigen::Vector3d normal = place.at(0.0, 1.0, 0.0).origin - place.origin;
  room.addBox(place.at(0.0, 0.008, -0.5 * height), {width, 0.016, height}, wood(0.5));
  room.addRectangle(place.at(0.0, 0.018, 0.0).origin, normal, -Eigen::Vector3d::UnitZ(), width - 0.04, height - 0.04,
                    {Pattern::kPicture, 0.001, true, 1.0});
}

void addWindow(RoomBuilder& room, const Place& place) {
  const double width = 1.3;
  const double height = 1.1;
  const Eigen::Vector3d normal = place.at(0.0, 1.0, 0.0).origin - place.origin;
  room.addRectangle(place.at(0.0, 0.01, 0.0).origin, normal, -Eigen::Vector3d::UnitZ(), width, height,
                    {Pattern::kPicture, 0.001, true, 1.1});
  for (const double x : {-0.5, 0.0, 0.5}) {
    room.addBox(place.at(x * width, 0.03, -0.5 * height), {0.06, 0.06, height}, wood(1.3));
  }
  for (const double z : {-0.5, 0.1, 0.5}) room.addBox(place.at(0.0, 0.03, z * height), {width, 0.05, 0.05}, wood(1.3));
}

}  // namespace mba_vo
