#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo::test {

/// All that can be seen of a result, to be compared to the last bit.
struct Outcome {
  std::string text;  // status, reason, flags
  Vector6 pose = Vector6::Zero();
  Vector6 velocity = Vector6::Zero();
  SE3 T_odom_camera;
};

inline Outcome outcomeOf(const TrackedFrame& tracked, const SE3& T_odom_camera = SE3()) {
  Outcome outcome;
  outcome.text = std::to_string(tracked.frame->sequence) + " " + toString(tracked.status) + " " + tracked.reason +
                 (tracked.orientation_only ? " orientation" : "") + (tracked.keyframe_requested ? " keyframe" : "") +
                 (tracked.provisional ? " provisional" : "");
  outcome.pose = tracked.trajectory.T_reference_mid.log();
  outcome.velocity = tracked.trajectory.velocity;
  outcome.T_odom_camera = T_odom_camera;
  return outcome;
}

inline void expectSame(const std::vector<Outcome>& outcomes, const std::vector<Outcome>& of_a_fresh_one) {
  ASSERT_EQ(outcomes.size(), of_a_fresh_one.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& expected = of_a_fresh_one[i];
    EXPECT_EQ(outcomes[i].text, expected.text);
    EXPECT_EQ(outcomes[i].pose, expected.pose) << expected.text;
    EXPECT_EQ(outcomes[i].velocity, expected.velocity) << expected.text;
    EXPECT_EQ(outcomes[i].T_odom_camera.log(), expected.T_odom_camera.log()) << expected.text;
  }
}

}  // namespace mba_vo::test
