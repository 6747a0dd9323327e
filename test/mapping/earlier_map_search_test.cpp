#include <string>

#include <gtest/gtest.h>

#include "mapping/mapper_fixture.h"
#include "mba_vo/mapping/mapper.h"

namespace mba_vo::test::earlier_map_search_test {
namespace {

SavedMap mapOfAnEarlierRun() {
  static const SavedMap map = [] {
    Mapper mapper(config());
    initialise(mapper);
    SavedMap saved = mapper.savedMap().value();
    moveBeforeAnyRun(saved);
    return saved;
  }();
  return map;
}

MapperConfig configFor(bool localize_only) {
  MapperConfig c = config();
  c.localize_only = localize_only;
  return c;
}

/// A frame of a place that the map does not know, or of nothing, so long after the first.
MapperOutput lookAt(Mapper& mapper, double seconds, bool blind) {
  static const FrameConstPtr unknown = elsewhere(frames().front());
  auto tracked = std::make_shared<TrackedFrame>(*report(shifted(unknown, seconds), TrackingStatus::kInitializing));
  tracked->blind = blind;
  return mapper.process(tracked);
}

bool isLookedFor(const MapperOutput& output) { return output.message.find("the camera is looked for") == 0; }

TEST(EarlierMapSearch, ACameraThatIsNotFoundBeginsAMapOfItsOwnAfterTenSeconds) {
  Mapper mapper(configFor(false));
  mapper.beginIn(mapOfAnEarlierRun());
  EXPECT_EQ(mapper.phase(), MappingPhase::kLocating);
  for (double t = 0.0; t < 9.9; t += 0.5) EXPECT_TRUE(isLookedFor(lookAt(mapper, t, false))) << t;
  const MapperOutput output = lookAt(mapper, 10.1, false);
  EXPECT_TRUE(output.is_news);
  EXPECT_NE(output.message.find("a new map begins"), std::string::npos) << output.message;
  EXPECT_FALSE(mapper.savedMap());
  EXPECT_EQ(mapper.phase(), MappingPhase::kInitializing);
  EXPECT_TRUE(initialise(mapper, 20.0).output.reference);
}

TEST(EarlierMapSearch, ACameraThatIsOnlyToBeLocalisedIsLookedForOn) {
  Mapper mapper(configFor(true));
  mapper.beginIn(mapOfAnEarlierRun());
  for (double t = 0.0; t < 30.0; t += 0.5) EXPECT_FALSE(lookAt(mapper, t, false).is_news);
  EXPECT_EQ(mapper.phase(), MappingPhase::kLocating);
  EXPECT_TRUE(mapper.savedMap());
  MapperOutput output;
  for (int i = 0; i < 10 && !output.reference; ++i) {
    output =
        mapper.process(report(shifted(frames().at(static_cast<std::size_t>(i)), 40.0), TrackingStatus::kInitializing));
  }
  ASSERT_TRUE(output.reference);
  EXPECT_EQ(output.reference->cause, ReferenceCause::kMapBegins);
  EXPECT_EQ(mapper.phase(), MappingPhase::kMapping);
  mapper.reset();
  EXPECT_EQ(mapper.phase(), MappingPhase::kLocating);
}

TEST(EarlierMapSearch, TimeWithoutAnImageThatShowsSomethingDoesNotCount) {
  Mapper mapper(configFor(false));
  mapper.beginIn(mapOfAnEarlierRun());
  EXPECT_TRUE(isLookedFor(lookAt(mapper, 0.0, false)));
  for (double t = 0.5; t < 20.0; t += 0.5) lookAt(mapper, t, true);
  EXPECT_TRUE(isLookedFor(lookAt(mapper, 20.0, false)));
  EXPECT_TRUE(mapper.savedMap());
}

TEST(EarlierMapSearch, AMapThatIsWrongWhereTheCameraWasFoundIsLeft) {
  for (const bool localize_only : {false, true}) {
    MapperConfig demanding = configFor(localize_only);
    demanding.health.wrong_error = 0.1;  // [px] no map is as good as that
    Mapper mapper(demanding);
    mapper.beginIn(mapOfAnEarlierRun());
    MapperOutput output;
    std::size_t used = 0;
    while (used < 10 && !output.reference) {
      output = mapper.process(report(shifted(frames().at(used++), 40.0), TrackingStatus::kInitializing));
    }
    ASSERT_TRUE(output.reference);
    const ReferenceId found = output.reference->id;
    for (int i = 0; i < 3 && !output.keyframe; ++i) {
      Vector6 turn = Vector6::Zero();
      turn(4) = 0.1 * (i + 1);
      output =
          whole(mapper, report(shifted(frames().at(used++), 40.0), TrackingStatus::kTracking, found, SE3::exp(turn)));
    }
    EXPECT_NE(output.message.find("was given up"), std::string::npos) << output.message;
    EXPECT_EQ(mapper.phase(), localize_only ? MappingPhase::kLocating : MappingPhase::kInitializing);
    EXPECT_EQ(mapper.savedMap().has_value(), localize_only) << "it would be found there again, and again be wrong";
  }
}

}  // namespace
}  // namespace mba_vo::test::earlier_map_search_test
