#pragma once

#include <random>

#include <Eigen/Core>

#include "mba_vo/geometry/se3.h"

namespace mba_vo::test {

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  double normal(double sigma) { return std::normal_distribution<double>(0.0, sigma)(generator_); }
  Vector6 tangent(double translation, double rotation) {
    Vector6 xi;
    for (int i = 0; i < 3; ++i) xi(i) = uniform(-translation, translation);
    for (int i = 3; i < 6; ++i) xi(i) = uniform(-rotation, rotation);
    return xi;
  }
  Eigen::MatrixXd matrix(int rows, int cols) {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&](Eigen::Index, Eigen::Index) { return normal(1.0); });
  }
  SE3 pose(double translation, double rotation) { return SE3::exp(tangent(translation, rotation)); }

 private:
  std::mt19937 generator_;
};

}  // namespace mba_vo::test
