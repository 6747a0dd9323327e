#include "mba_vo/window/keyframe_image_error.h"

#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "window/planar_scene.h"

namespace mba_vo::keyframe_image_error_test {
namespace {

/// Two sharp keyframes of the analytic scene at their true poses.
struct Views {
  PinholeCamera camera = test::smallCamera();
  test::PlanarScene scene = test::PlanarScene::corner(0.4);
  SE3 T_0_1 = SE3::exp((Vector6() << 0.05, 0.03, 0.01, 0.02, -0.03, 0.01).finished());
  cv::Mat1f image = scene.render(camera, SE3());
  WindowLinearizer linearizer{ResidualOptions(), true};

  WindowState state() const {
    WindowState state;
    for (const SE3& T_map_keyframe : {SE3(), T_0_1}) {
      KeyframeState keyframe;
      keyframe.id = static_cast<KeyframeId>(state.size());
      keyframe.sharp = keyframe.original = test::pyramidOf(scene.render(camera, T_map_keyframe), camera);
      keyframe.T_linear = T_map_keyframe;
      keyframe.outlier_energy = std::numeric_limits<double>::infinity();
      state.keyframes.push_back(keyframe);
    }
    return state;
  }

  std::vector<ReferencePoint> points(int step) const {
    std::vector<ReferencePoint> points;
    for (int y = 20; y < camera.height - 20; y += step) {
      for (int x = 20; x < camera.width - 20; x += step) {
        const double inverse_depth = scene.inverseDepth(camera, SE3(), {x, y});
        points.push_back({Eigen::Vector2f(x, y), static_cast<float>(inverse_depth), 0.0F});
      }
    }
    return points;
  }

  /// The first image as if its camera had looked elsewhere [px].
  std::shared_ptr<const ImagePyramid> shifted(double x_px, double y_px) const {
    cv::Mat1f moved;
    const cv::Matx23d move(1.0, 0.0, x_px, 0.0, 1.0, y_px);
    cv::warpAffine(image, moved, move, image.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return test::pyramidOf(moved, camera);
  }
};

TEST(KeyframeImageError, IsTheShiftOfTheImage) {
  const Views views;
  for (const double px : {0.25, 0.5}) {
    for (const auto& sharp : {views.shifted(px, 0.0), views.shifted(0.0, px)}) {
      const auto error = compareHostImages(views.state(), 0, sharp, views.points(10), views.linearizer);
      ASSERT_TRUE(error);
      EXPECT_LT(error->with_own_image, 0.05) << "the truth";
      EXPECT_NEAR(error->with_sharp_image, px, 0.4 * px);
    }
  }
}

TEST(KeyframeImageError, OfTheSameImageIsTheSame) {
  const Views views;
  const WindowState state = views.state();
  const auto error = compareHostImages(state, 1, state.keyframe(1).sharp, views.points(10), views.linearizer);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->with_sharp_image, error->with_own_image);
}

TEST(KeyframeImageError, IsUnknownWithoutPointsOrOtherKeyframes) {
  const Views views;
  WindowState state = views.state();
  const auto sharp = state.keyframe(0).sharp;
  EXPECT_FALSE(compareHostImages(state, 0, sharp, views.points(60), views.linearizer));
  state.keyframes.pop_back();
  EXPECT_FALSE(compareHostImages(state, 0, sharp, views.points(10), views.linearizer));
}

}  // namespace
}  // namespace mba_vo::keyframe_image_error_test
