// Times of the re-blurring kernel and of one Tracker::track() at 752x480 on rendered images, one thread.
#include <benchmark/benchmark.h>

#include <memory>

#include "mba_vo/blur/reblur.h"
#include "mba_vo/image/point_selector.h"
#include "mba_vo/simulation/simulator.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {
namespace {

constexpr double kExposure = 0.02;        // [s]
constexpr double kInterval = 1.0 / 27.0;  // [s]

SimulationConfig simulationConfig() {
  SimulationConfig config;
  config.sharp = true;
  config.depth = true;
  return config;
}

const Simulator& simulator() {
  static const Simulator kSimulator(simulationConfig());
  return kSimulator;
}

std::shared_ptr<const ImagePyramid> pyramidOf(const cv::Mat1b& image) {
  cv::Mat1f intensity;
  image.convertTo(intensity, CV_32F);
  return std::make_shared<const ImagePyramid>(intensity, simulator().camera(), 6);
}

/// A camera turning about its y axis so that the blur is `blur_px` in the middle of the image.
PoseFunction turning(double blur_px) {
  const SE3 origin = simulator().pose(1.0);
  const double rate = blur_px / (simulator().camera().fx * kExposure);  // [rad/s]
  return [origin, rate](double t) { return origin * SE3::exp((Vector6() << 0, 0, 0, 0, rate * t, 0).finished()); };
}

Reference trueReference() {
  const SimulatedFrame frame = simulator().renderExposure(turning(0.0), 0.0, 0.0);
  Reference reference;
  reference.pyramid = pyramidOf(frame.sharp);
  for (const Eigen::Vector2i& pixel : selectPoints(*reference.pyramid, 2000, {})) {
    const float depth = frame.depth(pixel.y(), pixel.x());
    reference.points.push_back({pixel.cast<float>(), 1.0F / depth, 1e-6F});
  }
  return reference;
}

void track(benchmark::State& state) {
  const auto blur_px = static_cast<double>(state.range(0));
  const Reference reference = trueReference();
  const PoseFunction motion = turning(blur_px);
  const SimulatedFrame rendered = simulator().renderExposure(motion, kInterval, kExposure);
  auto frame = std::make_shared<Frame>();
  frame->exposure = kExposure;
  frame->pyramid = *pyramidOf(rendered.blurred);
  MotionPrior prior;
  // The guess is off by half a degree, as the constant velocity of a shaken hand is.
  const Vector6 error = (Vector6() << 0, 0, 0, 0.006, 0.006, 0).finished();
  prior.previous = {SE3(), (motion(0.0).inverse() * motion(kInterval) * SE3::exp(error)).log() / kInterval, kExposure};
  prior.dt = kInterval;
  TrackerConfig config;
  config.max_points = static_cast<int>(state.range(1));
  const Tracker tracker(config);
  TrackedFrame tracked;
  for (auto _ : state) tracked = tracker.track(reference, frame, TrackingGuess(prior, blur_px > 0.0 ? kExposure : 0.0));
  state.counters["patches"] = tracked.points_used;
  state.counters["blur_px"] = tracked.measures.blur_length_px;
  state.SetLabel(toString(tracked.status));
}
// By default, and with about 440 patches on the finest level.
BENCHMARK(track)->ArgsProduct({{0, 10, 40}, {TrackerConfig().max_points, 520}})->Unit(benchmark::kMillisecond);

/// One 9x9 patch, or one sparse 8-pixel patch, of `samples` samples.
void reblur(benchmark::State& state, const PatchPattern& pattern) {
  const auto image = pyramidOf(simulator().renderExposure(turning(0.0), 0.0, 0.0).sharp);
  const auto samples = static_cast<int>(state.range(0));
  PatchPath path;
  const ExposureTrajectory motion{SE3(), (Vector6() << 0, 0, 0, 0.5, 1.0, 0).finished(), kExposure};
  makePatchPath(simulator().camera(), simulator().camera(), motion, {300.0, 200.0}, 0.5, path);
  ReblurredPatch patch;
  for (auto _ : state) {
    reblurPatch(image->level(0), path, pattern, samples, patch);
    benchmark::DoNotOptimize(patch);
  }
  using Counter = benchmark::Counter;
  const double pixel_samples = static_cast<double>(pattern.size) * samples;
  state.counters["s per pixel-sample"] = Counter(pixel_samples, Counter::kIsIterationInvariantRate | Counter::kInvert);
}
BENCHMARK_CAPTURE(reblur, square9, PatchPattern::square(9))->Arg(1)->Arg(8)->Arg(32);
BENCHMARK_CAPTURE(reblur, spread8, PatchPattern::spread8())->Arg(1)->Arg(8)->Arg(32);

}  // namespace
}  // namespace mba_vo

BENCHMARK_MAIN();
