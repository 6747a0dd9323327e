#pragma once

#include <stdexcept>
#include <string>

#include <rosbag/exceptions.h>

namespace mba_vo {

/// That the bag cannot be read, and why. Of one that is cut off, by a recorder that was killed or a copy that did not
/// end, what can be done about it.
std::runtime_error cannotRead(const std::string& file, const rosbag::BagException& error);

/// That the bag cannot be written, and why: "No space left on device", if errno says so. To be set to 0 before.
std::runtime_error cannotWrite(const std::string& file, const rosbag::BagException& error);

}  // namespace mba_vo
