// Times of what the window's normal equations are made of, one thread, on random numbers.
#include <benchmark/benchmark.h>
#include <array>
#include <opencv2/imgproc.hpp>

#include "mba_vo/blur/moment_products.h"
#include "mba_vo/image/point_selector.h"
#include "mba_vo/solver/schur_complement.h"

namespace mba_vo {
namespace {

/// One residual: 8 states and parameters for poses and depths, 16 for the motion within the exposure or a calibration.
template <int kWidth>
void momentProducts(benchmark::State& state) {
  std::srand(1);
  std::array<SparsePixels, 9> z;
  for (SparsePixels& term : z) {
    for (float& value : term) value = Eigen::internal::random<float>(-1.0F, 1.0F);
  }
  SparsePixels weight;
  weight.fill(0.5F);
  MomentProducts<kWidth> products;
  products.E.setRandom();
  for (auto _ : state) {
    if constexpr (kWidth == 8) {
      multiplyOut(weight, {&z[0], &z[1], &z[2], &z[3], &z[4], &z[5], &z[6]}, 4, 7, products);
    } else {
      multiplyOut(weight, {&z[0], &z[1], &z[2], &z[3], &z[4], &z[5], &z[6], &z[7], &z[8]}, 6, kWidth, products);
    }
    benchmark::DoNotOptimize(products.ESE.data());
  }
}
BENCHMARK(momentProducts<8>);
BENCHMARK(momentProducts<16>);

/// Elimination of 1600 depths from a window of `keyframes`, `seen` of which, in a row, see each point.
void schurComplement(benchmark::State& state) {
  std::srand(1);
  constexpr int kPoints = 1600;
  const auto keyframes = static_cast<int>(state.range(0));
  const auto seen = static_cast<int>(state.range(1));
  LinearizedWindow system;
  system.setZero(8 * keyframes, kPoints);
  system.H.setIdentity();
  system.H_depth.setOnes();
  for (int p = 0; p < kPoints; ++p) {
    system.V.row(p).segment(8 * (p % (keyframes - seen + 1)), 8 * seen).setRandom();
  }
  SchurComplement schur;
  ReducedSystem reduced;
  for (auto _ : state) schur.reduce(system, 1e-4, reduced);
}
BENCHMARK(schurComplement)->Args({7, 7})->Args({12, 8})->Args({30, 12})->Args({30, 30})->Unit(benchmark::kMillisecond);

/// Points of a new keyframe, 752x480.
void selection(benchmark::State& state) {
  cv::Mat1f image(480, 752);
  cv::theRNG().state = 1;
  cv::randu(image, 0.0F, 255.0F);
  cv::Mat1f smooth;
  cv::blur(image, smooth, {9, 9});
  PinholeCamera camera;
  camera.width = smooth.cols;
  camera.height = smooth.rows;
  const ImagePyramid pyramid(smooth, camera, 4);
  for (auto _ : state) benchmark::DoNotOptimize(selectPoints(pyramid, 1500, {}));
}
BENCHMARK(selection)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mba_vo

BENCHMARK_MAIN();
