#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/online_log.h"

namespace mba_vo {

/// `count` of `of` things.
struct Share {
  std::size_t count = 0;
  std::size_t of = 0;
};

/// From arrival to publication of full poses [s]; NaN without any.
struct Latency {
  double median = 0.0;
  double percentile_95 = 0.0;
  double percentile_99 = 0.0;
};

/// How often, how soon and how steadily poses were published. In time: at most one frame interval after the image came
/// in. An orientation alone is not a pose. Images that repeat others are counted by status, and nowhere else.
struct Availability {
  double frame_interval = 0.0;  // median of the differences between image times [s]
  Share pose_in_time;           // of all images
  Share pose_in_time_moving;    // of those more than 0.3 s after the camera had parallax
  Share orientation_in_time;    // at least an orientation; of all images
  Share orientation_in_time_moving;
  std::optional<double> first_pose_after_start;     // from mid-exposure of the first image to publication [s]
  std::optional<double> first_pose_after_parallax;  // [s]; negative if sooner
  std::optional<double> longest_gap;                // without a pose in time, from the first pose to the last image [s]
  Share missed_after_first;                         // without a pose in time, of the images after the first pose
  Latency latency;
  std::map<std::string, std::size_t> images_by_status;  // by what was published first
};

/// `all` in the order of the images, at least one; `parallax_time` [s]: when the camera had moved enough for a map
/// to begin, nullopt if never.
Availability measureAvailability(const std::vector<OnlineFrame>& all, std::optional<double> parallax_time);

}  // namespace mba_vo
