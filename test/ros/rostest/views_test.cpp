// What is made only when somebody looks: pictures, markers and sharp keyframes; and the diagnostics.
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <visualization_msgs/MarkerArray.h>

#include "robot.h"

namespace mba_vo::views_test {
namespace {

constexpr std::size_t kImages = 35;  // a map, and some keyframes

template <typename Message>
class Listener {
 public:
  using List = std::vector<boost::shared_ptr<const Message>>;

  explicit Listener(const std::string& topic) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> callback = [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      messages_.push_back(message);
    };
    subscriber_ = nh_.subscribe<Message>(topic, 1000, callback);
  }
  List messages() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  bool waitFor(const std::function<bool(const List&)>& condition) const {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (ros::WallTime::now() < deadline) {
      if (condition(messages())) return true;
      ros::WallDuration(0.05).sleep();
    }
    return false;
  }

 private:
  ros::NodeHandle nh_;
  mutable std::mutex mutex_;
  List messages_;
  ros::Subscriber subscriber_;
};

bool hasColour(const sensor_msgs::Image& image) {
  for (std::size_t i = 0; i + 2 < image.data.size(); i += 3) {
    if (image.data[i] != image.data[i + 2]) return true;
  }
  return false;
}

TEST(Views, PictureMarkersAndDiagnosticsAreThereWhenSomebodyLooks) {
  const Listener<sensor_msgs::Image> pictures("/looked_at/tracking/image");
  const Listener<visualization_msgs::MarkerArray> markers("/looked_at/markers");
  const Listener<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  Robot robot("looked_at");
  robot.see(0, kImages);
  ASSERT_TRUE(robot.isDone(kImages));
  ASSERT_TRUE(robot.becomesTracking());

  ASSERT_TRUE(pictures.waitFor([](const auto& list) { return !list.empty(); }));
  const sensor_msgs::Image picture = *pictures.messages().back();
  EXPECT_EQ(picture.encoding, "bgr8");
  EXPECT_EQ(picture.width, 376U);
  EXPECT_EQ(picture.header.frame_id, "camera_optical");
  EXPECT_TRUE(hasColour(picture)) << "points are drawn by depth, on a grey image";

  ASSERT_TRUE(markers.waitFor([](const auto& list) { return !list.empty(); }));
  std::set<std::string> namespaces;
  for (const visualization_msgs::Marker& marker : markers.messages().back()->markers) {
    EXPECT_EQ(marker.header.frame_id, "looked_at_map");
    namespaces.insert(marker.ns);
  }
  EXPECT_EQ(namespaces, (std::set<std::string>{"exposure", "keyframes"}));

  const auto allAreTold = [](const Listener<diagnostic_msgs::DiagnosticArray>::List& list) {
    std::set<std::string> told;
    for (const auto& message : list) {
      for (const diagnostic_msgs::DiagnosticStatus& status : message->status) {
        if (!status.values.empty()) told.insert(status.name.substr(status.name.rfind(' ') + 1));
      }
    }
    return told == std::set<std::string>{"input", "mapping", "tracking"};
  };
  EXPECT_TRUE(diagnostics.waitFor(allAreTold));
}

TEST(Views, KeyframesAreSharpenedForThoseWhoListenThoughTheMapTakesNone) {
  ros::NodeHandle deblur("/listened_to/mapper/deblur");
  deblur.setParam("method", "none");
  deblur.setParam("trajectory/min_blur_px", 0.2);  // all that can be sharpened
  deblur.setParam("trajectory/max_residual", 100.0);
  deblur.setParam("trajectory/max_disagreement", 10.0);
  ros::param::set("/listened_to/mapper/deblur_queue/per_second", 1000.0);
  const Listener<sensor_msgs::Image> originals("/listened_to/keyframe/original");
  const Listener<sensor_msgs::Image> sharps("/listened_to/keyframe/sharp");
  Robot robot("listened_to");
  robot.see(0, kImages);
  ASSERT_TRUE(robot.isDone(kImages));

  const auto isThere = [](const auto& list) { return !list.empty(); };
  ASSERT_TRUE(sharps.waitFor(isThere));
  ASSERT_TRUE(originals.waitFor(isThere));
  const sensor_msgs::Image sharp = *sharps.messages().front();
  const sensor_msgs::Image original = *originals.messages().front();
  EXPECT_EQ(sharp.header.stamp, original.header.stamp);
  EXPECT_EQ(sharp.data.size(), original.data.size());
  EXPECT_NE(sharp.data, original.data);
  ASSERT_TRUE(robot.odometry->waitFor(  // told once a second
      [](const Outputs& o) { return o.mapper_status.back()->deblur_sharpened > 0; }, kTimeout));
  EXPECT_EQ(robot.odometry->outputs().mapper_status.back()->deblur_in_map, 0U);
}

}  // namespace
}  // namespace mba_vo::views_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "views_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
