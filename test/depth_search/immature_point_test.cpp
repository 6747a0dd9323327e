#include "mba_vo/depth_search/immature_point.h"

#include <gtest/gtest.h>

namespace mba_vo::immature_point_test {
namespace {

ImmaturePoint certainPoint() {
  ImmaturePoint point;
  point.state = ImmaturePoint::State::kGood;
  point.inverse_depth_min = 0.4;
  point.inverse_depth_max = 0.5;
  point.quality = 5.0;
  point.last_search_length_px = 2.0;
  return point;
}

TEST(IsReadyToActivate, DemandsASearchedUnambiguousDepth) {
  using State = ImmaturePoint::State;
  EXPECT_TRUE(isReadyToActivate(certainPoint()));
  for (const State state : {State::kSkipped, State::kBadCondition, State::kOutOfBounds}) {
    ImmaturePoint point = certainPoint();
    point.state = state;  // of the last search; the interval of earlier ones stands
    EXPECT_TRUE(isReadyToActivate(point));
  }
  for (const State state : {State::kUninitialized, State::kOutlier}) {
    ImmaturePoint point = certainPoint();
    point.state = state;
    EXPECT_FALSE(isReadyToActivate(point));
  }
  ImmaturePoint ambiguous = certainPoint();
  ambiguous.quality = 2.0;
  EXPECT_FALSE(isReadyToActivate(ambiguous));
  ImmaturePoint vague = certainPoint();
  vague.last_search_length_px = 20.0;
  EXPECT_FALSE(isReadyToActivate(vague));
  ImmaturePoint unbounded = certainPoint();
  unbounded.inverse_depth_max = -1.0;
  EXPECT_FALSE(isReadyToActivate(unbounded));
  EXPECT_FALSE(isReadyToActivate(ImmaturePoint()));
}

}  // namespace
}  // namespace mba_vo::immature_point_test
