#include "mba_vo/window/window_state.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace mba_vo {

void checkImages(const WindowKeyframe& keyframe, bool reblur_targets) {
  const std::string name = "window: keyframe " + std::to_string(keyframe.id);
  if (keyframe.sharp == nullptr || keyframe.sharp->levels() == 0) {
    throw std::invalid_argument(name + " has no sharp image");
  }
  if (reblur_targets && (keyframe.original == nullptr || keyframe.original->levels() == 0)) {
    throw std::invalid_argument(name + " has no original image, which reblur_targets needs");
  }
}

KeyframeState::KeyframeState(const WindowKeyframe& entering)
    : id(entering.id),
      sharp(entering.sharp),
      original(entering.original),
      xi(entering.xi),
      image_xi(entering.image_xi),
      velocity(entering.motion.velocity),
      expected_velocity(entering.motion.velocity),
      acceleration(entering.motion.acceleration),
      correction(entering.correction),
      T_linear(entering.T_map_keyframe),
      brightness_linear(entering.brightness),
      blur_length_px(entering.blur_length_px) {}

void KeyframeState::setMotion(const Vector6& motion) {
  if (const double seconds = exposure(); seconds > 0.0) velocity = motion / seconds;
  if (!image_xi.isZero(0.0)) image_xi = motion;
  xi = motion;
}

void KeyframeState::setVelocity(const Vector6& moving) {
  if (const double seconds = exposure(); seconds > 0.0) setMotion(moving * seconds);
  velocity = moving;
}

double KeyframeState::readoutTime() const {
  const PinholeCamera& camera = original->level(0).camera;
  return camera.row_time * camera.height + lacking[CalibrationCorrection::kReadout];
}

int WindowState::indexOf(KeyframeId id) const {
  for (int i = 0; i < size(); ++i) {
    if (keyframe(i).id == id) return i;
  }
  throw std::invalid_argument("window: keyframe " + std::to_string(id) + " is not one of its " +
                              std::to_string(size()) + " keyframes");
}

Eigen::VectorXd WindowState::deltas() const {
  Eigen::VectorXd d(kKeyframeDim * size());
  for (int i = 0; i < size(); ++i) d.segment<kKeyframeDim>(kKeyframeDim * i) = keyframe(i).delta;
  return d;
}

void WindowState::relinearize() {
  for (int i = 0; i < size(); ++i) {
    KeyframeState& k = keyframe(i);
    if (prior.connected(i) || k.delta.isZero(0.0)) continue;
    prior.moveLinearizationPoint(i, k.delta);
    k.T_linear = k.T_map_keyframe();
    k.brightness_linear = k.brightness();
    k.delta.setZero();
  }
}

void WindowState::replaceImage(int i, std::shared_ptr<const ImagePyramid> sharp) {
  keyframe(i).sharp = std::move(sharp);
  keyframe(i).image_xi.setZero();
  readAgain(i);
  // As a target it may be itself what is read.
  for (PointState& point : points) {
    for (PatchResidual& residual : point.residuals) {
      if (residual.target == i) residual.has_pixels = false;
    }
  }
}

void WindowState::setExposure(int i, double exposure, bool image_is_blurred) {
  KeyframeState& k = keyframe(i);
  // Rows tell the velocity without the exposure; what the blur said of it was said with the old one.
  const Vector6& moving = k.readoutTime() != 0.0 ? k.velocity : k.expected_velocity;
  k.xi = exposure * moving;
  k.velocity = moving;
  k.image_xi = image_is_blurred ? k.xi : Vector6::Zero();
  readAgain(i);
}

void WindowState::setMotion(int i, const BodyMotion& motion) {
  KeyframeState& k = keyframe(i);
  k.expected_velocity = motion.velocity;
  if (k.readoutTime() != 0.0) return;  // the rows have told more (Window::refineRowMotions)
  k.acceleration = motion.acceleration;
  k.setVelocity(motion.velocity);
  readAgain(i);
}

void WindowState::readAgain(int i) {
  for (PointState& point : points) {
    if (point.host != i) continue;
    for (PatchResidual& residual : point.residuals) residual.has_pixels = false;
  }
}

void WindowState::removeKeyframe(int i) {
  points.erase(std::remove_if(points.begin(), points.end(), [i](const PointState& p) { return p.host == i; }),
               points.end());
  for (PointState& point : points) {
    auto& residuals = point.residuals;
    residuals.erase(
        std::remove_if(residuals.begin(), residuals.end(), [i](const PatchResidual& r) { return r.target == i; }),
        residuals.end());
    for (PatchResidual& residual : residuals) residual.target -= residual.target > i ? 1 : 0;
    point.host -= point.host > i ? 1 : 0;
  }
  keyframes.erase(keyframes.begin() + i);
}

int WindowState::goodResiduals(const PointState& point) const {
  return static_cast<int>(std::count_if(point.residuals.begin(), point.residuals.end(),
                                        [this](const PatchResidual& r) { return isGood(r); }));
}

bool WindowState::hasMeasuredDepths() const {
  return std::any_of(points.begin(), points.end(), [](const PointState& point) { return point.measured.known(); });
}

double WindowState::meanPrecision() const {
  double sum = 0.0;
  int count = 0;
  for (const KeyframeState& keyframe : keyframes) {
    if (std::isinf(keyframe.huber_threshold)) continue;  // no residuals yet
    sum += static_cast<double>(keyframe.precision);
    ++count;
  }
  return count > 0 ? sum / count : 1.0;
}

}  // namespace mba_vo
