#include "mba_vo/deblur/half_quadratic_solver.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::half_quadratic_solver_test {
namespace {

const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};

BlurOperator makeOperator(double angle) {
  ExposureTrajectory motion;
  motion.exposure = 0.02;
  motion.velocity(4) = angle / motion.exposure;
  return {{kCamera, kCamera, motion}, cv::Mat1f(48, 64, 0.5F), BlurOperator::gridFor(kCamera, 12)};
}

/// Bright boxes on dark ground.
cv::Mat1f boxes(const LatentGrid& grid) {
  cv::Mat1f image(grid.size, 40.0F);
  for (int i = 0; i < 5; ++i) image(cv::Rect(grid.margin + 5 + 11 * i, grid.margin + 6 + 5 * i, 6, 9)).setTo(180.0F);
  return image;
}

double energy(const BlurredObservation& o, const HalfQuadraticConfig& config, const cv::Mat1f& latent) {
  cv::Mat1f difference;
  o.blur->apply(latent, difference);
  difference -= o.image;
  double sum = 0.5 * difference.mul(o.weight).dot(difference);
  for (int y = 0; y < latent.rows; ++y) {
    for (int x = 0; x + 1 < latent.cols; ++x) {
      const float gx = latent(y, x + 1) - latent(y, x);
      const float gy = y + 1 < latent.rows ? latent(y + 1, x) - latent(y, x) : 0.0F;
      sum += static_cast<double>(config.prior_weight * std::hypot(gx, gy));
    }
  }
  return sum;
}

TEST(HalfQuadraticSolver, FindsTheSharpImage) {
  const BlurOperator blur = makeOperator(0.12);
  const cv::Mat1f truth = boxes(blur.grid());
  BlurredObservation observation{&blur, {}, cv::Mat1f(blur.observedSize(), 4.0F)};
  blur.apply(truth, observation.image);
  cv::Mat1f latent(truth.size(), 80.0F);
  HalfQuadraticConfig config;
  config.prior_weight = 0.05F;
  config.iterations = 20;
  solveHalfQuadratic({observation}, config, latent);
  const cv::Rect image(blur.grid().margin, blur.grid().margin, kCamera.width, kCamera.height);
  const double rms = cv::norm(latent(image), truth(image)) / std::sqrt(static_cast<double>(image.area()));
  const double before = cv::norm(observation.image(cv::Rect({0, 0}, image.size())), truth(image)) /
                        std::sqrt(static_cast<double>(image.area()));
  EXPECT_GT(before, 15.0);
  EXPECT_LT(rms, 0.3 * before);
}

/// No small change of the result has a lower energy: neither a single pixel nor a change of the whole.
TEST(HalfQuadraticSolver, ComesNearTheMinimum) {
  const BlurOperator blur = makeOperator(0.08);
  const cv::Mat1f truth = boxes(blur.grid());
  BlurredObservation observation{&blur, {}, blur.seen()};
  blur.apply(truth, observation.image);
  cv::RNG rng(1);
  cv::Mat1f noise(observation.image.size());
  rng.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  observation.image += noise;
  HalfQuadraticConfig config;
  config.steps = 14;
  config.coupling_factor = 1.6F;
  config.iterations = 30;
  cv::Mat1f latent(truth.size(), 80.0F);
  solveHalfQuadratic({observation}, config, latent);
  const double reached = energy(observation, config, latent);
  EXPECT_LT(reached, energy(observation, config, truth));
  for (const double factor : {0.99, 1.01}) {
    EXPECT_LT(reached, energy(observation, config, cv::Mat1f(latent * factor)));
  }
  cv::Mat1f smoother = latent.clone();
  smoother(cv::Rect(1, 1, smoother.cols - 2, smoother.rows - 2)) *= 0.9;
  EXPECT_LT(reached, energy(observation, config, smoother));
}

TEST(HalfQuadraticSolver, PixelsWithoutWeightHaveNoInfluence) {
  const BlurOperator blur = makeOperator(0.08);
  const cv::Mat1f truth = boxes(blur.grid());
  BlurredObservation observation{&blur, {}, blur.seen().clone()};
  blur.apply(truth, observation.image);
  const cv::Rect spoilt(20, 20, 5, 4);
  observation.weight(spoilt).setTo(0.0F);
  cv::Mat1f first(truth.size(), 80.0F);
  solveHalfQuadratic({observation}, {}, first);
  observation.image(spoilt).setTo(1e4F);
  cv::Mat1f second(truth.size(), 80.0F);
  solveHalfQuadratic({observation}, {}, second);
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0.0);
}

/// Two images smeared in different directions tell more than one.
TEST(HalfQuadraticSolver, TakesSeveralObservations) {
  const BlurOperator across = makeOperator(0.12);
  ExposureTrajectory down;
  down.exposure = 0.02;
  down.velocity(3) = 0.12 / down.exposure;
  const BlurOperator along({kCamera, kCamera, down}, cv::Mat1f(48, 64, 0.5F), across.grid());
  const cv::Mat1f truth = boxes(across.grid());
  cv::RNG rng(3);
  std::vector<BlurredObservation> both;
  for (const BlurOperator* blur : {&across, &along}) {
    BlurredObservation o{blur, {}, blur->seen()};
    blur->apply(truth, o.image);
    cv::Mat1f noise(o.image.size());
    rng.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    o.image += noise;
    both.push_back(o);
  }
  cv::Mat1f one(truth.size(), 80.0F);
  solveHalfQuadratic({both.front()}, {}, one);
  cv::Mat1f two(truth.size(), 80.0F);
  solveHalfQuadratic(both, {}, two);
  const cv::Rect image(across.grid().margin, across.grid().margin, kCamera.width, kCamera.height);
  EXPECT_LT(cv::norm(two(image), truth(image)), 0.7 * cv::norm(one(image), truth(image)));
}

}  // namespace
}  // namespace mba_vo::half_quadratic_solver_test
