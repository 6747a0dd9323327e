#include "mba_vo/ros/depth_lookup.h"

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include "mba_vo/image/depth_image.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kRestartNs = 1'000'000'000;  // stamps that go back so far are those of another recording

}  // namespace

DepthLookup::DepthLookup(double tolerance) : tolerance_ns_(std::llround(1e9 * tolerance)) {}

void DepthLookup::add(const sensor_msgs::ImageConstPtr& depth) {
  const std::int64_t stamp_ns = toNanoseconds(depth->header.stamp);
  if (!depths_.empty() && stamp_ns < depths_.rbegin()->first - kRestartNs) depths_.clear();
  depths_[stamp_ns] = depth;
  if (depths_.size() > kMaxEntries) depths_.erase(depths_.begin());
}

sensor_msgs::ImageConstPtr DepthLookup::find(std::int64_t stamp_ns) const {
  sensor_msgs::ImageConstPtr best;
  std::int64_t least = tolerance_ns_;
  for (auto it = depths_.lower_bound(stamp_ns - tolerance_ns_); it != depths_.end(); ++it) {
    const std::int64_t difference = std::llabs(it->first - stamp_ns);
    if (difference <= least) {
      least = difference;
      best = it->second;
    }
  }
  return best;
}

cv::Mat1f depthFromMessage(const sensor_msgs::ImageConstPtr& message) {
  namespace enc = sensor_msgs::image_encodings;
  const std::string& encoding = message->encoding;
  if (encoding != enc::TYPE_32FC1 && encoding != enc::TYPE_16UC1 && encoding != enc::MONO16) {
    throw std::invalid_argument("depth image encoding is '" + encoding +
                                "'; allowed: 32FC1 (metres), 16UC1 (millimetres)");
  }
  try {
    return depthInMetres(cv_bridge::toCvShare(message)->image, kMillimetres);
  } catch (const cv::Exception& error) {
    throw std::invalid_argument(std::string("depth image cannot be read: ") + error.what());
  } catch (const cv_bridge::Exception& error) {
    throw std::invalid_argument(std::string("depth image cannot be read: ") + error.what());
  }
}

}  // namespace mba_vo
