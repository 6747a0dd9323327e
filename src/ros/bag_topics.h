#pragma once

#include <rosbag/bag.h>

#include "mba_vo/ros/bag_reader.h"

namespace mba_vo {

/// `wanted` with the empty names filled in from what the bag holds. Throws std::runtime_error naming the file and the
/// topics there are to choose from.
BagTopics findBagTopics(const rosbag::Bag& bag, const std::string& file, const BagTopics& wanted);

}  // namespace mba_vo
