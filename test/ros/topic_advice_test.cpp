#include "mba_vo/ros/topic_advice.h"

#include <gtest/gtest.h>

namespace mba_vo::topic_advice_test {
namespace {

const std::string kImage = "sensor_msgs/Image";
const std::string kCompressed = "sensor_msgs/CompressedImage";

TEST(TopicAdvice, NothingIsSaidOfATopicThatIsPublishedAsItShould) {
  EXPECT_EQ(whyNothingComes("/camera/image", kImage, {{"/camera/image", kImage}}), "");
}

TEST(TopicAdvice, AnotherTypeIsNamed) {
  EXPECT_EQ(whyNothingComes("/chatter", kImage, {{"/chatter", "std_msgs/String"}}),
            "it is published as std_msgs/String, sensor_msgs/Image is needed");
}

TEST(TopicAdvice, ExposuresOfAnotherTypeAreForTheRelay) {
  EXPECT_EQ(whyNothingComes("/metadata", kExposureType, {{"/metadata", "realsense2_camera/Metadata"}}),
            "it is published as realsense2_camera/Metadata, mba_vo/ExposureStamped is needed: exposure_relay makes it");
}

TEST(TopicAdvice, TheOtherTransportIsRecommended) {
  EXPECT_NE(whyNothingComes("/camera/image/compressed", kImage, {{"/camera/image/compressed", kCompressed}})
                .find("image:=/camera/image image_transport:=compressed"),
            std::string::npos);
  EXPECT_NE(whyNothingComes("/camera/image", kImage, {{"/camera/image/compressed", kCompressed}})
                .find("only /camera/image/compressed is published: tell image_transport:=compressed"),
            std::string::npos);
  EXPECT_NE(whyNothingComes("/camera/image/compressed", kCompressed, {{"/camera/image", kImage}})
                .find("only /camera/image is published: tell image_transport:=raw"),
            std::string::npos);
}

TEST(TopicAdvice, TopicsThatThereAreAreListed) {
  EXPECT_EQ(whyNothingComes("/image", kImage, {{"/b/image", kImage}, {"/a/image", kImage}, {"/x", "std_msgs/String"}}),
            "nobody publishes it; topics of type sensor_msgs/Image: /a/image, /b/image");
  EXPECT_NE(whyNothingComes("/image", kImage, {}).find("none"), std::string::npos);
}

}  // namespace
}  // namespace mba_vo::topic_advice_test
