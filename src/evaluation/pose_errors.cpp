#include "mba_vo/evaluation/pose_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {}  // namespace

double rotationDistance(const SE3& a, const SE3& b) {
  return kDegreesPerRadian * a.rotation().angularDistance(b.rotation());
}

std::vector<double> absoluteErrors(const std::vector<PosePair>& pairs) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    errors.push_back((pair.estimate.translation() - pair.groundtruth.translation()).norm());
  }
  return errors;
}

std::vector<double> rotationErrors(const std::vector<PosePair>& pairs) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    errors.push_back(rotationDistance(pair.estimate, pair.groundtruth));
  }
  return errors;
}

RelativeErrors relativeErrors(const std::vector<PosePair>& pairs, double interval, double tolerance) {
  RelativeErrors errors;
  std::size_t j = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double wanted = pairs[i].time + interval;
    j = std::max(j, i);
    while (j + 1 < pairs.size() && std::abs(pairs[j + 1].time - wanted) <= std::abs(pairs[j].time - wanted)) {
      ++j;
    }
    if (j == i || std::abs(pairs[j].time - wanted) > tolerance) {
      continue;
    }
    const SE3 true_motion = pairs[i].groundtruth.inverse() * pairs[j].groundtruth;
    const SE3 estimated_motion = pairs[i].estimate.inverse() * pairs[j].estimate;
    const SE3 error = true_motion.inverse() * estimated_motion;
    errors.translation.push_back(error.translation().norm());
    errors.rotation.push_back(rotationDistance(SE3(), error));
  }
  return errors;
}

}  // namespace mba_vo
