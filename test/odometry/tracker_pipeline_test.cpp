#include "mba_vo/odometry/tracker_pipeline.h"

#include <iterator>
#include <optional>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "odometry/tracking_loop_fixture.h"

namespace mba_vo::test::tracker_pipeline_test {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kSession = 7;

TrackerPipelineConfig pipelineConfig(std::size_t max_queue_bytes = 64000000) {
  TrackerPipelineConfig config;
  config.max_queue_bytes = max_queue_bytes;
  return config;
}

CameraImage image(int index) {
  CameraImage image;
  image.sequence = view(index).id;
  image.stamp_ns = image.mid_exposure_ns = view(index).mid_exposure_ns;
  image.exposure = view(index).exposure;
  image.image = view(index).blurred;
  image.camera_frame = "camera";
  return image;
}

/// All steps until nothing is left to do.
std::vector<TrackerStep> drain(TrackerPipeline& pipeline) {
  std::vector<TrackerStep> steps;
  while (std::optional<TrackerStep> step = pipeline.step()) steps.push_back(*step);
  return steps;
}

/// A pipeline that tracks against frame 0 and has tracked up to frame `last`.
void begin(TrackerPipeline& pipeline, int last) {
  pipeline.setCalibration(roomConfig().calibration());
  pipeline.addImage(image(0));
  drain(pipeline);
  pipeline.addReference({kSession, makeReference(1, 0, 0, SE3(), 0)});
  for (int i = 1; i <= last; ++i) {
    pipeline.addImage(image(i));
    drain(pipeline);
  }
}

TEST(TrackerPipeline, EveryImageHasOneFirstResult) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  pipeline.setCalibration(roomConfig().calibration());
  pipeline.addImage(image(0), 3.5);
  const std::vector<TrackerStep> first = drain(pipeline);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].kind, TrackerStep::Kind::kPassed) << "the calibration";
  EXPECT_EQ(first[1].kind, TrackerStep::Kind::kImage);
  EXPECT_EQ(first[1].arrival, 3.5);
  EXPECT_EQ(first[1].message.session, kSession);
  EXPECT_TRUE(first[1].message.keep_map);
  EXPECT_FALSE(first[1].message.has_reference);
  EXPECT_EQ(first[1].message.mount.camera_frame, "camera");
  EXPECT_EQ(first[1].message.tracked->status, TrackingStatus::kInitializing);
  pipeline.addReference({kSession, makeReference(1, 0, 0, SE3(), 0)});
  pipeline.addImage(image(1));
  const std::vector<TrackerStep> second = drain(pipeline);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].phase, TrackingPhase::kTracking);
  EXPECT_TRUE(second[0].message.has_reference);
  EXPECT_LT(distance(second[0].T_map_odom * second[0].T_odom_camera, truth(0, 1)), kClose);
  EXPECT_EQ(pipeline.takeAdopted().size(), 1U);
}

TEST(TrackerPipeline, TracksOnWhereTheWhiteLevelIsFoundToBeHigher) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  const auto deep = [](int index) {
    CameraImage result = image(index);
    result.image = cv::Mat();
    image(index).image.convertTo(result.image, CV_16U, 4.0);
    return result;
  };
  pipeline.setCalibration(roomConfig().calibration());
  pipeline.addImage(deep(0));
  drain(pipeline);
  pipeline.addReference({kSession, makeReference(1, 0, 0, SE3(), 0)});
  pipeline.addImage(deep(1));
  EXPECT_EQ(drain(pipeline).back().reason, "");
  CameraImage with_lamp = deep(2);
  with_lamp.image.at<std::uint16_t>(1, 1) = 3000;
  pipeline.addImage(with_lamp);
  const std::vector<TrackerStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_THAT(steps[0].reason, HasSubstr("white is 4095, not 1023"));
  EXPECT_EQ(steps[0].message.tracked->status, TrackingStatus::kTracking);
  EXPECT_NEAR(steps[0].message.tracked->brightness.a, 0.0, 0.05);
  EXPECT_LT(distance(steps[0].T_map_odom * steps[0].T_odom_camera, truth(0, 2)), kClose);
}

TEST(TrackerPipeline, ImagesAndFramesThatWaitTakeTurnsWhileCatchingUp) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  pipeline.setCalibration(roomConfig().calibration());
  for (int i = 0; i <= 4; ++i) pipeline.addImage(image(i));
  drain(pipeline);
  pipeline.addReference({kSession, makeReference(1, 0, 0, SE3(), 0)});
  for (int i = 5; i <= 6; ++i) pipeline.addImage(image(i));
  std::vector<TrackerStep::Kind> kinds;
  for (const TrackerStep& step : drain(pipeline)) kinds.push_back(step.kind);
  using Kind = TrackerStep::Kind;
  EXPECT_THAT(kinds, testing::ElementsAre(Kind::kLate, Kind::kImage, Kind::kLate, Kind::kImage, Kind::kLate,
                                          Kind::kLate, Kind::kLate, Kind::kLate));
  EXPECT_EQ(pipeline.tracking().phase(), TrackingPhase::kTracking);
}

TEST(TrackerPipeline, WhereImagesComeTooFastTheNewestIsTrackedAndTheOthersArePlaced) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 2);
  for (int i = 3; i <= 7; ++i) pipeline.addImage(image(i));
  int told = 0;
  std::size_t placed = 0;
  for (const TrackerStep& step : drain(pipeline)) {
    told += step.notice.find("some are left out") != std::string::npos ? 1 : 0;
    placed += step.placed.size();
  }
  EXPECT_EQ(told, 1);
  EXPECT_GT(placed, 0U);
  EXPECT_EQ(pipeline.tracking().phase(), TrackingPhase::kTracking);
  EXPECT_LT(distance(pipeline.tracking().T_map_odom() * pipeline.tracking().T_odom_camera(), truth(0, 7)), kClose);
}

TEST(TrackerPipeline, AStepWithoutAResultTellsThePhaseToo) {
  using testing::Field;
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 2);
  for (int i = 3; i <= 5; ++i) pipeline.addImage(image(i));
  pipeline.addFrame(elsewhere(0.0));
  EXPECT_THAT(drain(pipeline), testing::Contains(AllOf(Field(&TrackerStep::failed_leap, true),
                                                       Field(&TrackerStep::phase, TrackingPhase::kCatchingUp))));
}

TEST(TrackerPipeline, NewImagesGoBeforeFramesThatAreTrackedOnceMore) {
  TrackerPipelineConfig config = pipelineConfig();
  config.odometry = demanding();
  TrackerPipeline pipeline(config, kSession);
  begin(pipeline, 9);
  auto keyframe = makeReference(1, 1, 5, truth(0, 5));
  keyframe->T_map_keyframe[0] = SE3();
  pipeline.addReference({kSession, keyframe});
  pipeline.addImage(image(10));
  const std::optional<TrackerStep> first = pipeline.step();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->kind, TrackerStep::Kind::kImage);
  EXPECT_EQ(first->phase, TrackingPhase::kRevising);
  const std::optional<TrackerStep> second = pipeline.step();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->kind, TrackerStep::Kind::kLate);
}

TEST(TrackerPipeline, AResetIsANewSessionAndOldReferencesAreStale) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 2);
  pipeline.requestReset();
  const std::vector<TrackerStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_TRUE(steps[0].began_anew);
  EXPECT_EQ(steps[0].kind, TrackerStep::Kind::kReset);
  pipeline.addReference({kSession, makeReference(1, 0, 0, SE3(), 0)});
  pipeline.addImage(image(3));
  const std::vector<TrackerStep> after = drain(pipeline);
  ASSERT_EQ(after.size(), 1U);
  EXPECT_EQ(after[0].message.session, kSession + 1);
  EXPECT_FALSE(after[0].message.keep_map);
  EXPECT_EQ(after[0].phase, TrackingPhase::kNoMap);
  EXPECT_EQ(pipeline.takeStale(), 1U);
}

TEST(TrackerPipeline, AnotherCalibrationEndsWhatWentBefore) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 2);
  CameraCalibration other = roomConfig().calibration();
  other.fx *= 1.1;
  pipeline.setCalibration(other);
  const std::vector<TrackerStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_THAT(steps[0].reason, HasSubstr("calibration"));
  EXPECT_EQ(pipeline.tracking().phase(), TrackingPhase::kNoMap);
}

TEST(TrackerPipeline, ImagesOfNoUseAreRejectedWithAReason) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  pipeline.addImage(image(0));
  begin(pipeline, 1);
  pipeline.addImage(image(1));  // once more
  CameraImage unreadable = image(2);
  unreadable.image = cv::Mat();
  unreadable.problem = "broken file";
  pipeline.addImage(unreadable);
  CameraImage small = image(3);
  small.image = small.image(cv::Rect(0, 0, 100, 100)).clone();
  pipeline.addImage(small);
  const std::vector<TrackerStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 3U);
  for (const TrackerStep& step : steps) {
    EXPECT_EQ(step.kind, TrackerStep::Kind::kRejected);
    EXPECT_EQ(step.message.tracked, nullptr);
  }
  EXPECT_THAT(steps[0].reason, HasSubstr("repeats"));
  EXPECT_EQ(steps[1].reason, "broken file");
  EXPECT_THAT(steps[2].reason, HasSubstr("100x100"));
  EXPECT_TRUE(steps[2].contradicts_calibration);
}

TEST(TrackerPipeline, ARepeatedImageHasTheResultOfTheFirstUntilTheStreamIsFrozen) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 2);
  std::vector<TrackerStep> steps;
  for (int i = 1; i <= 6; ++i) {
    CameraImage again = image(2);
    again.sequence += static_cast<std::uint64_t>(i);
    again.stamp_ns = again.mid_exposure_ns += 37000000LL * i;
    pipeline.addImage(again);
    for (const TrackerStep& step : drain(pipeline)) steps.push_back(step);
  }
  ASSERT_EQ(steps.size(), 6U);
  for (int i = 0; i < 4; ++i) {
    const TrackerStep& step = steps[static_cast<std::size_t>(i)];
    EXPECT_EQ(step.kind, TrackerStep::Kind::kRepeated) << i;
    EXPECT_EQ(step.message.tracked, nullptr);
    ASSERT_NE(step.repeated, nullptr);
    EXPECT_EQ(step.repeated->frame->stamp_ns, step.stamp_ns);
    EXPECT_EQ(step.mid_exposure_ns, view(2).mid_exposure_ns);
    EXPECT_LT(distance(step.T_map_odom * step.T_odom_camera, truth(0, 2)), kClose);
    EXPECT_EQ(step.reason, "repeats the image of " + std::to_string(1e-9 * double(image(2).stamp_ns)) + " s");
  }
  for (std::size_t i = 4; i < 6; ++i) {
    EXPECT_EQ(steps[i].kind, TrackerStep::Kind::kImage);
    EXPECT_EQ(steps[i].message.tracked->status, TrackingStatus::kLost);
    EXPECT_TRUE(steps[i].message.tracked->blind);
  }
  pipeline.requestReset();
  drain(pipeline);
  pipeline.addImage(image(3));
  EXPECT_EQ(drain(pipeline).at(0).kind, TrackerStep::Kind::kImage);
}

TEST(TrackerPipeline, AClockThatBeginsAnewIsANewStart) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  begin(pipeline, 3);
  CameraImage early = image(4);
  early.stamp_ns = early.mid_exposure_ns = view(0).mid_exposure_ns - 5000000000;
  pipeline.addImage(early);
  const std::vector<TrackerStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(steps[0].kind, TrackerStep::Kind::kImage);
  EXPECT_TRUE(steps[0].began_anew);
  EXPECT_EQ(steps[0].message.session, kSession + 1);
  EXPECT_EQ(steps[0].message.tracked->status, TrackingStatus::kInitializing);
}

TEST(TrackerPipeline, TooManyImagesAreThinnedOutEvenly) {
  const std::size_t bytes = view(0).blurred.total();
  TrackerPipeline pipeline(pipelineConfig(5 * bytes), kSession);
  std::set<std::uint64_t> kept;
  for (int i = 0; i < 9; ++i) {
    kept.insert(view(i).id - view(0).id);
    for (const CameraImage& shed : pipeline.addImage(image(i), i)) {
      kept.erase(shed.sequence - view(0).id);
      EXPECT_EQ(view(static_cast<int>(shed.arrival)).id, shed.sequence);
    }
  }
  ASSERT_EQ(kept.size(), 5U);
  EXPECT_EQ(*kept.begin(), 0U);
  EXPECT_EQ(*kept.rbegin(), 8U);
  for (auto next = std::next(kept.begin()); next != kept.end(); ++next) EXPECT_LE(*next - *std::prev(next), 3U);
  EXPECT_LE(pipeline.queueBytes(), 5 * bytes);
}

TEST(TrackerPipeline, WhoeverEndsCanAskWhichImagesHaveNoResult) {
  TrackerPipeline pipeline(pipelineConfig(), kSession);
  pipeline.addImage(image(0), 3.5);
  pipeline.requestReset();
  pipeline.addImage(image(1));
  ASSERT_TRUE(pipeline.step());
  ASSERT_TRUE(pipeline.imageInWork());
  EXPECT_EQ(pipeline.imageInWork()->sequence, view(0).id);
  EXPECT_EQ(pipeline.imageInWork()->arrival, 3.5);
  ASSERT_TRUE(pipeline.step());
  EXPECT_FALSE(pipeline.imageInWork()) << "a reset";
  const std::vector<CameraImage> left = pipeline.takeImages();
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].sequence, view(1).id);
  EXPECT_FALSE(pipeline.step());
}

}  // namespace
}  // namespace mba_vo::test::tracker_pipeline_test
