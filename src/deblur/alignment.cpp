#include "mba_vo/deblur/alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr int kFewestPixels = 200;  // of a block
constexpr float kKnown = 0.25F;     // standard deviation of a shift up to which it tells [px]

struct Images {
  const cv::Mat1f& predicted;
  const cv::Mat1f& observed;
  const cv::Mat1f& weight;
};

/// Shift [px] and a brightness offset that is not of interest, together.
std::optional<Eigen::Vector2f> shiftOf(const Images& images, const cv::Rect& block) {
  Eigen::Matrix3f H = Eigen::Matrix3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  float squares = 0.0F;
  int count = 0;
  for (int y = std::max(1, block.y); y < std::min(block.br().y, images.predicted.rows - 1); ++y) {
    for (int x = std::max(1, block.x); x < std::min(block.br().x, images.predicted.cols - 1); ++x) {
      const cv::Mat1f& w = images.weight;
      if (w(y, x) * w(y, x - 1) * w(y, x + 1) * w(y - 1, x) * w(y + 1, x) <= 0.0F) continue;
      const cv::Mat1f& p = images.predicted;
      const Eigen::Vector3f J(0.5F * (p(y, x + 1) - p(y, x - 1)), 0.5F * (p(y + 1, x) - p(y - 1, x)), 1.0F);
      const float difference = images.observed(y, x) - p(y, x);
      H += J * J.transpose();
      b += difference * J;
      squares += difference * difference;
      ++count;
    }
  }
  if (count < kFewestPixels) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3f> ldlt(H);
  const Eigen::Vector3f solution = ldlt.solve(b);
  if (!solution.allFinite()) return std::nullopt;
  const float variance = std::max(0.0F, squares - solution.dot(b)) / static_cast<float>(count);
  const Eigen::Matrix2f covariance = variance * H.inverse().topLeftCorner<2, 2>();
  if (!(covariance.trace() < kKnown * kKnown)) return std::nullopt;
  return solution.head<2>();
}

}  // namespace

Alignment measureAlignment(const cv::Mat1f& predicted, const cv::Mat1f& observed, const cv::Mat1f& weight,
                           float limit_px) {
  constexpr int kBlock = Alignment::kBlock;
  Alignment result;
  result.misaligned =
      cv::Mat1b((predicted.rows + kBlock - 1) / kBlock, (predicted.cols + kBlock - 1) / kBlock, static_cast<uchar>(0));
  std::vector<float> shifts;
  for (int r = 0; r < result.misaligned.rows; ++r) {
    for (int c = 0; c < result.misaligned.cols; ++c) {
      const auto shift = shiftOf({predicted, observed, weight}, {kBlock * c, kBlock * r, kBlock, kBlock});
      if (!shift) continue;
      shifts.push_back(shift->norm());
      if (shift->norm() > limit_px) result.misaligned(r, c) = 255;
    }
  }
  result.blocks = static_cast<int>(shifts.size());
  if (shifts.empty()) return result;
  const auto middle = shifts.begin() + static_cast<std::ptrdiff_t>(shifts.size() / 2);
  std::nth_element(shifts.begin(), middle, shifts.end());
  result.shift_px = *middle;
  return result;
}

}  // namespace mba_vo
