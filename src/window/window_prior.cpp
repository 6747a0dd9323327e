#include "mba_vo/window/window_prior.h"

#include <cmath>

namespace mba_vo {
namespace {

// Gauge: nothing observes the first keyframe's pose and brightness; any strong prior holds them.
constexpr double kPoseAnchor = 1e10;        // information of the first pose [1/m^2, 1/rad^2]
constexpr double kBrightnessAnchor = 1e10;  // information of the first keyframe's a and b

}  // namespace

void addPriorOf(int keyframe, const WindowConfig& config, WindowState& state) {
  Vector8 information = Vector8::Zero();
  Vector8 deviation = Vector8::Zero();
  if (keyframe == 0) {
    information << Vector6::Constant(kPoseAnchor), kBrightnessAnchor, kBrightnessAnchor;
    state.prior.connect(keyframe);
  } else {
    const AffineBrightness brightness = state.keyframe(keyframe).brightness();
    information(6) = std::pow(config.brightness_gain_sigma, -2.0);
    information(7) = std::pow(config.brightness_offset_sigma, -2.0);
    deviation.tail<2>() << brightness.a, brightness.b;
  }
  state.prior.addDiagonal(keyframe, information, deviation);
}

void beginPriorAnew(const WindowConfig& config, WindowState& state) {
  state.prior = {};
  for (int i = 0; i < state.size(); ++i) state.prior.appendKeyframe();
  state.relinearize();
  for (int i = 0; i < state.size(); ++i) addPriorOf(i, config, state);
}

}  // namespace mba_vo
