#include "mba_vo/mapping/point_activator.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mba_vo {
namespace {

constexpr double kUnrefinedVariance = 1.0;  // of an inverse depth not refined yet: as good as unknown [1/m^2]
constexpr double kStarving = 0.35;          // share of the points wanted
constexpr double kHostBorder = 2.0;         // [px]

void eraseMarked(std::vector<ImmaturePoint>& points, const std::vector<bool>& marked) {
  auto mark = marked.begin();
  points.erase(std::remove_if(points.begin(), points.end(), [&](const ImmaturePoint&) { return *mark++; }),
               points.end());
}

NewPoint newPoint(KeyframeId host, const ImmaturePoint& point, DepthGuess depth, const SurfaceSlopes& slopes) {
  const Eigen::Vector2d pixel = point.pixel.cast<double>();
  const auto& [inverse_depth, sigma] = depth;
  return {host, pixel, inverse_depth, sigma, slopes.at(pixel, inverse_depth, kUnrefinedVariance), point.measured};
}

}  // namespace

PointActivator::PointActivator(Window& window, KeyframeId newest, double distance_px)
    : window_(window),
      known_(window.points()),
      camera_(window.camera(newest)),
      T_newest_map_(window.T_map_keyframe(newest).inverse()),
      grid_(camera_, distance_px),
      keyframes_(static_cast<int>(window.keyframes().size())) {
  for (const ReferencePoint& point : pointsSeenBy(window, known_, newest)) {
    grid_.occupy(point.pixel.cast<double>());
    ++visible_;
  }
}

void PointActivator::activateFound(KeyframeId host, std::vector<ImmaturePoint>& immature) {
  std::optional<SurfaceSlopes> slopes;  // few hosts need any
  const PinholeCamera host_camera = window_.camera(host);
  const SE3 T_newest_host = T_newest_map_ * window_.T_map_keyframe(host);
  std::vector<bool> gone(immature.size());
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < immature.size(); ++i) {
    const ImmaturePoint& point = immature[i];
    gone[i] = point.state == ImmaturePoint::State::kOutlier;
    if (gone[i] || !isReadyToActivate(point)) continue;
    const auto seen = see(host_camera, T_newest_host, point, point.inverseDepth());
    gone[i] = !seen;
    if (!seen || !grid_.isFree(*seen)) continue;
    if (!slopes) slopes.emplace(host_camera, pointsSeenBy(window_, known_, host));
    candidates.push_back({i, newPoint(host, point, {point.inverseDepth(), point.uncertainty()}, *slopes), *seen});
  }
  const std::vector<Outcome> outcomes = activate(candidates);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (outcomes[c] != Outcome::kNotTried) gone[candidates[c].immature] = true;
  }
  eraseMarked(immature, gone);
}

bool PointActivator::isStarving(int wanted_points) const { return visible_ < kStarving * wanted_points; }

void PointActivator::activateGuessed(KeyframeId host, std::vector<ImmaturePoint>& immature) {
  const std::vector<ReferencePoint> known = pointsSeenBy(window_, known_, host);
  const NearbyDepths depths(known);
  if (!depths.known()) return;
  const PinholeCamera host_camera = window_.camera(host);
  const SurfaceSlopes slopes(host_camera, known);
  const SE3 T_newest_host = T_newest_map_ * window_.T_map_keyframe(host);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < immature.size() && guesses_ < kMostGuesses; ++i) {
    const DepthGuess guess = depths.at(immature[i].pixel.cast<double>());
    const auto seen = see(host_camera, T_newest_host, immature[i], guess.inverse_depth);
    if (!seen || !grid_.isFree(*seen)) continue;
    candidates.push_back({i, newPoint(host, immature[i], guess, slopes), *seen});
    ++guesses_;
  }
  const std::vector<Outcome> outcomes = activate(candidates);
  std::vector<bool> activated(immature.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    activated[candidates[c].immature] = outcomes[c] == Outcome::kActivated;
  }
  eraseMarked(immature, activated);
}

std::optional<Eigen::Vector2d> PointActivator::see(const PinholeCamera& host_camera, const SE3& T_newest_host,
                                                   const ImmaturePoint& point, double inverse_depth) const {
  const Eigen::Vector3d in_newest = T_newest_host * (host_camera.unproject(point.pixel.cast<double>()) / inverse_depth);
  if (in_newest.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d pixel = camera_.project(in_newest);
  return camera_.contains(pixel, kHostBorder) ? std::optional<Eigen::Vector2d>(pixel) : std::nullopt;
}

std::vector<PointActivator::Outcome> PointActivator::activate(const std::vector<Candidate>& candidates) {
  std::vector<Outcome> outcomes(candidates.size(), Outcome::kNotTried);
  std::vector<std::size_t> waiting(candidates.size());
  std::iota(waiting.begin(), waiting.end(), std::size_t{0});
  for (auto round = nextRound(candidates, waiting); !round.empty(); round = nextRound(candidates, waiting)) {
    std::vector<NewPoint> points;
    for (const std::size_t c : round) points.push_back(candidates[c].point);
    const std::vector<bool> added = window_.activatePoints(points);
    for (std::size_t i = 0; i < round.size(); ++i) {
      outcomes[round[i]] = added[i] ? Outcome::kActivated : Outcome::kRefused;
      if (!added[i]) continue;
      grid_.occupy(candidates[round[i]].in_newest);
      ++visible_;
    }
    residuals_ += static_cast<int>(round.size()) * (keyframes_ - 1);
  }
  return outcomes;
}

std::vector<std::size_t> PointActivator::nextRound(const std::vector<Candidate>& candidates,
                                                   std::vector<std::size_t>& waiting) const {
  SpacingGrid taken = grid_;
  std::vector<std::size_t> now;
  std::vector<std::size_t> later;
  for (const std::size_t c : waiting) {
    const Eigen::Vector2d& pixel = candidates[c].in_newest;
    if (!grid_.isFree(pixel)) continue;
    (taken.isFree(pixel) ? now : later).push_back(c);
    taken.occupy(pixel);
  }
  waiting = std::move(later);
  return now;
}

}  // namespace mba_vo
