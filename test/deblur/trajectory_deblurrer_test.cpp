#include "mba_vo/deblur/trajectory_deblurrer.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::trajectory_deblurrer_test {
namespace {

using test::roomSimulator;
using test::toFloat;

constexpr double kExposure = 0.02;  // [s]

double psnr(const cv::Mat1f& image, const cv::Mat1b& truth) {
  const cv::Mat1f difference(image - toFloat(truth));
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(difference.total()) / difference.dot(difference));
}

/// A view of the rendered room, blurred by the renderer; true motion and depths.
struct Scene {
  SimulatedFrame frame;
  DeblurInput input;
};

Scene makeScene(const Vector6& velocity) {
  Scene scene;
  const SE3 origin = roomSimulator().pose(1.0);
  scene.frame = roomSimulator().renderExposure(test::constantVelocity(origin, velocity), 0.0, kExposure);
  const cv::Mat1f blurred = toFloat(scene.frame.blurred);
  scene.input.image = std::make_shared<const ImagePyramid>(blurred, roomSimulator().camera(), 3);
  scene.input.motion = {SE3(), velocity, kExposure};
  for (int y = 4; y < blurred.rows; y += 11) {
    for (int x = 4; x < blurred.cols; x += 11) {
      scene.input.depths.push_back({{static_cast<float>(x), static_cast<float>(y)}, 1.0F / scene.frame.depth(y, x)});
    }
  }
  return scene;
}

/// Some 12 px of blur.
const Scene& turningScene() {
  static const Scene scene = makeScene((Vector6() << 0.5, 0.2, 0.1, 1.2, 2.6, 0.8).finished());
  return scene;
}

DeblurResult deblur(const DeblurInput& input) { return TrajectoryDeblurrer({}).deblur(input); }

TEST(TrajectoryDeblurrer, SharpensARenderedImage) {
  const Scene& scene = turningScene();
  const DeblurResult result = deblur(scene.input);
  ASSERT_TRUE(result.sharpened) << result.reason;
  EXPECT_GT(result.blur_px, 6.0F);
  EXPECT_LT(result.residual, 1.6F);
  EXPECT_EQ(result.image->levels(), scene.input.image->levels());
  const double before = psnr(scene.input.image->level(0).intensity, scene.frame.sharp);
  EXPECT_GT(psnr(result.image->level(0).intensity, scene.frame.sharp), before + 4.0);
}

TEST(TrajectoryDeblurrer, AWrongMotionIsNoticed) {
  DeblurInput input = turningScene().input;
  std::swap(input.motion.velocity(3), input.motion.velocity(4));  // as long, in another direction
  input.motion.velocity(3) *= -1.0;
  const DeblurResult result = deblur(input);
  EXPECT_FALSE(result.sharpened);
  EXPECT_EQ(result.image, input.image);
  EXPECT_GT(result.residual, 1.6F);
}

TEST(TrajectoryDeblurrer, WhereTwoMeasurementsDisagreeTheImageIsLeft) {
  DeblurInput input = turningScene().input;
  input.other_velocity = 1.15 * input.motion.velocity;
  EXPECT_EQ(deblur(input).reason, "motion uncertain");
  input.other_velocity = 1.02 * input.motion.velocity;
  EXPECT_TRUE(deblur(input).sharpened);
}

TEST(TrajectoryDeblurrer, ASharpImageIsLeftAsItIs) {
  DeblurInput input = turningScene().input;
  input.motion.velocity *= 0.1;
  const DeblurResult result = deblur(input);
  EXPECT_EQ(result.image, input.image);
  EXPECT_EQ(result.reason, "sharp enough");
  EXPECT_LT(result.blur_px, 3.0F);
}

TEST(TrajectoryDeblurrer, WithoutDepthsTheImageIsLeftAsItIs) {
  DeblurInput input = turningScene().input;
  input.depths.clear();
  const DeblurResult result = deblur(input);
  EXPECT_EQ(result.image, input.image);
  EXPECT_EQ(result.reason, "no depths");
}

/// A lamp too bright for the camera, and a part without pixels, spoil nothing but themselves.
TEST(TrajectoryDeblurrer, SaturatedAndInvalidPixelsDoNotCount) {
  const Scene& scene = turningScene();
  const cv::Rect lamp(100, 60, 30, 12);
  const cv::Rect gap(240, 150, 25, 25);
  cv::Mat1f spoilt = scene.input.image->level(0).intensity.clone();
  spoilt(lamp).setTo(255.0F);
  spoilt(gap).setTo(std::numeric_limits<float>::quiet_NaN());
  DeblurInput input = scene.input;
  input.image = std::make_shared<const ImagePyramid>(spoilt, roomSimulator().camera(), 3);
  const DeblurResult result = deblur(input);
  ASSERT_TRUE(result.sharpened) << result.reason;
  const cv::Mat1f sharp = result.image->level(0).intensity;
  EXPECT_TRUE(std::isnan(sharp(160, 250)));
  const cv::Mat1f clean = deblur(scene.input).image->level(0).intensity;
  const cv::Rect elsewhere(0, 100, 200, 140);
  EXPECT_TRUE(cv::checkRange(sharp(elsewhere)));
  EXPECT_LT(cv::norm(sharp(elsewhere), clean(elsewhere)) / std::sqrt(static_cast<double>(elsewhere.area())), 1.0);
}

/// The depths matter: parallax of a fast walk makes the near paths twice as long as the far ones.
TEST(TrajectoryDeblurrer, UsesTheDepths) {
  const Scene scene = makeScene((Vector6() << 3.5, 0.3, 0.0, 0.0, 0.0, 0.0).finished());
  const double before = psnr(scene.input.image->level(0).intensity, scene.frame.sharp);
  const DeblurResult result = deblur(scene.input);
  ASSERT_TRUE(result.sharpened) << result.reason;
  const double with_depths = psnr(result.image->level(0).intensity, scene.frame.sharp);
  EXPECT_GT(with_depths, before + 3.0);
  DeblurInput flat = scene.input;
  float mean = 0.0F;
  for (const DepthSample& s : flat.depths) mean += s.inverse_depth / static_cast<float>(flat.depths.size());
  for (DepthSample& s : flat.depths) s.inverse_depth = mean;
  EXPECT_GT(with_depths, psnr(deblur(flat).image->level(0).intensity, scene.frame.sharp) + 1.0);
}

}  // namespace
}  // namespace mba_vo::trajectory_deblurrer_test
