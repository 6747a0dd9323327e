#include "mba_vo/tracking/keyframe_policy.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::keyframe_policy_test {
namespace {

FrameMeasures still() {
  FrameMeasures measures;
  measures.visible_fraction = 1.0;
  return measures;
}

bool takes(const FrameMeasures& measures, const AffineBrightness& brightness = {}, const Reference& reference = {}) {
  return KeyframePolicy({}).takes(reference, measures, brightness);
}

TEST(KeyframePolicy, ACameraThatSeesTheSameNeedsNone) {
  EXPECT_FALSE(takes(still()));
  EXPECT_DOUBLE_EQ(KeyframePolicy({}).need({}, still(), {}), 0.0);
}

TEST(KeyframePolicy, MotionParallaxVisibilityAndBrightnessEachAskForOne) {
  const KeyframePolicyConfig config;
  FrameMeasures flow = still();
  flow.flow_px = 0.9 * config.flow_px;
  EXPECT_FALSE(takes(flow));
  flow.flow_px = 1.1 * config.flow_px;
  EXPECT_TRUE(takes(flow));

  FrameMeasures parallax = still();
  parallax.parallax_px = 0.9 * config.parallax_px;
  EXPECT_FALSE(takes(parallax));
  parallax.parallax_px = 1.1 * config.parallax_px;
  EXPECT_TRUE(takes(parallax));

  FrameMeasures hidden = still();
  hidden.visible_fraction = config.min_visible_fraction + 0.02;
  EXPECT_FALSE(takes(hidden));
  hidden.visible_fraction = config.min_visible_fraction - 0.02;
  EXPECT_TRUE(takes(hidden));

  for (const double sign : {-1.0, 1.0}) {
    EXPECT_FALSE(takes(still(), {sign * 0.9 * config.brightness_change, 0.0}));
    EXPECT_TRUE(takes(still(), {sign * 1.1 * config.brightness_change, 0.0}));
  }
  // Only the change since the reference counts.
  Reference reference;
  reference.brightness.a = 2.0;
  EXPECT_FALSE(takes(still(), {2.0, 0.0}, reference));
  EXPECT_TRUE(takes(still(), {0.0, 0.0}, reference));
}

TEST(KeyframePolicy, NeedsAddUp) {
  const KeyframePolicyConfig config;
  FrameMeasures measures = still();
  measures.flow_px = 0.6 * config.flow_px;
  EXPECT_FALSE(takes(measures));
  measures.parallax_px = 0.6 * config.parallax_px;
  EXPECT_TRUE(takes(measures));
}

TEST(KeyframePolicy, WaitsForASharpFrameUntilTheNeedIsUrgent) {
  const KeyframePolicyConfig config;
  FrameMeasures measures = still();
  measures.flow_px = 1.2 * config.flow_px;
  measures.blur_length_px = config.sharp_blur_px;
  EXPECT_TRUE(takes(measures));
  measures.blur_length_px = 3.0 * config.sharp_blur_px;
  EXPECT_FALSE(takes(measures));
  measures.flow_px = (1.0 + 2.0 * config.patience - 0.05) * config.flow_px;
  EXPECT_FALSE(takes(measures));
  // No blur, however strong, keeps a keyframe away for ever.
  measures.blur_length_px = 1000.0;
  measures.flow_px = 3.0 * config.flow_px;
  EXPECT_TRUE(takes(measures));
}

TEST(KeyframePolicy, MoreBlurNeverMakesAFrameMoreWelcome) {
  const KeyframePolicyConfig config;
  for (double flow = 0.5; flow < 3.0; flow += 0.1) {
    bool taken = true;
    for (double blur = 0.0; blur < 40.0; blur += 0.5) {
      FrameMeasures measures = still();
      measures.flow_px = flow * config.flow_px;
      measures.blur_length_px = blur;
      const bool now = takes(measures);
      EXPECT_LE(now, taken);
      taken = now;
    }
  }
}

/// The least parallax of a frame that helps a map of so many keyframes [px].
double helpfulParallax(KeyframeId keyframes, double blur_px = 0.0, bool metric = false) {
  Reference reference;
  reference.metric = metric;
  for (KeyframeId id = 0; id < keyframes; ++id) reference.T_map_keyframe[id] = SE3();
  FrameMeasures measures = still();
  measures.blur_length_px = blur_px;
  while (measures.parallax_px < 200.0 && !KeyframePolicy({}).helpsYoungMap(reference, measures, {})) {
    measures.parallax_px += 0.1;
  }
  return measures.parallax_px;
}

TEST(KeyframePolicy, LessParallaxHelpsAMapOfFewKeyframes) {
  const KeyframePolicyConfig config;
  for (const KeyframeId keyframes : {2, 3, 5, 6}) {
    EXPECT_NEAR(helpfulParallax(keyframes), keyframes * config.parallax_px / 6.0, 0.2) << keyframes;
  }
  EXPECT_DOUBLE_EQ(helpfulParallax(1), helpfulParallax(2)) << "its depths rest on two views as well";
  EXPECT_DOUBLE_EQ(helpfulParallax(20), helpfulParallax(6)) << "it has grown";
}

TEST(KeyframePolicy, ABlurredFrameHelpsAYoungMapAsMuchLessAsItIsBlurred) {
  const KeyframePolicyConfig config;
  for (const double blur_px : {4.0, 10.0, 20.0}) {
    const double patience = 1.0 + config.patience * (blur_px / config.sharp_blur_px - 1.0);
    EXPECT_NEAR(helpfulParallax(2, blur_px), patience * helpfulParallax(2), 0.5) << blur_px << " px";
  }
}

TEST(KeyframePolicy, DepthsInMetresNeedNoHelp) { EXPECT_GT(helpfulParallax(2, 0.0, true), 199.0); }

}  // namespace
}  // namespace mba_vo::keyframe_policy_test
