#include "mba_vo/odometry/tracking_state.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::tracking_state_test {
namespace {

constexpr double kExposure = 0.01;  // [s]

SE3 someWhere() { return SE3::exp((Vector6() << 0.4, -0.2, 0.1, 0.3, 0.5, -0.2).finished()); }

/// However long ago the last frame was, a prediction is made for so long only.
TEST(TrackingState, BeginsWhereTheCameraHasTurnedTo) {
  for (const double seconds : {0.04, 1.0}) {
    ExposureTrajectory last{someWhere(), Vector6::Zero(), kExposure};
    last.velocity << 0.3, 0.1, -0.2, 0.1, 0.0, 0.2;
    const TrackingState state(MotionState(last, 0));
    const auto frame = test::makeFrame(cv::Mat1f(240, 376, 90.0F), std::llround(1e9 * seconds), kExposure);
    CameraTurn turn;
    turn.R_from_to = Eigen::AngleAxisd(0.6, Eigen::Vector3d(0.2, 0.9, -0.1).normalized());
    turn.angular_velocity = {0.5, -2.0, 0.3};
    const TrackingGuess guess = state.guessFor(*frame, kExposure, turn);
    const SE3 T_reference_now = guess.trajectory.T_reference_mid;
    EXPECT_LT(T_reference_now.rotation().angularDistance(someWhere().rotation() * turn.R_from_to), 1e-9) << seconds;
    const Eigen::Vector3d velocity = someWhere().rotation() * Eigen::Vector3d(last.velocity.head<3>());
    const Eigen::Vector3d place = someWhere().translation() + std::min(seconds, kLongestPrediction) * velocity;
    EXPECT_LT((T_reference_now.translation() - place).norm(), 1e-9) << seconds;
    EXPECT_LT((guess.trajectory.velocity.tail<3>() - turn.angular_velocity).norm(), 1e-12);
    EXPECT_LT((T_reference_now.rotation() * Eigen::Vector3d(guess.trajectory.velocity.head<3>()) - velocity).norm(),
              1e-9);
  }
}

}  // namespace
}  // namespace mba_vo::tracking_state_test
