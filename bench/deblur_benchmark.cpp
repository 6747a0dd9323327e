// Time of deblurring one keyframe of 752x480 along its path, by the length of the blur, one thread, with and without a
// second frame; and of the blur operator alone.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>

#include "mba_vo/deblur/blur_operator.h"
#include "mba_vo/deblur/trajectory_deblurrer.h"
#include "mba_vo/simulation/simulator.h"

namespace mba_vo {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr int kDepthSpacing = 18;   // [px], some 1000 points

const Simulator& simulator() {
  static const Simulator kSimulator([] {
    SimulationConfig config;
    config.depth = true;
    return config;
  }());
  return kSimulator;
}

/// A camera that turns so that the image moves by `blur_px`, as much sideways as up.
Vector6 turning(double blur_px) {
  const double rate = blur_px / (std::sqrt(2.0) * simulator().camera().fx * kExposure);  // [rad/s]
  return (Vector6() << 0, 0, 0, rate, rate, 0).finished();
}

SimulatedFrame render(const Vector6& velocity) {
  const SE3 origin = simulator().pose(1.0);
  return simulator().renderExposure([&](double t) { return origin * SE3::exp(t * velocity); }, 0.0, kExposure);
}

std::shared_ptr<const ImagePyramid> pyramidOf(const SimulatedFrame& frame) {
  cv::Mat1f intensity;
  frame.blurred.convertTo(intensity, CV_32F);
  return std::make_shared<const ImagePyramid>(intensity, simulator().camera(), 6);
}

DeblurInput makeInput(double blur_px) {
  const Vector6 velocity = turning(blur_px);
  const SimulatedFrame frame = render(velocity);
  DeblurInput input;
  input.image = pyramidOf(frame);
  input.motion = {SE3(), velocity, kExposure};
  for (int y = 0; y < frame.depth.rows; y += kDepthSpacing) {
    for (int x = 0; x < frame.depth.cols; x += kDepthSpacing) {
      input.depths.push_back({{static_cast<float>(x), static_cast<float>(y)}, 1.0F / frame.depth(y, x)});
    }
  }
  return input;
}

void deblur(benchmark::State& state) {
  cv::setNumThreads(1);
  const DeblurInput input = makeInput(static_cast<double>(state.range(0)));
  const TrajectoryDeblurrer deblurrer({});
  for (auto _ : state) benchmark::DoNotOptimize(deblurrer.deblur(input));
}
BENCHMARK(deblur)->Arg(4)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

/// The second one is smeared as far, across.
void deblurTwoFrames(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto blur_px = static_cast<double>(state.range(0));
  DeblurInput input = makeInput(blur_px);
  Vector6 across = turning(blur_px);
  across(3) = -across(3);
  DeblurNeighbour neighbour;
  neighbour.image = pyramidOf(render(across));
  neighbour.motion = {SE3(), across, kExposure};
  input.neighbours.push_back(neighbour);
  TrajectoryDeblurConfig config;
  config.frames = 2;
  const TrajectoryDeblurrer deblurrer(config);
  for (auto _ : state) {
    if (!deblurrer.deblur(input).neighbour.sequence) state.SkipWithError("the second frame was not used");
  }
}
BENCHMARK(deblurTwoFrames)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

void blurAndBack(benchmark::State& state) {
  const auto blur_px = static_cast<int>(state.range(0));
  const PinholeCamera camera = simulator().camera();
  const LatentGrid grid = BlurOperator::gridFor(camera, blur_px);
  const BlurOperator blur({camera, camera, {SE3(), turning(blur_px), kExposure}},
                          cv::Mat1f(camera.height, camera.width, 0.5F), grid);
  cv::Mat1f latent(grid.size, 100.0F);
  cv::Mat1f blurred;
  for (auto _ : state) {
    blur.apply(latent, blurred);
    blur.addTransposed(blurred, latent);
    benchmark::ClobberMemory();
    latent.setTo(100.0F);
  }
}
BENCHMARK(blurAndBack)->Arg(4)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mba_vo

BENCHMARK_MAIN();
