#include "mba_vo/mapping/initial_vignette.h"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::initial_vignette_test {
namespace {

using Vignette = CalibrationCorrection::Vignette;

const Vignette kTruth(-0.35, -0.061, -0.014);  // a square fall to 65 % in the corners

/// A map with true depths and true poses, of frames around the reference whose brightness varies.
InitialMap makeMap(const Vignette& vignette) {
  const SimulatedFrame view = test::roomView(40);
  InitialMap map;
  map.reference = test::makeFrame(test::darkened(test::toFloat(view.sharp), vignette), view.mid_exposure_ns, 0.0);
  map.points = test::makeReference(view, test::toFloat(view.sharp), 400)->points;
  test::Random random(3);
  for (unsigned i = 0; i < 10; ++i) {
    const SE3 T_reference_frame = random.pose(0.1, 0.15);
    Vector6 velocity = random.tangent(0.3, 0.5);
    const auto seen = test::roomSimulator().renderExposure(
        test::constantVelocity(view.T_world_mid * T_reference_frame, velocity), 0.0, 0.02, i);
    const cv::Mat1f image = test::scaled(test::darkened(test::toFloat(seen.blurred), vignette), 0.9 + 0.02 * i);
    map.poses.push_back({test::makeFrame(image, view.mid_exposure_ns + i, 0.02), T_reference_frame});
  }
  return map;
}

/// Log of the light at a squared radius, that of the corners being 1.
double logLight(const Vignette& vignette, double q) { return vignette.dot(Vignette(q, q * q, q * q * q)); }

Vignette estimate(const InitialMap& map) {
  const CalibrationSystem system = linearizeInitialVignette(map, {});
  EXPECT_EQ(system.H.topRows<CalibrationCorrection::kGeometryDim>().norm(), 0.0) << "nothing of the geometry";
  Eigen::Matrix3d H = system.H.bottomRightCorner<3, 3>();
  H.diagonal().array() += 4.0;  // of a prior as the estimator's
  return -H.ldlt().solve(system.b.tail<3>());
}

TEST(InitialVignette, IsFoundByHowPointsDarken) {
  const Vignette found = estimate(makeMap(kTruth));
  for (const double q : {0.25, 0.5, 0.75}) {
    EXPECT_NEAR(logLight(found, q), logLight(kTruth, q), 0.04) << "at the squared radius " << q;
  }
}

TEST(InitialVignette, IsNoneWhereThereIsNone) {
  const Vignette found = estimate(makeMap(Vignette::Zero()));
  for (const double q : {0.25, 0.5, 0.75}) EXPECT_NEAR(logLight(found, q), 0.0, 0.04) << q;
}

TEST(InitialVignette, SaysNothingWithoutFrames) {
  InitialMap map = makeMap(kTruth);
  map.poses.clear();
  EXPECT_EQ(linearizeInitialVignette(map, {}).H.norm(), 0.0);
}

}  // namespace
}  // namespace mba_vo::initial_vignette_test
