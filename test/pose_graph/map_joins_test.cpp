#include "mba_vo/pose_graph/map_joins.h"

#include <gtest/gtest.h>

namespace mba_vo::map_joins_test {
namespace {

LoopTrial join(MapId older, MapId newer, const std::string& rejected_because = {}) {
  LoopTrial trial;
  trial.older_map = older;
  trial.newer_map = newer;
  trial.verdict.rejected_because = rejected_because;
  return trial;
}

using Maps = std::set<MapId>;

TEST(MapJoins, MapsHangTogetherThroughOthers) {
  const MapJoins joins({join(1, 3), join(3, 4), join(2, 5), join(5, 6, "too few pixels agree"), join(7, 7)});
  EXPECT_EQ(joins.joinedWith(1), Maps({1, 3, 4}));
  EXPECT_EQ(joins.joinedWith(4), Maps({1, 3, 4}));
  EXPECT_EQ(joins.joinedWith(5), Maps({2, 5}));
  EXPECT_EQ(joins.joinedWith(6), Maps({6}));
  EXPECT_EQ(joins.joinedWith(7), Maps({7}));
}

TEST(MapJoins, TwoMapsAreSettledByThreeJoinsOrThroughOthers) {
  EXPECT_FALSE(MapJoins({}).areSettled(1, 2));
  EXPECT_FALSE(MapJoins({join(1, 2), join(1, 2)}).areSettled(1, 2)) << "it is worth looking for more";
  EXPECT_TRUE(MapJoins({join(1, 2), join(1, 2), join(1, 2)}).areSettled(2, 1));
  EXPECT_TRUE(MapJoins({join(1, 2), join(2, 3)}).areSettled(1, 3));
}

}  // namespace
}  // namespace mba_vo::map_joins_test
