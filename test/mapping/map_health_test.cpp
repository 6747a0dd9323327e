#include "mba_vo/mapping/map_health.h"

#include <initializer_list>

#include <gtest/gtest.h>

namespace mba_vo::map_health_test {
namespace {

void add(MapHealth& health, std::initializer_list<double> errors) {
  for (const double error : errors) health.addKeyframe(error);
}

TEST(MapHealth, AMapThatExplainsItsKeyframesIsGood) {
  MapHealth health({});
  EXPECT_TRUE(health.doubt().empty());
  add(health, {0.2, 0.3, 0.25, 0.5, 0.3, 0.4, 0.2, 0.6, 0.3});
  EXPECT_TRUE(health.doubt().empty()) << health.doubt();
  EXPECT_FALSE(health.isWrong());
  EXPECT_EQ(health.badInARow(), 0);
}

TEST(MapHealth, ErrorsThatRiseAreDoubtedWhateverTheyWereBefore) {
  MapHealth health({});
  add(health, {0.2, 0.3, 0.25, 0.2, 0.3, 0.9});
  EXPECT_NE(health.doubt().find("0.9 px"), std::string::npos) << health.doubt();
  EXPECT_FALSE(health.isWrong());
  add(health, {0.3});
  EXPECT_TRUE(health.doubt().empty()) << "it has recovered";
  // A camera that is not well known has larger errors always, which is no rise.
  MapHealth rough({});
  add(rough, {0.8, 0.9, 0.7, 1.0, 1.1, 1.2, 0.9});
  EXPECT_TRUE(rough.doubt().empty()) << rough.doubt();
  add(rough, {1.4});
  EXPECT_FALSE(rough.doubt().empty());
}

TEST(MapHealth, AYoungMapIsWrongAtOnceAnOldOneIfItStaysSo) {
  MapHealth young({});
  add(young, {2.5});
  EXPECT_TRUE(young.isYoung());
  EXPECT_TRUE(young.isWrong());
  MapHealth old({});
  add(old, {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 1.0, 2.5});
  EXPECT_FALSE(old.isYoung());
  EXPECT_FALSE(old.isWrong());
  add(old, {2.5});
  EXPECT_TRUE(old.isWrong());
  EXPECT_EQ(old.badInARow(), 3);
  old.reset();
  EXPECT_FALSE(old.isWrong());
  EXPECT_TRUE(old.isYoung());
}

TEST(MapHealth, AMapThatItsFirstFramesContradictIsWrongUnlessAllAre) {
  constexpr int kFirst = 16;
  const auto track = [](MapHealth& health, double error) {
    for (int i = 0; i < kFirst - 1; ++i) {
      health.addFrame(error);
      EXPECT_FALSE(health.isWrong()) << "a few frames say little";
    }
    health.addFrame(error);
  };
  MapHealth health({});
  track(health, 0.6);
  for (int i = 0; i < kFirst; ++i) health.addFrame(1.5);
  EXPECT_FALSE(health.isWrong()) << "heavy blur, later";
  health.reset();
  for (int map = 0; map < 2; ++map) {
    track(health, 1.5);
    EXPECT_TRUE(health.isWrong());
    EXPECT_NE(health.doubt().find("1.5 px (limit 1.0 px)"), std::string::npos) << health.doubt();
    health.reset();
  }
  track(health, 1.5);
  EXPECT_FALSE(health.isWrong()) << "so it is with this camera";
  MapHealth of_earlier_map({});
  of_earlier_map.trustBeginning();
  track(of_earlier_map, 1.5);
  EXPECT_FALSE(of_earlier_map.isWrong()) << "it was right when it was saved";
}

TEST(MapHealth, ResidualGateOfFramesIsTheirMedianOfLate) {
  MapHealth health({});
  EXPECT_EQ(health.usualFrameError(), 0.0);
  for (const double error : {0.2, 0.4, 9.0}) health.addFrame(error);
  EXPECT_DOUBLE_EQ(health.usualFrameError(), 0.4);
  for (int i = 0; i < 200; ++i) health.addFrame(0.7);
  EXPECT_DOUBLE_EQ(health.usualFrameError(), 0.7);
}

}  // namespace
}  // namespace mba_vo::map_health_test
