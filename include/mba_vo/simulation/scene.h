#pragma once

#include <array>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/lazy.h"
#include "mba_vo/simulation/texture.h"

namespace mba_vo {

/// A textured rectangle, visible from the side that axis_u x axis_v points to.
struct Surface {
  Eigen::Vector3d origin;  // corner [m, world]
  Eigen::Vector3d axis_u;  // unit
  Eigen::Vector3d axis_v;  // unit, orthogonal to axis_u
  double length_u = 0.0;   // [m]
  double length_v = 0.0;   // [m]

  int texture = 0;
  // Texel = scale * (u or v) + offset.
  double scale_u = 500.0;  // [texels/m]
  double scale_v = 500.0;  // [texels/m]
  double offset_u = 0.0;   // [texels]
  double offset_v = 0.0;   // [texels]

  /// Light times 255 as c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2, u and v in [m].
  std::array<float, 6> light = {255.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};

  Eigen::Vector3d normal() const { return axis_u.cross(axis_v); }
};

/// World frame: z up, floor at z = 0, the camera moves around the origin of x and y.
struct Scene {
  std::vector<Surface> surfaces;
  std::deque<Lazy<Texture>> textures;  // painted when first seen: never, where frames are cached
};

/// Box in which a camera may move without touching anything.
struct FreeSpace {
  Eigen::Vector3d center = {0.0, 0.0, 1.45};      // [m]
  Eigen::Vector3d half_size = {1.0, 0.75, 0.25};  // [m]
};

/// A closed, furnished room. Nothing stands within 0.3 m of the free space.
Scene makeRoom(int seed);

/// A closed room around a camera's path, furnished along the walls and where the path leaves space; a hall, with things
/// that suit one, where the path is long. Nothing, the floor and the ceiling included, comes within 0.4 m of the path.
/// `path`: points at most 2.5 cm apart, their middle near x = y = 0, z > 0.45 [m, world].
Scene makeRoomAround(const std::vector<Eigen::Vector3d>& path, int seed);

}  // namespace mba_vo
