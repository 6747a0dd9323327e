#include "mba_vo/evaluation/alignment.h"

#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace mba_vo {
namespace {

Eigen::Matrix3Xd asColumns(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  return matrix;
}

}  // namespace

Similarity alignPositions(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& groundtruth,
                          AlignmentMode mode) {
  if (estimate.size() != groundtruth.size() || estimate.size() < 3) {
    throw std::invalid_argument("alignment: " + std::to_string(estimate.size()) + " estimated and " +
                                std::to_string(groundtruth.size()) + " true positions; at least 3 pairs are needed");
  }
  const Eigen::Matrix3Xd source = asColumns(estimate);
  const Eigen::Matrix3Xd target = asColumns(groundtruth);
  const Eigen::Vector3d source_mean = source.rowwise().mean();
  const double spread = (source.colwise() - source_mean).cwiseAbs().maxCoeff();  // [m]
  constexpr double kRelativeRounding = 1e-12;
  if (spread <= kRelativeRounding * (1.0 + source_mean.norm())) {
    const Eigen::Vector3d translation = target.rowwise().mean() - source_mean;
    return {1.0, SE3(Eigen::Quaterniond::Identity(), translation)};
  }
  const Eigen::Matrix4d transform = Eigen::umeyama(source, target, mode == AlignmentMode::kSim3);
  Similarity similarity;
  similarity.scale = transform.col(0).head<3>().norm();
  const Eigen::Matrix3d rotation = transform.topLeftCorner<3, 3>() / similarity.scale;
  similarity.motion = SE3(Eigen::Quaterniond(rotation), transform.col(3).head<3>());
  return similarity;
}

}  // namespace mba_vo
