// Times of what loop closing costs with 10,000 keyframes, one thread.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "mba_vo/pose_graph/pose_graph.h"
#include "mba_vo/relocalization/place_index.h"

namespace mba_vo {
namespace {

PlaceDescriptor randomView(cv::RNG& random) {
  cv::Mat1f coarse(8, 12), image;
  random.fill(coarse, cv::RNG::UNIFORM, 20.0, 220.0);
  cv::resize(coarse, image, {376, 240}, 0.0, 0.0, cv::INTER_CUBIC);
  PinholeCamera camera;
  camera.width = image.cols;
  camera.height = image.rows;
  return PlaceDescriptor(ImagePyramid(image, camera, 5));
}

void placeSearch(benchmark::State& state) {
  cv::RNG random(1);
  PlaceIndex index;
  for (KeyframeId id = 0; id < static_cast<KeyframeId>(state.range(0)); ++id) index.add(id, randomView(random));
  const PlaceDescriptor view = randomView(random);
  const auto all = [](KeyframeId) { return true; };
  for (auto _ : state) benchmark::DoNotOptimize(index.search(view, 2, all));
}
BENCHMARK(placeSearch)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

/// Round a room, a loop for every fifth keyframe.
void graphStep(benchmark::State& state) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 0.002);
  constexpr int kRound = 200;  // keyframes
  const int count = static_cast<int>(state.range(0));
  std::vector<Sim3> nodes(1);
  std::vector<GraphEdge> edges;
  const auto noise = [&] {
    Vector7 v;
    for (int i = 0; i < 7; ++i) v(i) = normal(random);
    return Sim3::fromIncrement(v);
  };
  Vector7 step;
  step << 0.1, 0.0, 0.0, 0.0, 2.0 * M_PI / kRound, 0.0, 0.0;
  for (int n = 1; n < count; ++n) {
    edges.push_back({n - 1, n, Sim3::fromIncrement(step) * noise(), 1e5 * Matrix7::Identity(), false});
    nodes.push_back(nodes.back() * edges.back().S_from_to);
    if (n % 5 == 0 && n > kRound) edges.push_back({n - kRound, n, noise(), 1e5 * Matrix7::Identity(), true});
  }
  PoseGraph graph(nodes, edges);
  graph.iterate();  // the structure is analysed here
  for (auto _ : state) benchmark::DoNotOptimize(graph.iterate());
}
BENCHMARK(graphStep)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mba_vo

BENCHMARK_MAIN();
