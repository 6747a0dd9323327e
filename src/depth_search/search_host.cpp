#include "mba_vo/depth_search/search_host.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {

ExposureTrajectory withoutBlurOf(const SearchHost& host, const ExposureTrajectory& T_host) {
  // As the middle point moves in the image, in focal lengths.
  const auto inImage = [&](const Vector6& xi) {
    Vector6 moved = xi;
    moved.head<3>() *= host.inverse_depth;
    return moved;
  };
  const Vector6 blur = inImage(T_host.xi());
  const double variance = blur.squaredNorm();
  if (variance == 0.0) return T_host;
  const double of_host = inImage(host.image_xi).dot(blur) / variance;
  ExposureTrajectory rest = T_host;
  rest.exposure *= std::sqrt(std::max(0.0, 1.0 - of_host * of_host));
  return rest;
}

}  // namespace mba_vo
