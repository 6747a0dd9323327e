#include "mba_vo/evaluation/evaluator.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "evaluation/exposure_about.h"
#include "io/temporary_folder.h"

namespace mba_vo::evaluator_test {
namespace {

using testing::HasSubstr;

/// Curved motion with turning axes, 10 poses per second.
std::vector<PoseRecord> curvedTrajectory(int count) {
  std::vector<PoseRecord> poses;
  for (int i = 0; i < count; ++i) {
    const double t = 0.1 * i;
    const Eigen::Vector3d position(std::cos(t), 0.7 * std::sin(1.3 * t), 0.2 * t);
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(0.8 * t, Eigen::Vector3d(std::sin(t), 1.0, 0.3).normalized()));
    poses.push_back({100.0 + t, SE3(rotation, position), std::nullopt, 0});
  }
  return poses;
}

/// The trajectory in other coordinates and units, with noise.
std::vector<PoseRecord> disturbed(const std::vector<PoseRecord>& poses, double scale, double noise) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  const SE3 motion(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, -1).normalized())), {3, -1, 2});
  std::vector<PoseRecord> result = poses;
  for (PoseRecord& pose : result) {
    Vector6 error;
    for (int k = 0; k < 6; ++k) {
      error(k) = noise * normal(generator);
    }
    const SE3 T = motion * (pose.T_world_camera * SE3::exp(error));
    pose.T_world_camera = SE3(T.rotation(), scale * T.translation());
  }
  return result;
}

/// Independent reference: Horn's closed form with unit quaternions (1987), which shares no step with Umeyama's SVD.
struct HornResult {
  double scale = 1.0;
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
};

HornResult horn(const std::vector<PoseRecord>& estimate, const std::vector<PoseRecord>& truth, bool with_scale) {
  Eigen::Vector3d mean_e = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_t = Eigen::Vector3d::Zero();
  const auto n = static_cast<double>(estimate.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    mean_e += estimate[i].T_world_camera.translation() / n;
    mean_t += truth[i].T_world_camera.translation() / n;
  }
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Vector3d e = estimate[i].T_world_camera.translation() - mean_e;
    S += e * (truth[i].T_world_camera.translation() - mean_t).transpose();
    squares += e.squaredNorm();
  }
  Eigen::Matrix4d N;
  N << S.trace(), S(1, 2) - S(2, 1), S(2, 0) - S(0, 2), S(0, 1) - S(1, 0),                   //
      S(1, 2) - S(2, 1), S(0, 0) - S(1, 1) - S(2, 2), S(0, 1) + S(1, 0), S(2, 0) + S(0, 2),  //
      S(2, 0) - S(0, 2), S(0, 1) + S(1, 0), S(1, 1) - S(0, 0) - S(2, 2), S(1, 2) + S(2, 1),  //
      S(0, 1) - S(1, 0), S(2, 0) + S(0, 2), S(1, 2) + S(2, 1), S(2, 2) - S(0, 0) - S(1, 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(N);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  HornResult result;
  result.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix();
  result.scale = with_scale ? (result.R * S).trace() / squares : 1.0;
  result.t = mean_t - result.scale * result.R * mean_e;
  return result;
}

struct ExpectedFigures {
  double ate_rmse = 0.0;
  double ate_median = 0.0;
  double ate_max = 0.0;
  double rotation_rmse = 0.0;  // [deg]
  double rpe_rmse = 0.0;
};

double angleOf(const Eigen::Matrix3d& R) { return std::acos(std::min(1.0, 0.5 * (R.trace() - 1.0))) * 180.0 / M_PI; }

/// All figures by matrices from Horn's alignment; `steps` poses make the interval of the relative error.
ExpectedFigures expectedFigures(const std::vector<PoseRecord>& estimate, const std::vector<PoseRecord>& truth,
                                const HornResult& alignment, std::size_t steps) {
  const auto aligned = [&](std::size_t i) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = alignment.R * estimate[i].T_world_camera.rotationMatrix();
    T.topRightCorner<3, 1>() = alignment.scale * alignment.R * estimate[i].T_world_camera.translation() + alignment.t;
    return T;
  };
  const auto real = [&](std::size_t i) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = truth[i].T_world_camera.rotationMatrix();
    T.topRightCorner<3, 1>() = truth[i].T_world_camera.translation();
    return T;
  };
  const std::size_t n = estimate.size();
  std::vector<double> errors;
  ExpectedFigures figures;
  for (std::size_t i = 0; i < n; ++i) {
    errors.push_back((aligned(i) - real(i)).topRightCorner<3, 1>().norm());
    figures.ate_rmse += errors.back() * errors.back() / static_cast<double>(n);
    const double angle = angleOf(real(i).topLeftCorner<3, 3>().transpose() * aligned(i).topLeftCorner<3, 3>());
    figures.rotation_rmse += angle * angle / static_cast<double>(n);
  }
  for (std::size_t i = 0; i + steps < n; ++i) {
    const Eigen::Matrix4d E =
        (real(i).inverse() * real(i + steps)).inverse() * (aligned(i).inverse() * aligned(i + steps));
    figures.rpe_rmse += E.topRightCorner<3, 1>().squaredNorm() / static_cast<double>(n - steps);
  }
  std::sort(errors.begin(), errors.end());
  figures.ate_median = n % 2 == 1 ? errors[n / 2] : 0.5 * (errors[n / 2 - 1] + errors[n / 2]);
  figures.ate_max = errors.back();
  figures.ate_rmse = std::sqrt(figures.ate_rmse);
  figures.rotation_rmse = std::sqrt(figures.rotation_rmse);
  figures.rpe_rmse = std::sqrt(figures.rpe_rmse);
  return figures;
}

class AgainstHorn : public testing::TestWithParam<AlignmentMode> {};

TEST_P(AgainstHorn, AllFiguresAgree) {
  const auto truth = curvedTrajectory(80);
  const auto estimate = disturbed(truth, 0.37, 0.03);
  EvaluationOptions options;
  options.alignment = GetParam();
  options.relative_interval = 0.5;
  const EvaluationReport report = evaluateTrajectory(truth, estimate, {}, options);
  const HornResult alignment = horn(estimate, truth, GetParam() == AlignmentMode::kSim3);
  const ExpectedFigures expected = expectedFigures(estimate, truth, alignment, 5);
  EXPECT_GT(expected.ate_rmse, 0.01);
  EXPECT_NEAR(report.alignment.scale, alignment.scale, 1e-6);
  EXPECT_NEAR(report.absolute.rmse, expected.ate_rmse, 1e-6);
  EXPECT_NEAR(report.absolute.median, expected.ate_median, 1e-6);
  EXPECT_NEAR(report.absolute.max, expected.ate_max, 1e-6);
  EXPECT_NEAR(report.rotation.rmse, expected.rotation_rmse, 1e-6);
  EXPECT_NEAR(report.relative_translation.rmse, expected.rpe_rmse, 1e-6);
  EXPECT_EQ(report.relative_translation.count, 75U);
}

INSTANTIATE_TEST_SUITE_P(Modes, AgainstHorn, testing::Values(AlignmentMode::kSim3, AlignmentMode::kSE3));

TEST(Evaluator, ScaleAndFrameOfReferenceDoNotMatterForSim3) {
  const auto truth = curvedTrajectory(40);
  const EvaluationReport report = evaluateTrajectory(truth, disturbed(truth, 0.25, 0.0), {}, {});
  EXPECT_NEAR(report.alignment.scale, 4.0, 1e-9);
  EXPECT_LT(report.absolute.max, 1e-9);
  EXPECT_LT(report.rotation.max, 1e-5);
  EXPECT_LT(report.relative_translation.max, 1e-9);
}

TEST(Evaluator, MotionlessEstimateScoresTheSpreadOfTheTruth) {
  const auto truth = curvedTrajectory(40);
  auto estimate = truth;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (PoseRecord& pose : estimate) {
    mean += pose.T_world_camera.translation() / 40.0;
    pose.T_world_camera = SE3();
  }
  double squares = 0.0;
  for (const PoseRecord& pose : truth) {
    squares += (pose.T_world_camera.translation() - mean).squaredNorm() / 40.0;
  }
  EXPECT_NEAR(evaluateTrajectory(truth, estimate, {}, {}).absolute.rmse, std::sqrt(squares), 1e-12);
}

TEST(Evaluator, CountsDropsBeforeAndAfterTheFirstPose) {
  const auto truth = curvedTrajectory(50);
  auto estimate = truth;
  estimate.erase(estimate.begin() + 20, estimate.begin() + 24);  // 4 lost on the way
  estimate.erase(estimate.begin(), estimate.begin() + 6);        // 6 before initialisation
  const EvaluationReport report = evaluateTrajectory(truth, estimate, {}, {});
  EXPECT_EQ(report.drops.frames, 50U);
  EXPECT_EQ(report.drops.dropped, 10U);
  EXPECT_EQ(report.drops.frames_after_initialization, 44U);
  EXPECT_EQ(report.drops.dropped_after_initialization, 4U);
}

TEST(Evaluator, FrameLogReplacesTheGroundTruthStamps) {
  const auto truth = curvedTrajectory(50);
  auto estimate = truth;
  estimate.erase(estimate.begin() + 30, estimate.end());
  std::vector<LoggedFrame> frames;
  for (int i = 0; i < 32; ++i) {  // the last two of them lost
    frames.push_back({truth[static_cast<std::size_t>(i)].time, i < 30 ? "TRACKING" : "LOST"});
  }
  const EvaluationReport report = evaluateTrajectory(truth, estimate, frames, {});
  EXPECT_EQ(report.drops.frames, 32U);
  EXPECT_EQ(report.drops.dropped, 2U);
  EXPECT_EQ(report.frames_by_status.at("LOST"), 2U);
}

TEST(Evaluator, OnlyTheLargestMapCounts) {
  const auto truth = curvedTrajectory(50);
  auto estimate = truth;
  for (std::size_t i = 40; i < 50; ++i) {
    estimate[i].map = 2;
    estimate[i].T_world_camera = SE3();
  }
  const EvaluationReport report = evaluateTrajectory(truth, estimate, {}, {});
  EXPECT_EQ(report.maps, 2U);
  EXPECT_EQ(report.poses_in_other_maps, 10U);
  EXPECT_EQ(report.drops.dropped_after_initialization, 10U);
  EXPECT_LT(report.absolute.max, 1e-9);
}

TEST(Evaluator, WhatComesAfterAnEarlierMapIsDropped) {
  const auto truth = curvedTrajectory(50);
  std::vector<PoseRecord> estimate(truth.begin() + 5, truth.begin() + 10);
  estimate.insert(estimate.end(), truth.begin() + 20, truth.end());
  for (std::size_t i = 5; i < estimate.size(); ++i) estimate[i].map = 2;
  std::vector<LoggedFrame> frames;
  for (const PoseRecord& pose : truth) frames.push_back({pose.time, "TRACKING"});
  for (const auto& log : {std::vector<LoggedFrame>(), frames}) {
    const EvaluationReport report = evaluateTrajectory(truth, estimate, log, {});
    EXPECT_EQ(report.map, 2);
    EXPECT_EQ(report.drops.dropped, 20U);
    EXPECT_EQ(report.drops.frames_after_initialization, 45U);
    EXPECT_EQ(report.drops.dropped_after_initialization, 15U);
  }
}

TEST(Evaluator, RefusesFilesThatDoNotOverlap) {
  const auto truth = curvedTrajectory(10);
  auto estimate = truth;
  for (PoseRecord& pose : estimate) {
    pose.time += 1000.0;
  }
  EXPECT_THAT(messageOf([&] { evaluateTrajectory(truth, estimate, {}, {}); }), HasSubstr("only 0 of 10"));
}

TEST(Evaluator, SummarisesTheMotionWithinTheExposure) {
  auto truth = curvedTrajectory(30);
  for (PoseRecord& pose : truth) {
    pose.exposure = exposureAbout(pose.T_world_camera, twist(0.02, 0, 0, 0, 0.01, 0));
  }
  auto estimate = truth;
  for (std::size_t i = 0; i < 3; ++i) {
    std::swap(estimate[i].exposure->T_world_start, estimate[i].exposure->T_world_end);
  }
  const EvaluationReport report = evaluateTrajectory(truth, estimate, {}, {});
  ASSERT_TRUE(report.exposure.has_value());
  EXPECT_EQ(report.exposure->direction.count, 30U);
  EXPECT_EQ(report.exposure->reversed, 3U);
  EXPECT_EQ(report.exposure->ends.count, 60U);
  EXPECT_LT(report.exposure->ends.median, 1e-9);
  EXPECT_NEAR(report.exposure->ends.max, 0.02, 1e-4) << "where they are swapped";
  EXPECT_NEAR(report.exposure->ends_rotation.max, 0.01 * 180.0 / M_PI, 1e-6);
  EXPECT_NEAR(report.exposure->direction.median, 0.0, 1e-5);
  EXPECT_NEAR(report.exposure->length_ratio.median, 1.0, 1e-9);
}

}  // namespace
}  // namespace mba_vo::evaluator_test
