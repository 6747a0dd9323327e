#include "mba_vo/ros/bag_errors.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace mba_vo {
namespace {

/// rosbag reads past the end ("wanted 4 bytes, read 0 bytes"), or finds no index, which is written last.
bool isCutOff(const std::string& file, const rosbag::BagException& error) {
  std::error_code unreadable;
  if (std::filesystem::file_size(file, unreadable) == 0 || unreadable) return false;
  return dynamic_cast<const rosbag::BagUnindexedException*>(&error) != nullptr ||
         std::string(error.what()).find("Error reading from file") != std::string::npos;
}

}  // namespace

std::runtime_error cannotRead(const std::string& file, const rosbag::BagException& error) {
  const std::string text = "bag '" + file + "' cannot be read: " + error.what();
  return std::runtime_error(isCutOff(file, error)
                                ? text + "; it seems to be cut off: 'rosbag reindex " + file + "' saves what is in it"
                                : text);
}

std::runtime_error cannotWrite(const std::string& file, const rosbag::BagException& error) {
  const int reason = errno;
  const std::string text = "bag '" + file + "' cannot be written: " + error.what();
  return std::runtime_error(reason == 0 ? text : text + ": " + std::generic_category().message(reason));
}

}  // namespace mba_vo
