#pragma once

#include <optional>
#include <vector>

#include "mba_vo/depth_search/immature_point.h"
#include "mba_vo/depth_search/nearby_depths.h"
#include "mba_vo/depth_search/surface_slope.h"
#include "mba_vo/image/spacing_grid.h"
#include "mba_vo/window/point_activation.h"

namespace mba_vo {

/// Activates immature points that the window's newest keyframe sees, where it has no points yet. A try changes nothing
/// but its own point: the first ones of all free cells are tried side by side, then the next ones of those still free.
class PointActivator {
 public:
  /// Guesses that are tried, of all hosts together: most are refused, the more the longer a turn lasts, and the next
  /// keyframe is needed soon (docs/decisions/2026-11-26-samples-along-a-path.md).
  static constexpr int kMostGuesses = 1200;

  /// The window must outlive the activator. `distance_px`: between points.
  PointActivator(Window& window, KeyframeId newest, double distance_px);

  /// Those of the host whose depths have been found. Takes those away that were activated or never will be.
  void activateFound(KeyframeId host, std::vector<ImmaturePoint>& immature);

  /// True if so few points are seen that any more are welcome: on fast turns new ones are gone before they are found.
  bool isStarving(int wanted_points) const;
  /// And so many that it needs no more.
  bool isFull(int wanted_points) const { return visible_ >= wanted_points; }
  /// Those of the host whose depths have not been found, beginning with the depths of points around: the keyframes
  /// together tell more than the search in single frames. Tries kMostGuesses at most, takes away what was activated.
  void activateGuessed(KeyframeId host, std::vector<ImmaturePoint>& immature);

  /// That were compared, of the points that were tried.
  int residuals() const { return residuals_; }

 private:
  enum class Outcome { kNotTried, kRefused, kActivated };
  struct Candidate {
    std::size_t immature;  // its number
    NewPoint point;
    Eigen::Vector2d in_newest;  // where the newest keyframe sees it [px]
  };

  /// Where the newest keyframe sees the point; nullopt if it does not.
  std::optional<Eigen::Vector2d> see(const PinholeCamera& host_camera, const SE3& T_newest_host,
                                     const ImmaturePoint& point, double inverse_depth) const;
  std::vector<Outcome> activate(const std::vector<Candidate>& candidates);
  /// Those that are tried now, of the candidates `waiting`; leaves in it those for later.
  std::vector<std::size_t> nextRound(const std::vector<Candidate>& candidates, std::vector<std::size_t>& waiting) const;

  Window& window_;
  std::vector<WindowPoint> known_;  // before any is activated
  PinholeCamera camera_;            // of the newest keyframe
  SE3 T_newest_map_;
  SpacingGrid grid_;  // of the newest keyframe
  int visible_ = 0;   // points in it
  int keyframes_;     // in the window
  int residuals_ = 0;
  int guesses_ = 0;
};

}  // namespace mba_vo
