#include "mba_vo/evaluation/consistency.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "evaluation/synthetic_run.h"
#include "mba_vo/evaluation/true_motion.h"

namespace mba_vo::consistency_test {
namespace {

using testing::HasSubstr;

constexpr double kScale = 2.5;  // metres per unit of the odometry

/// Curved motion with turning axes for 6 s, 10 poses per second.
std::vector<PoseRecord> trueMotion() {
  std::vector<PoseRecord> poses;
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.1 * i;
    const Eigen::Vector3d position(std::cos(t), 0.7 * std::sin(1.3 * t), 0.2 * t);
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(0.8 * t, Eigen::Vector3d(std::sin(t), 1.0, 0.3).normalized()));
    poses.push_back({100.0 + t, SE3(rotation, position), std::nullopt, 0});
  }
  return poses;
}

/// Of the right increment [m, rad]: correlated, and very different along the axes.
Matrix6 covarianceInMetres() {
  Matrix6 A = Matrix6::Zero();
  A.diagonal() << 0.02, 0.003, 0.008, 0.001, 0.006, 0.002;
  A(1, 0) = 0.002;
  A(4, 0) = -0.004;
  A(5, 2) = 0.0015;
  return A * A.transpose();
}

Matrix6 inUnits(Matrix6 P) {
  P.topRows<3>() /= kScale;
  P.leftCols<3>() /= kScale;
  return P;
}

Vector6 sample(const Matrix6& P, std::mt19937& generator) {
  std::normal_distribution<double> normal(0.0, 1.0);
  Vector6 z;
  for (int k = 0; k < 6; ++k) {
    z(k) = normal(generator);
  }
  return P.llt().matrixL() * z;
}

std::vector<OnlineFrame> framesWith(const Matrix6& P, const std::vector<PoseRecord>& poses) {
  std::vector<OnlineFrame> frames;
  for (const PoseRecord& pose : poses) {
    frames.push_back({pose.time, pose.time, pose.time, OnlineStatus::kTracking, P});
  }
  return frames;
}

/// Mean over many runs whose pose 5 s after the first is wrong by a sample of the covariance.
NeesSample meanOverRuns(const Matrix6& published, const Matrix6& real) {
  constexpr int kRuns = 600;
  const std::vector<PoseRecord> truth = trueMotion();
  std::mt19937 generator(11);
  NeesSample mean;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<PoseRecord> odometry = truth;
    SE3& T = odometry[50].T_world_camera;
    T = T * SE3::exp(sample(real, generator)).inverse();  // truth = published Exp(delta)
    odometry = inOtherCoordinates(odometry, kScale);
    const Consistency c = measureConsistency(truth, odometry, framesWith(published, odometry), {{5.0}, true});
    EXPECT_NEAR(c.scale, kScale, 1e-9);
    const NeesSample& s = c.samples.at(0);
    mean.total += s.total / kRuns;
    mean.translation += s.translation / kRuns;
    mean.rotation += s.rotation / kRuns;
    mean.position_error += s.position_error / kRuns;
  }
  return mean;
}

TEST(Consistency, NeesIsOneForTheRightCovariance) {
  const NeesSample mean = meanOverRuns(inUnits(covarianceInMetres()), covarianceInMetres());
  EXPECT_NEAR(mean.total, 1.0, 0.1);  // standard deviation of the mean: sqrt(2 / 6 / 600) = 0.024
  EXPECT_NEAR(mean.translation, 1.0, 0.13);
  EXPECT_NEAR(mean.rotation, 1.0, 0.13);
}

TEST(Consistency, PromisesThatAreTooGoodShow) {
  const NeesSample mean = meanOverRuns(inUnits(covarianceInMetres()) / 9.0, covarianceInMetres());
  EXPECT_NEAR(mean.total, 9.0, 0.9);
  const NeesSample timid = meanOverRuns(4.0 * inUnits(covarianceInMetres()), covarianceInMetres());
  EXPECT_NEAR(timid.total, 0.25, 0.03);
}

TEST(Consistency, AnErrorOfOneSigmaPerAxisIsOnePerDegreeOfFreedom) {
  const std::vector<PoseRecord> truth = trueMotion();
  std::vector<PoseRecord> odometry = truth;
  Vector6 delta;
  delta << 0.01, 0.02, 0.03, 0.001, 0.002, 0.003;
  const Matrix6 P = delta.array().square().matrix().asDiagonal();
  odometry[50].T_world_camera = odometry[50].T_world_camera * SE3::exp(delta).inverse();
  odometry = inOtherCoordinates(odometry, kScale);
  const Consistency c = measureConsistency(truth, odometry, framesWith(inUnits(P), odometry), {{5.0}, true});
  EXPECT_NEAR(c.samples[0].total, 1.0, 1e-6);
  EXPECT_NEAR(c.samples[0].translation, 1.0, 1e-6);
  EXPECT_NEAR(c.samples[0].rotation, 1.0, 1e-6);
  EXPECT_NEAR(c.samples[0].position_error, delta.head<3>().norm(), 1e-4);
  EXPECT_NEAR(c.samples[0].position_sigma, delta.head<3>().norm(), 1e-9);
  EXPECT_NEAR(c.samples[0].rotation_error, delta.tail<3>().norm() * 180.0 / M_PI, 1e-6);
}

TEST(Consistency, MetricOdometryHasNoScaleToFit) {
  const std::vector<PoseRecord> truth = trueMotion();
  const std::vector<PoseRecord> odometry = inOtherCoordinates(truth, 1.02);  // 2 % too short
  const auto frames = framesWith(covarianceInMetres(), odometry);
  EXPECT_LT(measureConsistency(truth, odometry, frames, {{5.0}, true}).samples[0].position_error, 1e-6);
  const Consistency metric = measureConsistency(truth, odometry, frames, {{5.0}, false});
  EXPECT_EQ(metric.scale, 1.0);
  EXPECT_GT(metric.samples[0].position_error, 0.01);
}

TEST(Consistency, MapsAreNotMixed) {
  const std::vector<PoseRecord> truth = trueMotion();
  std::vector<PoseRecord> odometry = inOtherCoordinates(truth, kScale);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    odometry[i].map = i < 20 ? 1 : 2;
    if (i < 20) {  // of another scale
      const SE3 T = odometry[i].T_world_camera;
      odometry[i].T_world_camera = SE3(T.rotation(), 7.0 * T.translation());
    }
  }
  const Consistency c =
      measureConsistency(truth, odometry, framesWith(covarianceInMetres(), odometry), {{1.0, 3.0, 5.0}, true});
  EXPECT_EQ(c.map, 2);
  EXPECT_FALSE(c.first_map);
  EXPECT_NEAR(c.scale, kScale, 1e-9);
  EXPECT_LT(c.samples[0].position_error, 1e-9);
  EXPECT_LT(c.samples[1].position_error, 1e-9);
  EXPECT_THAT(c.samples[2].unavailable, HasSubstr("no pose"));  // map 2 lasts 4 s
}

TEST(Consistency, WhatCannotBeToldHasAReason) {
  const std::vector<PoseRecord> truth = trueMotion();
  const Matrix6 P = covarianceInMetres();
  const auto reason = [&](const std::vector<PoseRecord>& poses, const std::vector<OnlineFrame>& frames) {
    const Consistency c = measureConsistency(truth, poses, frames, {{5.0}, true});
    EXPECT_TRUE(std::isnan(c.samples.at(0).total));
    return c.samples.at(0).unavailable;
  };
  EXPECT_THAT(reason({}, {}), HasSubstr("no pose"));
  EXPECT_THAT(reason(truth, {}), HasSubstr("without covariance"));
  EXPECT_THAT(reason(truth, framesWith(Matrix6::Zero(), truth)), HasSubstr("not positive definite"));
  std::vector<PoseRecord> still = truth;
  for (PoseRecord& pose : still) {
    pose.T_world_camera = SE3();
  }
  EXPECT_THAT(reason(still, framesWith(P, still)), HasSubstr("no scale"));
  std::vector<PoseRecord> early = truth;
  early[0].time -= 50.0;
  EXPECT_THAT(reason(early, framesWith(P, early)), HasSubstr("no true pose"));
}

TEST(TrueMotion, InterpolatesBetweenCloseNeighboursOnly) {
  std::vector<PoseRecord> truth{{1.0, SE3(), std::nullopt, 0}, {1.1, SE3(), std::nullopt, 0}};
  truth[1].T_world_camera = SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())), {0, 0, 2});
  const SE3 half = truePoseAt(truth, 1.05).value();
  EXPECT_NEAR(half.rotation().angularDistance(Eigen::Quaterniond::Identity()), 0.2, 1e-9);
  EXPECT_NEAR(half.translation().z(), 1.0, 1e-9);
  EXPECT_NEAR(truePoseAt(truth, 1.1000004).value().translation().z(), 2.0, 1e-12);
  EXPECT_FALSE(truePoseAt(truth, 0.9).has_value());
  EXPECT_FALSE(truePoseAt(truth, 1.2).has_value());
  truth[1].time = 1.3;
  EXPECT_FALSE(truePoseAt(truth, 1.15).has_value());
}

TEST(TrueMotion, TellsWhenTheCameraHasMoved) {
  std::vector<PoseRecord> truth;
  for (int i = 0; i < 20; ++i) {
    truth.push_back({0.1 * i, SE3(Eigen::Quaterniond::Identity(), {0.5 * i, 0, 0}), std::nullopt, 0});
  }
  EXPECT_NEAR(timeOfDistance(truth, 0.0, 0.9).value(), 0.2, 1e-9);
  EXPECT_NEAR(timeOfDistance(truth, 0.25, 0.9).value(), 0.5, 1e-9);  // from half way between two poses
  EXPECT_NEAR(timeOfDistance(truth, -3.0, 0.9).value(), 0.2, 1e-9);
  EXPECT_FALSE(timeOfDistance(truth, 0.0, 100.0).has_value());
}

}  // namespace
}  // namespace mba_vo::consistency_test
