#pragma once

#include <cstdint>
#include <map>

#include <sensor_msgs/Image.h>
#include <opencv2/core.hpp>

namespace mba_vo {

/// The latest depth images by stamp, which follows the same convention as that of the images.
class DepthLookup {
 public:
  static constexpr std::size_t kMaxEntries = 32;

  explicit DepthLookup(double tolerance);  // [s] between the stamps of depth image and image

  void add(const sensor_msgs::ImageConstPtr& depth);
  /// The depth image nearest in time within the tolerance, null if there is none.
  sensor_msgs::ImageConstPtr find(std::int64_t stamp_ns) const;
  /// False while a nearer one may still come.
  bool isSettled(std::int64_t stamp_ns) const { return !depths_.empty() && depths_.rbegin()->first >= stamp_ns; }
  std::size_t size() const { return depths_.size(); }

 private:
  std::int64_t tolerance_ns_;
  std::map<std::int64_t, sensor_msgs::ImageConstPtr> depths_;
};

/// Depths [m], NaN = unknown, of a depth image as in REP-118: 32FC1 in metres, or 16UC1 in millimetres. Throws
/// std::invalid_argument naming the encoding if it is none.
cv::Mat1f depthFromMessage(const sensor_msgs::ImageConstPtr& message);

}  // namespace mba_vo
