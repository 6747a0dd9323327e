#include "mba_vo/deblur/blur_operator.h"

#include <cmath>

#include <gtest/gtest.h>

#include "deblur/transpose_check.h"
#include "mba_vo/blur/reblur.h"

namespace mba_vo::blur_operator_test {
namespace {

const PinholeCamera kCamera{101, 76, 80.0, 82.0, 50.3, 37.1};  // whole tiles neither way
constexpr int kReach = 12;

ExposureTrajectory turningMotion() {
  ExposureTrajectory motion;
  motion.exposure = 0.02;
  motion.velocity << 0.6, -0.4, 0.3, 3.0, 5.0, -1.5;
  motion.acceleration << 3.0, 0.0, 0.0, 30.0, -60.0, 0.0;
  return motion;
}

/// Inverse depth of a slanted plane [1/m].
cv::Mat1f slantedDepth(const PinholeCamera& camera) {
  cv::Mat1f depth(camera.height, camera.width);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) depth(y, x) = 0.4F + 0.003F * static_cast<float>(x);
  }
  return depth;
}

/// Smooth enough to be interpolated well.
float smoothIntensity(float x, float y) { return 120.0F + 60.0F * std::sin(0.21F * x) * std::cos(0.17F * y + 0.4F); }

BlurOperator makeOperator(const ExposureTrajectory& motion) {
  return {{kCamera, kCamera, motion}, slantedDepth(kCamera), BlurOperator::gridFor(kCamera, kReach)};
}

TEST(BlurOperator, TransposedIsTheTranspose) { test::expectExactTranspose(makeOperator(turningMotion())); }

TEST(BlurOperator, TransposedAddsToWhatIsThere) {
  const BlurOperator blur = makeOperator(turningMotion());
  const cv::Mat1f y = test::randomImage(blur.observedSize(), 2);
  cv::Mat1f once(blur.grid().size, 0.0F);
  blur.addTransposed(y, once);
  cv::Mat1f more(blur.grid().size, 7.0F);
  blur.addTransposed(y, more);
  EXPECT_LT(cv::norm(more - 7.0F, once, cv::NORM_INF), 1e-3);
}

TEST(BlurOperator, KeepsTheMean) {
  const BlurOperator blur = makeOperator(turningMotion());
  cv::Mat1f blurred;
  blur.apply(cv::Mat1f(blur.grid().size, 50.0F), blurred);
  const cv::Rect image(0, 0, kCamera.width, kCamera.height);
  EXPECT_EQ(cv::countNonZero(blur.seen()(image)), image.area());
  EXPECT_LT(cv::norm(blurred(image), cv::Mat1f(image.size(), 50.0F), cv::NORM_INF), 1e-3);
}

TEST(BlurOperator, KnowsWhatItLeavesOfNoise) {
  const BlurOperator blur = makeOperator(turningMotion());
  cv::Mat1f noise(blur.grid().size);
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::Mat1f blurred;
  blur.apply(noise, blurred);
  const double left = blurred.dot(blurred) / cv::countNonZero(blur.seen());
  EXPECT_NEAR(static_cast<double>(blur.noiseGain()), left, 0.15 * left);
  EXPECT_LT(left, 0.3);
}

TEST(BlurOperator, WithoutMotionNothingChanges) {
  const BlurOperator blur = makeOperator({SE3(), Vector6::Zero(), 0.02});
  const cv::Mat1f sharp = test::randomImage(blur.grid().size, 3);
  cv::Mat1f blurred;
  blur.apply(sharp, blurred);
  const cv::Rect image(0, 0, kCamera.width, kCamera.height);
  const cv::Point margin(blur.grid().margin, blur.grid().margin);
  EXPECT_LT(cv::norm(blurred(image), sharp(image + margin), cv::NORM_INF), 1e-3);
}

/// Against poses, cameras and an image in closed form, pixel by pixel.
TEST(BlurOperator, IsTheMeanAlongEachPixelsPath) {
  const ExposureTrajectory motion = turningMotion();
  const BlurOperator blur = makeOperator(motion);
  const int margin = blur.grid().margin;
  cv::Mat1f sharp(blur.grid().size);
  for (int y = 0; y < sharp.rows; ++y) {
    for (int x = 0; x < sharp.cols; ++x) {
      sharp(y, x) = smoothIntensity(static_cast<float>(x - margin), static_cast<float>(y - margin));
    }
  }
  cv::Mat1f blurred;
  blur.apply(sharp, blurred);
  const cv::Mat1f depth = slantedDepth(kCamera);
  double worst = 0.0;
  double longest = 0.0;
  for (int y = 3; y < kCamera.height; y += 7) {
    for (int x = 3; x < kCamera.width; x += 9) {
      constexpr int kSamples = 100;
      double sum = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        const SE3 T = motion.at(((i + 0.5) / kSamples - 0.5) * motion.exposure);
        const Eigen::Vector3d ray = T.rotationMatrix() * kCamera.unproject({x, y});
        const double plane = 1.0 / static_cast<double>(depth(y, x));
        const Eigen::Vector3d hit = T.translation() + (plane - T.translation().z()) / ray.z() * ray;
        const Eigen::Vector2f seen = kCamera.project(hit).cast<float>();
        sum += static_cast<double>(smoothIntensity(seen.x(), seen.y())) / kSamples;
        longest = std::max(longest, 2.0 * (seen - Eigen::Vector2f(x, y)).cast<double>().norm());
      }
      worst = std::max(worst, std::abs(sum - static_cast<double>(blurred(y, x))));
    }
  }
  EXPECT_GT(longest, 8.0);  // blurred, or it proves nothing
  EXPECT_LT(worst, 1.0);    // the pixels of a tile share a path; the unblurred image is off by some 30
}

/// The same as the kernel of the tracker, along the path at the middle of a tile.
TEST(BlurOperator, AgreesWithTheReblurringKernel) {
  const ExposureTrajectory motion = turningMotion();
  const BlurOperator blur = makeOperator(motion);
  const int margin = blur.grid().margin;
  ImageLevel level{cv::Mat1f(kCamera.height, kCamera.width), kCamera};
  cv::Mat1f sharp(blur.grid().size);
  for (int y = 0; y < sharp.rows; ++y) {
    for (int x = 0; x < sharp.cols; ++x) {
      sharp(y, x) = smoothIntensity(static_cast<float>(x - margin), static_cast<float>(y - margin));
    }
  }
  sharp(cv::Rect(margin, margin, kCamera.width, kCamera.height)).copyTo(level.intensity);
  cv::Mat1f blurred;
  blur.apply(sharp, blurred);
  PatchPath path;
  const Eigen::Vector2d centre(52, 36);
  ASSERT_TRUE(
      makePatchPath(kCamera, kCamera, motion, centre, static_cast<double>(slantedDepth(kCamera)(36, 52)), path));
  ReblurredPatch patch;
  reblurPatch(level, path, PatchPattern::square(1), 64, patch);
  EXPECT_NEAR(blurred(36, 52), patch.value[0], 0.7F);
}

TEST(BlurOperator, PixelsWhosePathLeavesTheGridAreNotSeen) {
  const BlurOperator blur({kCamera, kCamera, turningMotion()}, slantedDepth(kCamera),
                          BlurOperator::gridFor(kCamera, -BlurOperator::kTile));
  EXPECT_EQ(blur.seen()(0, 0), 0.0F);
  EXPECT_EQ(blur.seen()(37, 50), 1.0F);
  cv::Mat1f blurred;
  blur.apply(cv::Mat1f(blur.grid().size, 50.0F), blurred);
  EXPECT_EQ(blurred(0, 0), 0.0F);
}

/// With a rolling shutter the sharp image's rows are read one after the other, too. The camera turns about its x axis
/// so that a row sees what was ever higher up in the sharp image: the sharp row y' < y, read (y - y') row_time earlier,
/// shows at y' what it saw then, y - y' = speed (t + (y - y') row_time). The path is longer than with a global shutter.
TEST(BlurOperator, FollowsTheRowsOfARollingShutter) {
  PinholeCamera camera{64, 240, 400.0, 400.0, 31.5, 119.5};
  camera.row_time = 3e-5;
  ExposureTrajectory motion;
  motion.exposure = 0.02;
  motion.velocity(3) = 2.0;
  const BlurOperator blur({camera, camera, motion, motion.velocity}, cv::Mat1f(240, 64, 0.5F),
                          BlurOperator::gridFor(camera, 20));
  cv::Mat1f sharp(blur.grid().size);
  for (int y = 0; y < sharp.rows; ++y) {
    const auto row = static_cast<float>(y - blur.grid().margin);
    sharp.row(y).setTo(row *
                       row);  // the mean over a path exceeds the middle's value by a twelfth of its squared length
  }
  cv::Mat1f blurred;
  blur.apply(sharp, blurred);
  const int row = 119;
  const double excess = static_cast<double>(blurred(row, 31)) - static_cast<double>(row * row);
  const double speed = camera.fy * motion.velocity(3);  // [px/s]
  const double global = speed * motion.exposure;
  const double rolling = global / (1.0 - speed * camera.row_time);
  EXPECT_NEAR(excess, rolling * rolling / 12.0, 0.3);
  EXPECT_GT(rolling * rolling / 12.0, global * global / 12.0 + 0.9);
}

}  // namespace
}  // namespace mba_vo::blur_operator_test
