#include "sequence.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/image/point_selector.h"
#include "mba_vo/simulation/hand_held_motion.h"
#include "mba_vo/simulation/room_builder.h"
#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/motion_state.h"

namespace mba_vo::study {
namespace {

constexpr double kDuration = 40.0;    // [s]
constexpr int kHistory = 4;           // frames before a measured one that its guesses are made of
constexpr int kKeyframeDelay = 2;     // frames until a keyframe becomes the reference
constexpr int kPoints = 2000;         // of a reference
constexpr float kDepthSigma = 1e-3F;  // relative
constexpr int kLevels = 6;
constexpr double kGoldenRatio = 0.6180339887498949;  // its multiples are spread evenly, however many they are
constexpr std::size_t kLongestSearch = 8;

SimulationConfig simulation(int seed, double exposure, bool depth) {
  SimulationConfig config;
  config.scene_seed = config.trajectory_seed = seed;
  config.exposure = exposure;
  config.duration = kDuration;
  config.depth = depth;
  return config;
}

cv::Mat1f toFloat(const cv::Mat1b& image) {
  cv::Mat1f result;
  image.convertTo(result, CV_32F);
  return result;
}

/// Mean image motion of points at 2 m between two poses [px].
double imageMotion(const PinholeCamera& camera, const SE3& T_world_a, const SE3& T_world_b) {
  SimulatedFrame motion;
  motion.T_world_start = motion.T_world_mid = T_world_a;
  motion.T_world_end = T_world_b;
  return blurAtTwoMetres(camera, motion);
}

ImagePyramid pyramidOf(const cv::Mat1b& image, const PinholeCamera& camera) {
  return ImagePyramid(toFloat(image), camera, kLevels);
}

/// The camera pans or tilts the other way than in the interval before.
bool reverses(const SE3& T_world_a, const SE3& T_world_b, const SE3& T_world_c) {
  const auto turn = [](const SE3& l, const SE3& r) { return (l.inverse() * r).log().segment<2>(3).eval(); };
  return (turn(T_world_a, T_world_b).array() * turn(T_world_b, T_world_c).array() < 0.0).any();
}

}  // namespace

Sequence::Sequence(int seed, const BlurClass& blur)
    : blur_(blur),
      room_(std::make_shared<const Scene>(makeRoom(seed))),
      blurred_(simulation(seed, blur.exposure, false), room_),
      sharp_(simulation(seed, 0.0, true), room_),
      blurred_images_(FrameCache::defaultFolder(), blurred_.config()),
      sharp_images_(FrameCache::defaultFolder(), sharp_.config()) {}

std::vector<Sequence::Keyframe> Sequence::keyframes() const {
  std::vector<Keyframe> keyframes(1);
  for (int i = kHistory; i < blurred_.frames(); ++i) {
    const double blur = blurred_.groundTruth(i).blur_px;
    if (blur >= blur_.least && blur <= blur_.most) keyframes.back().frames.push_back(i);
    const int newest = i + 1 - kKeyframeDelay;
    if (imageMotion(sharp_.camera(), pose(keyframes.back().index), pose(newest)) > KeyframePolicyConfig().flow_px) {
      if (keyframes.back().frames.empty()) keyframes.pop_back();
      keyframes.push_back({newest, {}});
    }
  }
  if (keyframes.back().frames.empty()) keyframes.pop_back();
  return keyframes;
}

void Sequence::forEach(int frames, const std::function<void(const Case&)>& use) {
  const std::vector<Keyframe> all = keyframes();
  std::vector<bool> used(all.size(), false);
  int count = 0;
  for (std::size_t k = 0; count < frames && k < kLongestSearch * all.size(); ++k) {
    const double part = std::fmod(static_cast<double>(k) * kGoldenRatio, 1.0);
    const auto i = static_cast<std::size_t>(part * static_cast<double>(all.size()));
    if (used[i]) continue;
    used[i] = true;
    loadReference(all[i].index);
    for (const int index : all[i].frames) use(makeCase(index));
    count += static_cast<int>(all[i].frames.size());
  }
}

void Sequence::loadReference(int index) {
  reference_view_ = renderCached(sharp_, index, sharp_images_);
  auto reference = std::make_shared<Reference>();
  reference->pyramid = std::make_shared<const ImagePyramid>(pyramidOf(reference_view_.blurred, sharp_.camera()));
  for (const Eigen::Vector2i& pixel : selectPoints(*reference->pyramid, kPoints, {})) {
    const float inverse_depth = 1.0F / reference_view_.depth(pixel.y(), pixel.x());
    const float sigma = kDepthSigma * inverse_depth;
    reference->points.push_back({pixel.cast<float>(), inverse_depth, sigma * sigma});
  }
  reference_ = reference;
}

MotionPrior Sequence::priorFrom(int last, int index) const {
  const SE3 T_reference_world = reference_view_.T_world_mid.inverse();
  // No velocity but the mean between two frames, as if the exposure told nothing.
  MotionState state({T_reference_world * pose(last - 2), Vector6::Zero(), 0.0}, blurred_.stampNs(last - 2));
  for (int i = last - 1; i <= last; ++i) {
    auto frame = std::make_shared<Frame>();
    frame->mid_exposure_ns = blurred_.stampNs(i);
    TrackedFrame tracked;
    tracked.frame = frame;
    tracked.trajectory.T_reference_mid = T_reference_world * pose(i);
    state.update(tracked);
  }
  return state.priorAt(blurred_.stampNs(index));
}

Case Sequence::makeCase(int index) const {
  const SimulatedFrame view = renderCached(blurred_, index, blurred_images_);
  auto frame = std::make_shared<Frame>();
  frame->sequence = view.id;
  frame->mid_exposure_ns = frame->stamp_ns = view.mid_exposure_ns;
  frame->exposure = view.exposure;
  frame->pyramid = pyramidOf(view.blurred, blurred_.camera());
  Case c;
  c.reference = reference_;
  c.reference_depth = reference_view_.depth;
  c.frame = frame;
  c.prior = priorFrom(index - 1, index);
  c.skipping = priorFrom(index - 2, index);
  c.T_reference_mid = reference_view_.T_world_mid.inverse() * view.T_world_mid;
  c.T_start_end = view.T_world_start.inverse() * view.T_world_end;
  c.blur_px = view.blur_px;
  c.prior_error_deg = constantVelocityErrors({pose(index - 2), pose(index - 1), pose(index)}).front();
  c.reversal = reverses(pose(index - 2), pose(index - 1), pose(index));
  return c;
}

}  // namespace mba_vo::study
