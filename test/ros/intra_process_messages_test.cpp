#include "mba_vo/ros/intra_process_messages.h"

#include <gtest/gtest.h>

#include "mba_vo/ros/conversions.h"

namespace mba_vo::intra_process_messages_test {
namespace {

TrackedFrameMessage testMessage() {
  auto frame = std::make_shared<Frame>();
  frame->sequence = 17;
  frame->stamp_ns = 123'000'000'000;
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kDegraded;
  tracked->reason = "dark";
  tracked->reference = {3, 5, 7};
  TrackedFrameMessage message;
  message.message = {99, true, true, {"camera", SE3()}, tracked};
  message.summary = summarize(message.message);
  return message;
}

TEST(IntraProcessMessages, OutsideTheProcessOnlyTheSummaryArrives) {
  const TrackedFrameMessage sent = testMessage();
  const ros::SerializedMessage buffer = ros::serialization::serializeMessage(sent);
  TrackedFrameMessage received;
  ros::serialization::deserializeMessage(buffer, received);
  EXPECT_EQ(received.message.tracked, nullptr);
  EXPECT_EQ(received.summary.sequence, 17U);
  EXPECT_EQ(received.summary.session, 99U);
  EXPECT_EQ(received.summary.reason, "dark");
  EXPECT_EQ(received.summary.map_id, 3U);
  EXPECT_EQ(toNanoseconds(received.summary.header.stamp), 123'000'000'000);
  // Tools that know only the summary read the same bytes.
  TrackedFrameSummary summary;
  ros::serialization::deserializeMessage(buffer, summary);
  EXPECT_EQ(summary.keyframe_id, 5U);
}

TEST(IntraProcessMessages, TypeIsThatOfTheSummary) {
  EXPECT_STREQ(ros::message_traits::datatype<TrackedFrameMessage>(), "mba_vo/TrackedFrameSummary");
  EXPECT_STREQ(ros::message_traits::md5sum<ReferenceMessage>(), ros::message_traits::md5sum<ReferenceSummary>());
}

}  // namespace
}  // namespace mba_vo::intra_process_messages_test
