#include "mba_vo/simulation/hand_held_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

constexpr double kReferenceRate = 27.0;  // [Hz] of the error statistics
constexpr double kMedianError = 0.52;    // [deg] for unit shake, a little above the promised 0.5 and 1.1
constexpr double kUpperError = 1.15;     // [deg], 90 %
constexpr double kLargestError = 2.15;   // [deg]
constexpr double kBurst = 1.1;           // the strength varies between exp(-kBurst) and exp(kBurst)
constexpr double kLongestCalm = 10.0;    // [s]
constexpr double kDefaultSpeed = 0.4;    // [m/s]

/// World axes: x right of the start, z up. Camera axes: z forward, x right, y down; gaze 0 looks along world x.
Eigen::Quaterniond gazeRotation(double yaw, double pitch, double roll) {
  Eigen::Matrix3d R_world_level;
  R_world_level << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())) * Eigen::Quaterniond(R_world_level) *
         Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX())) *
         Eigen::Quaterniond(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace

std::vector<double> constantVelocityErrors(const std::vector<SE3>& T_world_camera) {
  std::vector<double> errors;
  for (std::size_t i = 2; i < T_world_camera.size(); ++i) {
    const Eigen::Quaterniond& a = T_world_camera[i - 2].rotation();
    const Eigen::Quaterniond& b = T_world_camera[i - 1].rotation();
    const Eigen::Quaterniond& c = T_world_camera[i].rotation();
    const Eigen::Quaterniond before = a.conjugate() * b;
    errors.push_back(kDegreesPerRadian * (b * before).angularDistance(c));
  }
  return errors;
}

double HandHeldMotion::sum(const Waves& waves, double t) {
  double value = 0.0;
  for (const Wave& wave : waves) value += wave.amplitude * std::sin(wave.frequency * t + wave.phase);
  return value;
}

HandHeldMotion::HandHeldMotion(const HandHeldMotionConfig& config, const FreeSpace& space) : space_(space) {
  cv::RNG random(0xCA3E5AULL + static_cast<std::uint64_t>(config.seed));
  for (int i = 0; i < 8; ++i) random.next();  // neighbouring seeds start alike
  // `count` waves between two frequencies [Hz] whose amplitudes add up to `bound`.
  const auto draw = [&](double lowest, double highest, int count, double bound) {
    Waves waves;
    for (int i = 0; i < count; ++i) {
      const double part = (i + random.uniform(0.2, 0.8)) / count;
      const double frequency = lowest * std::pow(highest / lowest, part);
      waves.push_back({bound / count, kTwoPi * frequency, random.uniform(0.0, kTwoPi)});
    }
    return waves;
  };
  for (int axis = 0; axis < 3; ++axis) {
    walk_[axis] = draw(0.06, 0.22, 3, axis == 2 ? 0.7 : 0.9);
    sway_[axis] = draw(0.6, 1.8, 4, 0.03);
    tremble_[axis] = draw(0.4, 1.7, 4, axis == 2 ? 0.12 : 0.2);
  }
  gaze_[0] = draw(0.03, 0.12, 3, 1.3);
  gaze_[1] = draw(0.05, 0.2, 3, 0.2);
  gaze_[2] = draw(0.05, 0.2, 3, 0.12);
  burst_ = draw(0.09, 0.5, 3, 1.0);
  // Once in every sequence the waves agree, so even a short one has its worst moment.
  const double worst = random.uniform(0.3, 0.7) * std::min(config.duration, kLongestCalm);
  for (Wave& wave : burst_) wave.phase = 0.25 * kTwoPi - wave.frequency * worst;
  yaw_ = random.uniform(0.0, kTwoPi);
  sway_scale_ = config.shake;
  calibrateShake(config);
  calibrateTempo(config);
  calibrateShake(config);  // walk and gaze add a little to the errors
}

SE3 HandHeldMotion::pose(double t) const {
  Eigen::Vector3d walk, sway, tremble;
  // Bursts: never still, sometimes several times as strong as in between.
  const double strength = std::exp(kBurst * sum(burst_, t));
  for (int axis = 0; axis < 3; ++axis) {
    walk[axis] = space_.center[axis] + space_.half_size[axis] * sum(walk_[axis], tempo_ * t);
    sway[axis] = sway_scale_ * strength * sum(sway_[axis], t);
    tremble[axis] = tremble_scale_ * strength * sum(tremble_[axis], t);
  }
  const Eigen::Quaterniond gaze =
      gazeRotation(yaw_ + sum(gaze_[0], tempo_ * t), -0.22 + sum(gaze_[1], tempo_ * t), sum(gaze_[2], tempo_ * t));
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = tremble;
  return SE3(gaze, walk + sway) * SE3::exp(turn);
}

double HandHeldMotion::pathLength(double duration) const {
  constexpr double kStep = 1.0 / 60.0;  // [s]
  double length = 0.0;
  Eigen::Vector3d previous = pose(0.0).translation();
  for (double t = kStep; t <= duration; t += kStep) {
    const Eigen::Vector3d current = pose(t).translation();
    length += (current - previous).norm();
    previous = current;
  }
  return length;
}

void HandHeldMotion::calibrateTempo(const HandHeldMotionConfig& config) {
  const double wanted = config.path_length > 0.0 ? config.path_length : kDefaultSpeed * config.duration;
  double slow = 0.0;
  double fast = 8.0;
  tempo_ = slow;
  const double shortest = pathLength(config.duration);
  tempo_ = fast;
  const double longest = pathLength(config.duration);
  if (config.path_length > 0.0 && (wanted < shortest || wanted > longest)) {
    std::ostringstream message;
    message << "path_length = " << wanted << " m cannot be walked in " << config.duration << " s with shake "
            << config.shake << ": allowed are " << shortest << " .. " << longest << " m";
    throw std::invalid_argument(message.str());
  }
  for (int i = 0; i < 30; ++i) {
    tempo_ = 0.5 * (slow + fast);
    (pathLength(config.duration) < wanted ? slow : fast) = tempo_;
  }
}

void HandHeldMotion::calibrateShake(const HandHeldMotionConfig& config) {
  const double duration = std::max(config.duration, 4.0);  // fewer frames have no meaningful quantiles
  double weak = 0.0;
  double strong = 4.0;
  for (int i = 0; i < 24; ++i) {
    tremble_scale_ = 0.5 * (weak + strong);
    std::vector<SE3> poses;
    for (double t = 0.0; t <= duration; t += 1.0 / kReferenceRate) poses.push_back(pose(t));
    const std::vector<double> errors = constantVelocityErrors(poses);
    const bool enough = quantile(errors, 0.5) >= kMedianError && quantile(errors, 0.9) >= kUpperError &&
                        quantile(errors, 1.0) >= kLargestError;
    (enough ? strong : weak) = tremble_scale_;
  }
  tremble_scale_ = config.shake * strong;
}

}  // namespace mba_vo
