// Maps are saved by one node and used by the next.
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <mba_vo/MapFile.h>

#include "robot.h"

namespace mba_vo::saved_map_test {
namespace {

constexpr std::size_t kUntilMap = 25;  // images that are enough for a map, and some more

MapFileResponse askForMap(const std::string& service, const std::string& file) {
  MapFile call;
  call.request.file = file;
  if (!ros::service::call(service, call)) ADD_FAILURE() << "no answer from " << service;
  return call.response;
}

TEST(Lifecycle, AMapIsSavedAndUsedAgain) {
  const std::string file = (std::filesystem::temp_directory_path() / "mba_vo_lifecycle.map").string();
  {
    Robot robot("explorer");
    EXPECT_FALSE(askForMap("/explorer/save_map", file).success) << "there is no map yet";
    robot.see(0, kUntilMap);
    ASSERT_TRUE(robot.isDone(kUntilMap));
    ASSERT_TRUE(robot.becomesTracking());
    const MapFileResponse saved = askForMap("/explorer/save_map", file);
    ASSERT_TRUE(saved.success) << saved.message;
    EXPECT_NE(saved.message.find(file), std::string::npos) << saved.message;
    const MapFileResponse missing = askForMap("/explorer/load_map", "no.map");
    EXPECT_FALSE(missing.success);
    EXPECT_NE(missing.message.find(robot.file("no.map")), std::string::npos) << missing.message;
    robot.see(kUntilMap, kUntilMap + 2);
    ASSERT_TRUE(robot.isDone(kUntilMap + 2));
    EXPECT_TRUE(robot.becomesTracking()) << "a map that cannot be read leaves the present one alone";
    // In the same node: the camera is lost to its map and finds itself in the loaded one.
    const MapFileResponse loaded = askForMap("/explorer/load_map", file);
    ASSERT_TRUE(loaded.success) << loaded.message;
    robot.see(kUntilMap + 2, kUntilMap + 14);
    EXPECT_TRUE(robot.becomesTracking());
    const auto tells = [](const Outputs& o) {
      return std::any_of(o.mapper_status.begin(), o.mapper_status.end(), [](const auto& status) {
        return status->message.find("found in the map that was loaded") != std::string::npos;
      });
    };
    EXPECT_TRUE(robot.odometry->waitFor(tells, kTimeout));
  }
  ros::param::set("/returner/map_file", file);
  Robot robot("returner");
  robot.see(kUntilMap - 12, kUntilMap);  // far too few for a new map
  ASSERT_TRUE(robot.isDone(12));
  EXPECT_TRUE(robot.becomesTracking());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace mba_vo::saved_map_test
