#include "mba_vo/initialization/initializer_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace mba_vo {
namespace {

constexpr double kLongestSpan = 0.2;  // [s] of three images that a track is interpolated by
constexpr int kRounds = 3;            // of tracks about a row time
constexpr int kIterations = 4;        // of a bundle that is nearly right
constexpr double kDifference = 0.05;  // of the longest row time, for derivatives

/// The reference's and all views' tracks, by time.
struct Sequence {
  struct Image {
    double time;  // [s]
    const std::vector<Eigen::Vector2d>* pixel;
    const std::vector<char>* tracked;  // null: all
    bool sees(std::size_t point) const { return !tracked || (*tracked)[point] != 0; }
  };
  std::vector<Image> images;
  std::size_t reference = 0;

  explicit Sequence(const StructureProblem& problem) {
    bool before = true;
    for (const StructureView& view : problem.views) {
      if (before && view.time > 0.0) addReference(problem);
      before = before && view.time <= 0.0;
      images.push_back({view.time, &view.pixel, &view.tracked});
    }
    if (before) addReference(problem);
  }

 private:
  void addReference(const StructureProblem& problem) {
    reference = images.size();
    images.push_back({0.0, &problem.reference_pixels, nullptr});
  }
};

/// Three images next to each other, of which `image` is one, that see the point; in the middle if possible.
std::optional<std::array<std::size_t, 3>> imagesAround(const Sequence& sequence, std::size_t image, std::size_t point) {
  for (const std::size_t first : {image - 1, image, image - 2}) {
    if (first >= sequence.images.size() || first + 2 >= sequence.images.size()) continue;
    const auto& images = sequence.images;
    if (images[first + 2].time - images[first].time > kLongestSpan) continue;
    if (!images[first].sees(point) || !images[first + 1].sees(point) || !images[first + 2].sees(point)) continue;
    return std::array<std::size_t, 3>{first, first + 1, first + 2};
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> atMidExposure(const Sequence& sequence, const PinholeCamera& camera, std::size_t image,
                                             std::size_t point) {
  const auto around = imagesAround(sequence, image, point);
  if (!around) return std::nullopt;
  std::array<double, 3> t;  // [s] since mid-exposure of the image
  std::array<Eigen::Vector2d, 3> x;
  for (std::size_t i = 0; i < 3; ++i) {
    const Sequence::Image& seen = sequence.images[(*around)[i]];
    x[i] = (*seen.pixel)[point];
    t[i] = seen.time + camera.rowDelay(x[i].y()) - sequence.images[image].time;
  }
  Eigen::Vector2d result = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    result += t[j] * t[k] / ((t[i] - t[j]) * (t[i] - t[k])) * x[i];
  }
  return result;
}

/// Gives the bundle the tracks at a row time.
void setTracks(const StructureProblem& problem, const std::vector<std::size_t>& views, double row_time,
               Bundle& bundle) {
  const StructureProblem tracks = withGlobalShutter(problem, row_time);
  for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
    bundle.rays[p] = bundle.camera.unproject(tracks.reference_pixels[p]);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    bundle.views[v].pixel = tracks.views[views[v]].pixel;
    bundle.views[v].observed = tracks.views[views[v]].tracked;
  }
  bundle.row_time = row_time;
}

/// And the derivatives of the tracks there, by that much more.
void setDerivatives(const StructureProblem& problem, const std::vector<std::size_t>& views, double more,
                    Bundle& bundle) {
  const StructureProblem tracks = withGlobalShutter(problem, bundle.row_time + more);
  bundle.ray_by_row_time.resize(bundle.rays.size());
  for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
    bundle.ray_by_row_time[p] = (bundle.camera.unproject(tracks.reference_pixels[p]) - bundle.rays[p]) / more;
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    BundleView& view = bundle.views[v];
    view.pixel_by_row_time.resize(bundle.rays.size());
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      view.pixel_by_row_time[p] = (tracks.views[views[v]].pixel[p] - view.pixel[p]) / more;
    }
  }
}

}  // namespace

StructureProblem withGlobalShutter(const StructureProblem& problem, double row_time) {
  StructureProblem result = problem;
  PinholeCamera camera = problem.camera;
  camera.row_time = row_time;
  result.camera.row_time = 0.0;
  const Sequence sequence(problem);
  for (std::size_t p = 0; p < problem.reference_pixels.size(); ++p) {
    const auto reference = atMidExposure(sequence, camera, sequence.reference, p);
    if (reference) result.reference_pixels[p] = *reference;
    for (std::size_t v = 0; v < problem.views.size(); ++v) {
      const std::size_t image = v < sequence.reference ? v : v + 1;
      if (!problem.views[v].tracked[p]) continue;
      const auto pixel = reference ? atMidExposure(sequence, camera, image, p) : std::nullopt;
      result.views[v].tracked[p] = pixel ? 1 : 0;
      if (pixel) result.views[v].pixel[p] = *pixel;
    }
  }
  return result;
}

RowTimeFit fitRowTime(const StructureProblem& problem, const std::vector<std::size_t>& views, const Bundle& bundle) {
  BundleOptions options;
  options.max_iterations = kIterations;
  Bundle global = bundle;
  setTracks(problem, views, 0.0, global);
  const double global_cost = optimizeBundle(global, options).final_cost;

  // A shutter takes no longer than there is time between images.
  double shortest = kLongestSpan;
  for (std::size_t v = 1; v < problem.views.size(); ++v) {
    shortest = std::min(shortest, problem.views[v].time - problem.views[v - 1].time);
  }
  const double longest = shortest / problem.camera.height;
  Bundle rolling = std::move(global);
  RowTimeFit fit;
  const auto refine = [&] {
    setTracks(problem, views, fit.row_time, rolling);
    setDerivatives(problem, views, kDifference * longest, rolling);
    const double cost = optimizeBundle(rolling, options).final_cost;
    fit.row_time = std::clamp(rolling.row_time, -longest, longest);
    return cost;
  };
  double cost = global_cost;
  for (int round = 0; round < kRounds; ++round) cost = refine();
  fit.cost_ratio = cost / std::max(global_cost, 1e-12);
  // With a global shutter errors were large, and what is wrong still weighs as if they were: a row time 4 % too short.
  estimateSigmas(rolling);
  refine();
  return fit;
}

}  // namespace mba_vo
