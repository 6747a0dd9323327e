#include <algorithm>
#include <cmath>

#include "mba_vo/blur/row_motion.h"
#include "mba_vo/mapping/depth_search.h"

namespace mba_vo {
namespace {

constexpr double kRowTolerance = 4.0;  // of a rolling shutter: rows whose times are as good as the same
constexpr double kFarAway = 1e-4;      // inverse depth that is as good as 0 [1/m]

}  // namespace

/// The row in which the frame sees the point decides about the line, and the place on the line about the row.
void DepthSearcher::searchRolling(ImmaturePoint& point) const {
  const std::optional<double> row = expectedRow(point);
  if (!row) {
    point.state = ImmaturePoint::State::kOutOfBounds;
    return;
  }
  ImmaturePoint found = point;
  searchBetween(point.pixel.y(), *row, found);
  const std::optional<double> row_found = expectedRow(found);
  if (found.state == ImmaturePoint::State::kGood && row_found && std::abs(*row_found - *row) > kRowTolerance) {
    found = point;
    searchBetween(point.pixel.y(), *row_found, found);
  }
  point = found;
}

std::optional<double> DepthSearcher::expectedRow(const ImmaturePoint& point) const {
  const double inverse_depth = std::max(point.hasDepth() ? point.inverseDepth() : 0.0, kFarAway);
  const RigidMotion to_row = shortMotion(host_velocity_, host_->camera.rowDelay(point.pixel.y()));
  const Eigen::Vector3d ray = host_->camera.unproject(point.pixel.cast<double>());
  const Eigen::Vector3d in_host = to_row.R * (ray / inverse_depth) + to_row.p;
  const auto seen = projectRolling(frame_->camera, T_host_.velocity, T_host_.T_reference_mid.inverse() * in_host);
  if (!seen) return std::nullopt;
  return std::clamp(seen->pixel.y(), 0.0, static_cast<double>(frame_->camera.height - 1));
}

void DepthSearcher::searchBetween(double host_row, double frame_row, ImmaturePoint& point) const {
  ExposureTrajectory T_row = T_host_.delayed(frame_->camera.rowDelay(frame_row));
  T_row.T_reference_mid = SE3::exp(-host_->camera.rowDelay(host_row) * host_velocity_) * T_row.T_reference_mid;
  const DepthSearcher searcher(*host_, *frame_, T_row, gain_, offset_, config_, host_velocity_);
  searcher.searchLine(EpipolarLine(searcher.transform_, point.pixel.cast<double>()), point);
}

}  // namespace mba_vo
