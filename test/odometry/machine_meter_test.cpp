#include "mba_vo/odometry/machine_meter.h"

#include <memory>
#include <sstream>

#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"

namespace mba_vo::machine_meter_test {
namespace {

TrackerStep imageStep(TrackingStatus status, double blur_px) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = std::make_shared<Frame>();
  tracked->status = status;
  tracked->measures.blur_length_px = blur_px;
  TrackerStep step;
  step.kind = TrackerStep::Kind::kImage;
  step.message.tracked = tracked;
  return step;
}

MapperStep frameStep(TrackingStatus status) {
  MapperStep step;
  step.kind = MapperStep::Kind::kFrame;
  step.cause = imageStep(status, 0.0).message;
  step.output.searched = status == TrackingStatus::kLost;
  step.output.searched_depths = status == TrackingStatus::kTracking;
  return step;
}

MapperStep searchForMapStep(int residuals) {
  MapperStep step = frameStep(TrackingStatus::kInitializing);
  step.output.residuals = residuals;
  return step;
}

MapperStep firstMapStep(int residuals) {
  MapperStep step = searchForMapStep(residuals);
  auto reference = std::make_shared<Reference>();
  reference->cause = ReferenceCause::kMapBegins;
  step.output.reference = reference;
  return step;
}

MapperStep insertionStep(int residuals) {
  MapperStep step = frameStep(TrackingStatus::kTracking);
  step.output.inserted = true;
  step.output.residuals = residuals;
  return step;
}

MapperStep iterationStep(int residuals) {
  MapperStep step;
  step.kind = MapperStep::Kind::kRefinement;
  step.output.residuals = residuals;
  return step;
}

Machine made() {
  Machine machine;
  machine.image = 5.0;
  machine.track = 3.0;
  machine.track_per_px = 0.5;
  machine.look_for_map = 20.0;
  machine.look_for_map_per_1000 = 7.0;
  machine.first_map = 60.0;
  machine.depth_search = 4.0;
  machine.draft = 10.0;
  machine.draft_per_1000 = 0.7;
  machine.iteration = 1.5;
  machine.iteration_per_1000 = 2.0;
  machine.keyframe = 15.0;
  machine.relocalize = 30.0;
  machine.deferred = 8.0;
  return machine;
}

/// Steps that take as long as on that machine.
MachineMeter metered(const Machine& machine) {
  MachineMeter meter;
  for (const double blur_px : {0.0, 4.0, 10.0, 30.0}) {
    TrackerStep step = imageStep(TrackingStatus::kTracking, blur_px);
    step.build_ms = machine.image;
    meter.add(step, machine.secondsFor(step));
  }
  const auto add = [&](const MapperStep& step) { meter.add(step, machine.timeFor(step).sum()); };
  for (const int residuals : {0, 0, 2000, 5000}) add(searchForMapStep(residuals));
  add(firstMapStep(5000));
  for (const TrackingStatus status : {TrackingStatus::kTracking, TrackingStatus::kLost}) add(frameStep(status));
  for (const int residuals : {1000, 5000, 20000}) add(insertionStep(residuals));
  for (const int residuals : {1000, 5000, 20000}) add(iterationStep(residuals));
  MapperStep last = iterationStep(5000);
  last.output.keyframe = KeyframeReport();
  add(last);
  MapperStep deferred;
  deferred.kind = MapperStep::Kind::kDeferred;
  add(deferred);
  return meter;
}

TEST(MachineMeter, FindsTheMachineThatItWasMeasuredOn) {
  const Machine found = metered(made()).machine();
  EXPECT_NEAR(found.image, 5.0, 1e-9);
  EXPECT_NEAR(found.track, 3.0, 1e-9);
  EXPECT_NEAR(found.track_per_px, 0.5, 1e-9);
  EXPECT_NEAR(found.look_for_map, 20.0, 1e-9);
  EXPECT_NEAR(found.look_for_map_per_1000, 7.0, 1e-9);
  EXPECT_NEAR(found.first_map, 60.0, 1e-9);
  EXPECT_NEAR(found.depth_search, 4.0, 1e-9);
  EXPECT_NEAR(found.draft, 10.0, 1e-9);
  EXPECT_NEAR(found.draft_per_1000, 0.7, 1e-9);
  EXPECT_NEAR(found.iteration, 1.5, 1e-9);
  EXPECT_NEAR(found.iteration_per_1000, 2.0, 1e-9);
  EXPECT_NEAR(found.keyframe, 15.0, 1e-9);
  EXPECT_NEAR(found.relocalize, 30.0, 1e-9);
  EXPECT_NEAR(found.deferred, 8.0, 1e-9);
  EXPECT_EQ(found.orientation, Machine().orientation) << "there was none";
}

TEST(Machine, OnlySearchOptimisationAndNewPointsAreShared) {
  const Machine machine = made();
  EXPECT_GT(machine.timeFor(iterationStep(5000)).parallel, machine.timeFor(iterationStep(5000)).serial);
  EXPECT_GT(machine.timeFor(frameStep(TrackingStatus::kTracking)).parallel, 0.0);
  const StepTime less = machine.timeFor(insertionStep(5000));
  const StepTime more = machine.timeFor(insertionStep(6000));
  EXPECT_NEAR(more.sum() - less.sum(), 1e-3 * machine.draft_per_1000, 1e-12);
  EXPECT_GT(more.parallel - less.parallel, more.serial - less.serial);
  for (const MapperStep& step : {searchForMapStep(5000), frameStep(TrackingStatus::kLost)}) {
    EXPECT_EQ(machine.timeFor(step).parallel, 0.0);
  }
}

TEST(Machine, AKeyframeTakesItsTimeAlsoWhileTheTrackerHasNoReference) {
  MapperStep last = frameStep(TrackingStatus::kInitializing);
  last.kind = MapperStep::Kind::kRefinement;
  last.output.keyframe = KeyframeReport();
  EXPECT_NEAR(made().timeFor(last).sum(), 1e-3 * made().keyframe, 1e-12);
}

TEST(Machine, FramesThatLeadToTheSecondKeyframeAreTrackedAndSearched) {
  MapperStep along = frameStep(TrackingStatus::kTracking);
  along.kind = MapperStep::Kind::kRefinement;
  along.output = MapperOutput();
  along.output.initial_frames = 3;
  EXPECT_NEAR(made().timeFor(along).sum(), 3e-3 * (made().track + made().depth_search), 1e-12);
}

TEST(MachineMeter, TwiceAsSlowIsTwiceAsSlow) {
  const Machine found = metered(made().slowedBy(2.0)).machine();
  EXPECT_NEAR(found.track_per_px, 1.0, 1e-9);
  EXPECT_NEAR(found.iteration_per_1000, 4.0, 1e-9);
}

TEST(Machine, IsWrittenAndReadAsYaml) {
  std::stringstream text;
  writeConfig(made(), text);
  Machine read;
  readConfig(YAML::Load(text.str()), read);
  EXPECT_EQ(read.keyframe, made().keyframe);
  EXPECT_EQ(read.relocalize, made().relocalize);
}

}  // namespace
}  // namespace mba_vo::machine_meter_test
