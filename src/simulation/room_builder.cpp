#include "mba_vo/simulation/room_builder.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

namespace mba_vo {
namespace {

constexpr int kTextureSide = 512;  // [texels]

constexpr int variants(Pattern pattern) {
  if (pattern == Pattern::kPicture) return 10;
  if (pattern == Pattern::kPage || pattern == Pattern::kBooks || pattern == Pattern::kPanel) return 3;
  return 2;
}

/// Diffuse light of the lamps and of the room's own reflections at a point of a surface.
double lightAt(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, const std::vector<Lamp>& lamps) {
  double light = 0.58 + 0.06 * normal.z() + 0.05 * normal.x() - 0.04 * normal.y();
  for (const Lamp& lamp : lamps) {
    const Eigen::Vector3d to_lamp = lamp.position - point;
    const double distance = to_lamp.norm();
    light += lamp.strength * std::max(0.0, normal.dot(to_lamp) / distance) / (1.0 + distance * distance);
  }
  return light;
}

/// Least-squares fit of the polynomial of Surface::light.
std::array<float, 6> fitLight(const Surface& s, double gain, const std::vector<Lamp>& lamps) {
  constexpr int kSamples = 6;
  Eigen::Matrix<double, kSamples * kSamples, 6> terms;
  Eigen::Matrix<double, kSamples * kSamples, 1> values;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const int row = i / kSamples;
    const double u = s.length_u * (i % kSamples) / (kSamples - 1);
    const double v = s.length_v * row / (kSamples - 1);
    terms.row(i) << 1.0, u, v, u * u, u * v, v * v;
    values(i) = 255.0 * gain * lightAt(s.origin + u * s.axis_u + v * s.axis_v, s.normal(), lamps);
  }
  const Eigen::Matrix<double, 6, 1> fitted = terms.colPivHouseholderQr().solve(values);
  std::array<float, 6> light{};
  for (int i = 0; i < 6; ++i) light[static_cast<std::size_t>(i)] = static_cast<float>(fitted(i));
  return light;
}

}  // namespace

Place Place::at(double x, double y, double z, double turn) const {
  const Eigen::Vector3d offset = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(x, y, z);
  return {origin + offset, yaw + turn};
}

RoomBuilder::RoomBuilder(int seed)
    : random_(0x5EED0000ULL + static_cast<std::uint64_t>(seed)),
      lamps_({{{1.1, 0.7, 2.2}, 2.2}, {{-1.3, -0.6, 2.2}, 1.8}, {{0.2, -2.0, 1.6}, 0.9}}) {  // the last is a window
  for (int i = 0; i < 8; ++i) random_.next();  // neighbouring seeds start alike
  for (int pattern = 0; pattern < kPatterns; ++pattern) {
    for (int i = 0; i < variants(static_cast<Pattern>(pattern)); ++i) {
      const std::uint64_t high = random_.next();
      textures_.emplace_back(static_cast<Pattern>(pattern), (high << 32) | random_.next());
    }
  }
}

int RoomBuilder::chooseTexture(Pattern pattern) {
  int first = 0;
  while (textures_[static_cast<std::size_t>(first)].first != pattern) ++first;
  return first + random_.uniform(0, variants(pattern));
}

void RoomBuilder::addRectangle(const Eigen::Vector3d& center, const Eigen::Vector3d& normal,
                               const Eigen::Vector3d& down, double width, double height, const Skin& skin) {
  Surface s;
  s.axis_v = down;
  s.axis_u = down.cross(normal);
  s.length_u = width;
  s.length_v = height;
  s.origin = center - 0.5 * width * s.axis_u - 0.5 * height * s.axis_v;
  s.texture = chooseTexture(skin.pattern);
  if (skin.whole) {
    s.scale_u = kTextureSide / width;
    s.scale_v = kTextureSide / height;
    s.offset_u = s.offset_v = -0.5;  // texel centres are at integers
  } else {
    s.scale_u = s.scale_v = 1.0 / skin.texel;
    s.offset_u = uniform(0.0, kTextureSide);
    s.offset_v = uniform(0.0, kTextureSide);
  }
  s.light = fitLight(s, skin.gain, lamps_);
  surfaces_.push_back(s);
}

void RoomBuilder::addBox(const Place& place, const Eigen::Vector3d& size, const Skin& sides, const Skin& top) {
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(place.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d x = axes.col(0);
  const Eigen::Vector3d y = axes.col(1);
  const Eigen::Vector3d z = axes.col(2);
  const Eigen::Vector3d center = place.origin + 0.5 * size.z() * z;
  for (const double side : {-1.0, 1.0}) {
    addRectangle(center + 0.5 * side * size.x() * x, side * x, -z, size.y(), size.z(), sides);
    addRectangle(center + 0.5 * side * size.y() * y, side * y, -z, size.x(), size.z(), sides);
    addRectangle(center + 0.5 * side * size.z() * z, side * z, -y, size.x(), size.y(), top);
  }
}

bool RoomBuilder::attempt(const std::function<void()>& add) {
  const auto before = static_cast<std::ptrdiff_t>(surfaces_.size());
  add();
  if (!forbidden_ || std::none_of(surfaces_.begin() + before, surfaces_.end(), forbidden_)) return true;
  surfaces_.erase(surfaces_.begin() + before, surfaces_.end());
  return false;
}

Scene RoomBuilder::build() {
  Scene scene;
  scene.surfaces = std::move(surfaces_);
  for (const auto& [pattern, state] : textures_) {
    scene.textures.emplace_back([pattern = pattern, state = state] {
      cv::RNG random(state);
      return Texture(paintPattern(pattern, kTextureSide, random));
    });
  }
  return scene;
}

}  // namespace mba_vo
