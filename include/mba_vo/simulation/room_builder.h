#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "mba_vo/simulation/scene.h"
#include "mba_vo/simulation/texture_painter.h"

namespace mba_vo {

/// How a side of a thing looks.
struct Skin {
  Pattern pattern = Pattern::kPlaster;
  double texel = 0.002;  // [m]
  bool whole = false;    // the texture fills the side once instead of repeating
  double gain = 1.0;     // factor on the reflectance
};

/// A place to put things: origin on the floor, x along a wall, y away from it, z up.
struct Place {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // [m, world]
  double yaw = 0.0;                                  // [rad]

  /// A place within this one.
  Place at(double x, double y, double z, double turn = 0.0) const;
};

/// A small lamp.
struct Lamp {
  Eigen::Vector3d position;  // [m, world]
  double strength;           // light on a surface before it, at its place
};

/// Collects textured boxes and rectangles, chooses their textures and lights them.
class RoomBuilder {
 public:
  explicit RoomBuilder(int seed);

  cv::RNG& random() { return random_; }
  double uniform(double lowest, double highest) { return random_.uniform(lowest, highest); }
  bool chance(double probability) { return random_.uniform(0.0, 1.0) < probability; }

  /// A box standing on `place`, centred on it in x and y.
  void addBox(const Place& place, const Eigen::Vector3d& size, const Skin& sides, const Skin& top);
  void addBox(const Place& place, const Eigen::Vector3d& size, const Skin& skin) { addBox(place, size, skin, skin); }

  /// A rectangle facing `normal`; `down` is the direction in which its texture runs from top to bottom.
  void addRectangle(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, const Eigen::Vector3d& down,
                    double width, double height, const Skin& skin);

  /// Lamps in place of those of the small room. They light what is added from then on.
  void setLamps(std::vector<Lamp> lamps) { lamps_ = std::move(lamps); }

  /// From then on attempt() leaves out what has a surface that is `forbidden`.
  void forbid(std::function<bool(const Surface&)> forbidden) { forbidden_ = std::move(forbidden); }
  /// Adds what `add` adds, or nothing if a part of it is forbidden; false then.
  bool attempt(const std::function<void()>& add);

  /// Hands the scene over.
  Scene build();

 private:
  int chooseTexture(Pattern pattern);

  cv::RNG random_;
  std::vector<Lamp> lamps_;
  std::function<bool(const Surface&)> forbidden_;
  std::vector<Surface> surfaces_;
  std::vector<std::pair<Pattern, std::uint64_t>> textures_;  // with the state of a random generator
};

}  // namespace mba_vo
