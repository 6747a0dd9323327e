#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "mba_vo/image/frame.h"
#include "mba_vo/tracking/exposure_history.h"
#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

enum class TrackingStatus {
  kInitializing,  // no map yet
  kTracking,      // pose measured and trusted
  kDegraded,      // pose measured, quality poor
  kLost           // no pose
};

const char* toString(TrackingStatus status);

using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// What the blur of the frames so far says of the exposures that came with the images, or of the assumed one where none
/// came.
struct ExposureEstimate {
  double ratio = 1.0;                                          // estimated / given
  double log_sigma = std::numeric_limits<double>::infinity();  // standard deviation of its logarithm
  bool used = false;    // frames are tracked with the exposure that came, or the assumed one, times the ratio
  bool varies = false;  // the ratio is that of this frame alone
};

/// What the blur of one frame says about its exposure.
struct ExposureSample {
  double exposure = 0.0;   // with which the frame agrees best [s]
  double log_sigma = 0.0;  // standard deviation of its logarithm
};

/// Result for one frame: tracker -> mapper. Every frame that came in makes exactly one of these.
struct TrackedFrame {
  FrameConstPtr frame;
  TrackingStatus status = TrackingStatus::kInitializing;
  std::string reason;                      // empty while kTracking
  ReferenceId reference;                   // what it was aligned to, or would be: of the map in use
  ExposureTrajectory trajectory;           // relative to the reference
  AffineBrightness brightness;             // of this frame, same convention as Reference::brightness
  Matrix12 covariance = Matrix12::Zero();  // of (right increment of T_mid, xi), the exposure being that of `trajectory`
  bool xi_prior_limited = true;            // too little blur for the covariance of xi to mean anything
  double residual_rms = 0.0;               // robust, level 0 [grey levels]
  double pixel_error = 0.0;                // shift of the image that would make such residuals [px]
  double expected_error = 0.0;             // of the points in the image, by the covariance of the pose [px]
  FrameMeasures measures;                  // how it sees the points of the reference
  double inlier_fraction = 0.0;            // of the pixels, below the Huber threshold
  int points_used = 0;                     // patches
  bool keyframe_requested = false;
  bool provisional = false;  // it will be tracked again, against a keyframe that it sees better: not for the map yet
  bool blind = false;        // the image shows nothing new: black, saturated, covered, frozen
  /// Without a pose: rotation and angular velocity of `trajectory` are measured all the same, relative to an earlier
  /// frame, and so is the covariance of the mid pose; there is no position.
  bool orientation_only = false;
  /// While LOST: rotation and angular velocity of `trajectory` are measured without the map, and the position goes on
  /// from a moment ago. A pose to be published, as DEGRADED, and no measurement for the map.
  bool predicted = false;
  double tracking_ms = 0.0;
  ExposureEstimate exposure_estimate;              // with which it was tracked
  std::optional<ExposureSample> exposure_by_rows;  // where a rolling shutter tells the velocity
  /// Where no exposure came with it: what is known by now of its own and of earlier ones; null = nothing.
  std::shared_ptr<const ExposureHistory> exposures;

  bool tracked() const { return status == TrackingStatus::kTracking || status == TrackingStatus::kDegraded; }
  bool hasPose() const { return tracked() || predicted; }
  TrackingStatus publishedStatus() const { return predicted ? TrackingStatus::kDegraded : status; }
};

using TrackedFrameConstPtr = std::shared_ptr<const TrackedFrame>;

}  // namespace mba_vo
