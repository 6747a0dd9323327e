#include "path_statistics.h"

#include <algorithm>
#include <vector>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr int kGridStep = 32;  // between the paths that are looked at [px]

std::vector<Eigen::Vector2i> gridOf(const PinholeCamera& camera) {
  std::vector<Eigen::Vector2i> grid;
  for (int y = 0; y < camera.height - 1 + kGridStep; y += kGridStep) {
    for (int x = 0; x < camera.width - 1 + kGridStep; x += kGridStep) {
      grid.emplace_back(std::min(x, camera.width - 1), std::min(y, camera.height - 1));
    }
  }
  return grid;
}

}  // namespace

PathStatistics measurePaths(const DeblurInput& input, const cv::Mat1f& depth) {
  const PinholeCamera& camera = input.image->level(0).camera;
  ExposureTrajectory other = input.motion;
  other.velocity = input.other_velocity.value_or(input.motion.velocity);
  const FixedMotionPathMaker maker(camera, camera, input.motion, {input.motion.motion(), input.motion.motion()});
  const FixedMotionPathMaker other_maker(camera, camera, other, {other.motion(), other.motion()});
  PathStatistics result;
  std::vector<float> lengths;
  std::vector<float> differences;
  for (const Eigen::Vector2i& place : gridOf(camera)) {
    const Eigen::Vector2d pixel = place.cast<double>();
    const auto w = static_cast<double>(depth(place.y(), place.x()));
    PatchPath path;
    PatchPath other_path;
    if (!maker.makeWithoutPose(pixel, w, path, pixel.y())) continue;
    if (!other_maker.makeWithoutPose(pixel, w, other_path, pixel.y())) continue;
    lengths.push_back(path.length());
    differences.push_back((path.c1 - other_path.c1).norm());
    const Eigen::Vector2f half = 0.5F * path.c1;
    const Eigen::Vector2f bend = 0.25F * path.c2;
    result.reach = std::max({result.reach, (bend + half).norm(), (bend - half).norm()});
  }
  result.median = median(lengths);
  result.disagreement = median(differences);
  return result;
}

float medianBlur(const DeblurInput& input) {
  const cv::Mat1f depth = denseInverseDepth(input.image->level(0).camera, input.depths);
  return depth.empty() ? 0.0F : measurePaths(input, depth).median;
}

}  // namespace mba_vo
