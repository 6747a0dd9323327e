#include "mba_vo/deblur/alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr float kLeastInformation = 1e-3F;  // of a flat block, in place of none [grey levels^2 / px^2]
constexpr int kFewestPixels = 60;           // of a block
constexpr float kKnown = 0.25F;             // standard deviation of a shift up to which it is known [px]
constexpr float kBest = 0.1F;     // standard deviation that no block falls below: its surfaces are not all alike [px]
constexpr float kChange = 0.15F;  // standard deviation of the difference between blocks side by side [px]
constexpr float kShift = 1.0F;    // and of a shift, before anything is known [px]
constexpr int kSweeps = 40;       // of Gauss and Seidel

struct Images {
  const cv::Mat1f& predicted;
  const cv::Mat1f& observed;
  const cv::Mat1f& weight;
};

/// The prediction's own noise has gradients, too, that tell nothing: half its variance, which is half the residual's.
Eigen::Matrix2f covarianceOf(const Eigen::Matrix3f& H, float variance, int count) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> shift(H.inverse().topLeftCorner<2, 2>());
  const float noise = 0.25F * variance * static_cast<float>(count);
  const Eigen::Array2f information = (shift.eigenvalues().array().inverse() - noise).max(kLeastInformation);
  return shift.eigenvectors() * (variance / information).matrix().asDiagonal() * shift.eigenvectors().transpose();
}

/// Shift [px] and a brightness offset that is not of interest, together.
BlockShift shiftOf(const Images& images, const cv::Rect& block) {
  Eigen::Matrix3f H = Eigen::Matrix3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  float squares = 0.0F;
  int count = 0;
  const cv::Mat1f& p = images.predicted;
  const cv::Mat1f& w = images.weight;
  for (int y = std::max(1, block.y); y < std::min(block.br().y, p.rows - 1); ++y) {
    for (int x = std::max(1, block.x); x < std::min(block.br().x, p.cols - 1); ++x) {
      if (w(y, x) * w(y, x - 1) * w(y, x + 1) * w(y - 1, x) * w(y + 1, x) <= 0.0F) continue;
      const Eigen::Vector3f J(0.5F * (p(y, x + 1) - p(y, x - 1)), 0.5F * (p(y + 1, x) - p(y - 1, x)), 1.0F);
      const float difference = images.observed(y, x) - p(y, x);
      H += J * J.transpose();
      b += difference * J;
      squares += difference * difference;
      ++count;
    }
  }
  if (count < kFewestPixels) return {};
  H(0, 0) += kLeastInformation;
  H(1, 1) += kLeastInformation;
  const Eigen::Vector3f solution = H.ldlt().solve(b);
  if (!solution.allFinite()) return {};
  const float variance = std::max(0.0F, squares - solution.dot(b)) / static_cast<float>(count);
  return {solution.head<2>(), covarianceOf(H, variance, count), true};
}

}  // namespace

std::vector<float> Alignment::knownShifts() const {
  std::vector<float> lengths;
  for (const BlockShift& block : blocks) {
    if (block.told && block.covariance.trace() < kKnown * kKnown) lengths.push_back(block.shift.norm());
  }
  return lengths;
}

Alignment measureAlignment(const cv::Mat1f& predicted, const cv::Mat1f& observed, const cv::Mat1f& weight) {
  constexpr int kBlock = Alignment::kBlock;
  Alignment result;
  result.columns = (predicted.cols + kBlock - 1) / kBlock;
  result.rows = (predicted.rows + kBlock - 1) / kBlock;
  result.blocks.reserve(static_cast<std::size_t>(result.columns * result.rows));
  for (int r = 0; r < result.rows; ++r) {
    for (int c = 0; c < result.columns; ++c) {
      result.blocks.push_back(shiftOf({predicted, observed, weight}, {kBlock * c, kBlock * r, kBlock, kBlock}));
    }
  }
  return result;
}

cv::Mat2f smoothShifts(const Alignment& alignment) {
  cv::Mat2f field(alignment.rows, alignment.columns, cv::Vec2f(0.0F, 0.0F));
  constexpr float kTie = 1.0F / (kChange * kChange);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int r = 0; r < field.rows; ++r) {
      for (int c = 0; c < field.cols; ++c) {
        const BlockShift& block = alignment.blocks[static_cast<std::size_t>(r * field.cols + c)];
        Eigen::Matrix2f H = Eigen::Matrix2f::Identity() / (kShift * kShift);
        Eigen::Vector2f b = Eigen::Vector2f::Zero();
        if (block.told) {
          const Eigen::Matrix2f information =
              (block.covariance + kBest * kBest * Eigen::Matrix2f::Identity()).inverse();
          H += information;
          b += information * block.shift;
        }
        for (const cv::Point& side :
             {cv::Point(c - 1, r), cv::Point(c + 1, r), cv::Point(c, r - 1), cv::Point(c, r + 1)}) {
          if (side.x < 0 || side.y < 0 || side.x >= field.cols || side.y >= field.rows) continue;
          H += kTie * Eigen::Matrix2f::Identity();
          b += kTie * Eigen::Vector2f(field(side)[0], field(side)[1]);
        }
        const Eigen::Vector2f shift = H.inverse() * b;
        field(r, c) = {shift.x(), shift.y()};
      }
    }
  }
  return field;
}

}  // namespace mba_vo
