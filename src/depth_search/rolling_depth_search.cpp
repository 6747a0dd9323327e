#include <algorithm>
#include <cmath>

#include "mba_vo/blur/row_motion.h"
#include "mba_vo/depth_search/depth_search.h"

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
  searchInRow(*row, found);
  const std::optional<double> row_found = expectedRow(found);
  if (found.state == ImmaturePoint::State::kGood && row_found && std::abs(*row_found - *row) > kRowTolerance) {
    found = point;
    searchInRow(*row_found, found);
  }
  point = found;
}

std::optional<double> DepthSearcher::expectedRow(const ImmaturePoint& point) const {
  const double inverse_depth = std::max(point.hasDepth() ? point.inverseDepth() : 0.0, kFarAway);
  const Eigen::Vector3d ray = host_->camera.unproject(point.pixel.cast<double>());
  const RigidMotion T_frame_host_row = T_frame_host_row_.at(host_->camera.rowDelay(point.pixel.y()));
  const auto seen =
      projectRolling(frame_->camera, T_host_.motion(), T_frame_host_row * Eigen::Vector3d(ray / inverse_depth));
  if (!seen) return std::nullopt;
  return std::clamp(seen->pixel.y(), 0.0, static_cast<double>(frame_->camera.height - 1));
}

void DepthSearcher::searchInRow(double frame_row, ImmaturePoint& point) const {
  const double delay = frame_->camera.rowDelay(frame_row);
  const RigidMotion T_frame_host_row = T_frame_host_row_.at(host_->camera.rowDelay(point.pixel.y()));
  const RigidMotion T_row_host_row = shortMotion(-T_host_.motionUntil(delay)) * T_frame_host_row;
  const EpipolarLine line(HostToFrame(host_->camera, frame_->camera, T_row_host_row), point.pixel.cast<double>());
  Range range{};
  // Most points need no search any more, and then no patches.
  if (!chooseRange(line, point, range)) return;
  const RigidMotion T_host_row_frame = T_frame_host_row.inverse();
  const auto poseAt = [&](double t) { return T_host_row_frame * shortMotion(T_host_.motionUntil(delay + t)); };
  const double half = 0.5 * T_host_.exposure;
  const ExposedPoses poses(poseAt(-half), poseAt(0.0), poseAt(half), T_host_.xi().squaredNorm() > 0.0);
  const SearchPatchMaker patches(*host_, frame_->camera, poses, gain_, offset_, vignette_, config_.min_blur_px);
  searchRange({line, patches}, range, point);
}

}  // namespace mba_vo
