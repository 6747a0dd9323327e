#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "depth_search/depth_statistics.h"
#include "depth_search/textured_wall_scene.h"
#include "mba_vo/depth_search/depth_search.h"
#include "mba_vo/image/point_selector.h"

namespace mba_vo::lacking_vignette_test {
namespace {

using test::DepthStatistics;
using test::evaluateDepths;
using test::PlaneScene;
using test::WaveTexture;

const PinholeCamera kCamera{320, 240, 220.0, 220.0, 159.5, 119.5};
constexpr double kNoise = 1.0;  // [grey levels]

/// Frame `i` of a camera that moves away from the host, shaken by `blur`.
ExposureTrajectory receding(int i, double blur) {
  Vector6 motion, shaking;
  motion << 0.03, 0.008, i % 2 == 0 ? 0.01 : -0.01, 0.006, -0.012, 0.01;
  shaking << 0.02, 0.01, 0.005, 0.025, -0.03, 0.02;
  return {SE3::exp(i * motion), blur / 0.02 * shaking, 0.02};
}

TEST(DepthSearch, KnowsWhatImagesLackOfTheVignette) {
  const PlaneScene scene{kCamera, {{{0.1, 0.03, 0.5}, WaveTexture(1)}}};  // a slanted wall
  const ImagePyramid host = scene.render({}, 1, kNoise, 10);
  CalibrationCorrection lacking;
  lacking.values.tail<3>() << -1.0, 0.0, 0.0;  // far more than a lens has, to count in a single frame
  const auto search = [&](double blur, const VignetteRatio& vignette) {
    std::vector<ImmaturePoint> points;
    for (const Eigen::Vector2i& pixel : selectPoints(host, 600, {}))
      points.push_back(makeImmaturePoint(host, pixel, {}));
    for (int i = 1; i <= 4; ++i) {
      const ExposureTrajectory T_host = receding(i, blur);
      cv::Mat1f image = scene.render(T_host, 8, kNoise, 11).level(0).intensity;
      for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
          image(y, x) *= static_cast<float>(std::exp(lacking.vignette().dot(vignetteJacobian(kCamera, {x, y}))));
        }
      }
      const ImagePyramid frame(image, kCamera, 1);
      const DepthSearcher searcher(host, frame, T_host, 1.0, 0.0, {}, {}, vignette);
      for (ImmaturePoint& point : points) searcher.search(point);
    }
    return evaluateDepths(scene, points, 0.02);
  };
  for (const double blur : {0.0, 1.0}) {
    const DepthStatistics known = search(blur, VignetteRatio(kCamera, {}, kCamera, lacking));
    const DepthStatistics unknown = search(blur, {});
    EXPECT_GT(known.good, 300) << "blur " << blur;
    EXPECT_GT(known.accurate, 0.85) << "blur " << blur;
    EXPECT_LT(unknown.good * unknown.accurate, 0.7 * known.good * known.accurate) << "blur " << blur;
  }
}

}  // namespace
}  // namespace mba_vo::lacking_vignette_test
