#include "mba_vo/mapping/outward_tracking.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::outward_tracking_test {
namespace {

constexpr int kFirst = 40;
constexpr int kReference = 5;  // counted from the first, as all below
constexpr KeyframeId kSecond = 1;

SimulatedFrame render(int index) { return test::roomView(kFirst + index); }

FrameConstPtr frame(int index) {
  const SimulatedFrame rendered = render(index);
  return test::makeFrame(rendered, rendered.exposure);
}

FrameConstPtr blank(int index) {
  const SimulatedFrame rendered = render(index);
  return test::makeFrame(cv::Mat1f(240, 376, 90.0F), rendered.mid_exposure_ns, rendered.exposure, rendered.id);
}

FrameConstPtr noisy(int index) {
  const SimulatedFrame rendered = render(index);
  cv::Mat1f image = test::toFloat(rendered.blurred);
  test::Random random(1);
  for (float& intensity : image) intensity += static_cast<float>(random.normal(14.0));
  return test::makeFrame(image, rendered.mid_exposure_ns, rendered.exposure, rendered.id);
}

class OutwardTrackingTest : public testing::Test {
 protected:
  /// Of these frames, by time, backwards from the reference, with the true motion there.
  OutwardTracking begin(const std::vector<FrameConstPtr>& frames) {
    auto initial = std::make_unique<InitialMap>();
    initial->reference = frame(kReference);
    const Vector6 velocity = (reference_.T_world_start.inverse() * reference_.T_world_end).log() / reference_.exposure;
    const MotionState start({SE3(), velocity, reference_.exposure}, reference_.mid_exposure_ns);
    return OutwardTracking(MapperConfig(), std::move(initial), start, {frames.rbegin(), frames.rend()}, snapshot_);
  }

  /// A keyframe of the first frame, its image smoothed.
  std::shared_ptr<Reference> second(double sigma_px) const {
    const SimulatedFrame rendered = render(0);
    cv::Mat1f image = test::toFloat(rendered.sharp);
    if (sigma_px > 0.0) cv::GaussianBlur(image, image, cv::Size(), sigma_px);
    const auto keyframe = test::makeReference(rendered, image);
    keyframe->id.keyframe_id = kSecond;
    keyframe->T_map_reference = truth(0);
    return keyframe;
  }

  /// Four fifths of the keyframe's points are such as are no longer seen a frame before it.
  void crowdWithPointsThatLeave() {
    const PinholeCamera& camera = snapshot_->pyramid->level(0).camera;
    std::vector<ReferencePoint>& points = snapshot_->points;
    const SE3 T_frame_reference = truth(kReference - 1).inverse();
    std::vector<ReferencePoint> leaving;
    for (const ReferencePoint& point : points) {
      const Eigen::Vector3d in_reference =
          camera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
      if (!camera.contains(camera.project(T_frame_reference * in_reference))) leaving.push_back(point);
    }
    ASSERT_FALSE(leaving.empty());
    const std::size_t others = points.size();
    for (std::size_t i = 0; i < 4 * others; ++i) points.push_back(leaving[i % leaving.size()]);
  }

  SE3 truth(int index) const { return reference_.T_world_mid.inverse() * render(index).T_world_mid; }

  SimulatedFrame reference_ = render(kReference);
  std::shared_ptr<Reference> snapshot_ = test::makeReference(reference_, test::toFloat(reference_.sharp));
};

TEST_F(OutwardTrackingTest, GoesBackToTheFirstFrame) {
  std::vector<FrameConstPtr> frames;
  for (int i = 0; i < kReference; ++i) frames.push_back(frame(i));
  OutwardTracking backward = begin(frames);
  for (int i = kReference - 1; i >= 0; --i) {
    ASSERT_FALSE(backward.done());
    const std::optional<TrackedFrame> tracked = backward.next();
    ASSERT_TRUE(tracked) << "frame " << i;
    EXPECT_EQ(tracked->frame->sequence, frames.at(static_cast<std::size_t>(i))->sequence);
    EXPECT_LT((truth(i).inverse() * tracked->trajectory.T_reference_mid).log().norm(), 5e-3) << "frame " << i;
  }
  EXPECT_TRUE(backward.done());
}

TEST_F(OutwardTrackingTest, EndsWithTheFirstFrameThatIsLost) {
  std::vector<FrameConstPtr> frames;
  for (int i = 0; i < kReference; ++i) frames.push_back(i == kReference - 2 ? blank(i) : frame(i));
  OutwardTracking backward = begin(frames);
  EXPECT_TRUE(backward.next());
  EXPECT_FALSE(backward.next());
  EXPECT_TRUE(backward.done());
}

TEST_F(OutwardTrackingTest, EndsWithTheFirstFrameThatIsSeenBadly) {
  const FrameConstPtr bad = noisy(kReference - 2);
  const SimulatedFrame rendered = render(kReference - 2);
  const Vector6 velocity = (rendered.T_world_start.inverse() * rendered.T_world_end).log() / rendered.exposure;
  const MotionState motion({truth(kReference - 2), velocity, rendered.exposure}, rendered.mid_exposure_ns);
  const TrackingGuess right(motion.priorAt(rendered.mid_exposure_ns), rendered.exposure);
  ASSERT_EQ(Tracker(TrackerConfig()).track(*snapshot_, bad, right).status, TrackingStatus::kDegraded);
  std::vector<FrameConstPtr> frames;
  for (int i = 0; i < kReference; ++i) frames.push_back(i == kReference - 2 ? bad : frame(i));
  OutwardTracking backward = begin(frames);
  EXPECT_TRUE(backward.next());
  EXPECT_FALSE(backward.next());
  EXPECT_TRUE(backward.done());
}

TEST_F(OutwardTrackingTest, WhereLittleOfTheKeyframeIsSeenItGoesOnIfThePoseIsKnownWell) {
  crowdWithPointsThatLeave();
  OutwardTracking backward = begin({frame(kReference - 1)});
  const std::optional<TrackedFrame> tracked = backward.next();
  ASSERT_TRUE(tracked);
  EXPECT_LT(tracked->measures.visible_fraction, 0.35);
  EXPECT_LT((truth(kReference - 1).inverse() * tracked->trajectory.T_reference_mid).log().norm(), 5e-3);
}

TEST(SeenWell, WhereLittleIsSeenOnlyIfThePoseIsKnownWell) {
  TrackedFrame tracked;
  const auto isWell = [&](TrackingStatus status, double visible_fraction, double expected_error) {
    tracked.status = status;
    tracked.measures.visible_fraction = visible_fraction;
    tracked.expected_error = expected_error;
    return isSeenWell(tracked);
  };
  EXPECT_TRUE(isWell(TrackingStatus::kTracking, 0.9, 0.9));
  EXPECT_TRUE(isWell(TrackingStatus::kTracking, 0.3, 0.05));
  EXPECT_FALSE(isWell(TrackingStatus::kTracking, 0.3, 0.5));
  EXPECT_FALSE(isWell(TrackingStatus::kDegraded, 0.9, 0.05));
  EXPECT_FALSE(isWell(TrackingStatus::kLost, 0.9, 0.05));
}

TEST_F(OutwardTrackingTest, AKeyframeThatSeesMoreTakesOver) {
  crowdWithPointsThatLeave();
  OutwardTracking backward = begin({frame(kReference - 2), frame(kReference - 1)});
  backward.update({snapshot_, second(0.0)});
  for (int i = kReference - 1; !backward.done(); --i) {
    const std::optional<TrackedFrame> tracked = backward.next();
    ASSERT_TRUE(tracked) << "frame " << i;
    EXPECT_EQ(tracked->reference.keyframe_id, kSecond);
    const SE3 T_first_frame = truth(0) * tracked->trajectory.T_reference_mid;
    EXPECT_LT((truth(i).inverse() * T_first_frame).log().norm(), 5e-3) << "frame " << i;
  }
}

TEST_F(OutwardTrackingTest, ANearerKeyframeThatTellsLessDoesNot) {
  OutwardTracking backward = begin({frame(0), frame(2), frame(4)});
  backward.update({snapshot_, second(4.0)});
  while (!backward.done()) {
    const std::optional<TrackedFrame> tracked = backward.next();
    ASSERT_TRUE(tracked);
    EXPECT_EQ(tracked->reference.keyframe_id, snapshot_->id.keyframe_id);
  }
}

}  // namespace
}  // namespace mba_vo::outward_tracking_test
