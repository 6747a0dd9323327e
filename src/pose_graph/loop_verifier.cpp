#include "mba_vo/pose_graph/loop_verifier.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include <Eigen/Cholesky>

#include "mba_vo/pose_graph/depth_ratio.h"
#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

constexpr int kLeastPatches = 50;             // fewer fit anything
constexpr double kLeastInliers = 0.7;         // of the pixels
constexpr double kLeastVisible = 0.3;         // of the points
constexpr double kLargestError = 0.7;         // [px] residual over gradient
constexpr double kLargestDisagreement = 1.0;  // [px] in the mean over the points, or
constexpr double kErrors = 3.0;  // so many times what the images differ by: where all is worse, so are depths
constexpr double kLargestScaleSigma = 0.05;  // beyond, the scale is unknown
// What both directions have wrong alike, as depths and calibration make them. Found with scripts/loops.py, with an
// ideal camera and with one that is known to 1 %.
constexpr double kSharedError = 0.25;       // of what they disagree by
constexpr double kSharedScaleError = 0.01;  // for each px of that, by depths, and
constexpr double kWayErrors = 3.0;          // so many times as much by the way
constexpr int kLeastDepths = 30;            // compared
constexpr int kWitnesses = 2;               // that must agree
constexpr int kContradictions = 2;          // that suffice to refuse

TrackerConfig strict(TrackerConfig config) {
  config.min_patches = std::max(config.min_patches, kLeastPatches);
  config.estimate_exposure = false;
  return config;
}

std::string withNumber(const std::string& text, double value, const char* unit) {
  std::ostringstream out;
  out << text << " " << std::setprecision(2) << value << unit;
  return out.str();
}

/// Why an alignment is not good enough; empty if it is.
std::string doubt(const TrackedFrame& tracked) {
  if (!tracked.tracked()) return tracked.reason;
  if (tracked.measures.visible_fraction < kLeastVisible)
    return withNumber("too little in common:", tracked.measures.visible_fraction, "");
  if (tracked.inlier_fraction < kLeastInliers) return withNumber("too few pixels agree:", tracked.inlier_fraction, "");
  if (tracked.pixel_error > kLargestError) return withNumber("the images differ by", tracked.pixel_error, " px");
  return tracked.reason;
}

/// How far apart two poses put the points of the older keyframe in the image of another, in the mean; such as are seen
/// by both [px]. `scale`: lengths of the second pose times this are lengths of the first.
double disagreement(const ArchivedKeyframe& older, const PinholeCamera& camera, const SE3& T_old_first,
                    const SE3& T_second_old, double scale) {
  const SE3 T_first_old = T_old_first.inverse();
  double sum = 0.0;
  int count = 0;
  for (const ReferencePoint& point : older.reference.points) {
    const Eigen::Vector3d P =
        older.camera.unproject(point.pixel.cast<double>()) / std::max(static_cast<double>(point.inverse_depth), 1e-9);
    const Eigen::Vector3d first = T_first_old * P;
    const Eigen::Vector3d second = T_second_old * (P / scale);
    if (first.z() <= 0.0 || second.z() <= 0.0 || !camera.contains(camera.project(first))) continue;
    sum += (camera.project(first) - camera.project(second)).norm();
    ++count;
  }
  return count > 0 ? sum / count : HUGE_VAL;
}

/// Of two poses that should be the same [px].
double tolerance(double pixel_error) { return std::max(kLargestDisagreement, kErrors * pixel_error); }

/// As published covariances are: what patches share is not in the alignment's own.
Matrix6 honestCovariance(const TrackedFrame& tracked) {
  constexpr double kCommonError = 0.1;  // [px], see OdometryCovariance
  const double relative = tracked.expected_error / kCommonError;
  return (0.5 + relative * relative) * tracked.covariance.topLeftCorner<6, 6>();
}

SE3 scaled(const SE3& T, double scale) { return {T.rotation(), scale * T.translation()}; }

Matrix6 scaledCovariance(const Matrix6& covariance, double scale) {
  Vector6 unit = Vector6::Ones();
  unit.head<3>().setConstant(scale);
  return unit.asDiagonal() * covariance * unit.asDiagonal();
}

}  // namespace

LoopVerifier::View::View(const ArchivedKeyframeConstPtr& kept)
    : keyframe(kept), frame(kept->restoreFrame()), reference(kept->restoreReference(frame)) {}

LoopVerifier::LoopVerifier(const TrackerConfig& tracker)
    : unknown_exposure_(tracker.unknown_exposure), tracker_(strict(tracker)) {}

TrackedFrame LoopVerifier::align(const View& reference, const View& frame, const SE3& T_reference_frame,
                                 bool is_close) const {
  TrackingGuess guess(ExposureTrajectory{T_reference_frame, frame.reference->motion.velocity,
                                         frame.frame->exposure.value_or(unknown_exposure_)});
  guess.brightness = frame.reference->brightness;
  guess.is_close = is_close;
  return tracker_.track(*reference.reference, frame.frame, guess);
}

LoopVerdict LoopVerifier::verify(const ArchivedKeyframeConstPtr& older, const ArchivedKeyframeConstPtr& newer,
                                 const std::vector<SE3>& starts, const std::vector<LoopWitness>& witnesses) const {
  LoopVerdict verdict;
  const View old_view(older), new_view(newer);
  TrackedFrame forward;
  for (const SE3& start : starts) {
    forward = align(old_view, new_view, start, false);
    verdict.rejected_because = doubt(forward);
    if (verdict.accepted()) break;
  }
  if (!verdict.accepted()) return verdict;
  const SE3& T_old_new = forward.trajectory.T_reference_mid;
  verdict.by_depths = compareDepths(*older, *newer, T_old_new);
  const SE3 T_new_old = scaled(T_old_new.inverse(), std::exp(-verdict.by_depths.log_scale));
  const TrackedFrame backward = align(new_view, old_view, T_new_old, true);
  verdict.rejected_because = doubt(backward);
  if (!verdict.accepted()) {
    verdict.rejected_because = "seen from the other one, " + verdict.rejected_because;
    return verdict;
  }
  verdict.pixel_error = std::max(forward.pixel_error, backward.pixel_error);
  fuse(old_view, new_view, forward, backward, verdict);
  if (verdict.accepted()) hearWitnesses(old_view, new_view, witnesses, verdict);
  return verdict;
}

/// By depths, and by how long the way between the two is in either unit. `covariance_back`: of the right increment of
/// T_old_new_back, which is in the newer one's unit.
ScaleEstimate LoopVerifier::scaleOf(const SE3& T_old_new, const Matrix6& covariance, const SE3& T_old_new_back,
                                    const Matrix6& covariance_back, LoopVerdict& verdict) {
  const double shared = kSharedScaleError * verdict.disagreement_px;
  verdict.by_depths.sigma = std::hypot(verdict.by_depths.sigma, shared);
  double information = 1.0 / (verdict.by_depths.sigma * verdict.by_depths.sigma);
  double log_scale = information * verdict.by_depths.log_scale;
  const Eigen::Vector3d& way = T_old_new_back.translation();
  const double ratio = way.squaredNorm() > 0.0 ? T_old_new.translation().dot(way) / way.squaredNorm() : 0.0;
  if (ratio > 0.0) {
    const Eigen::Vector3d along = T_old_new.rotation().conjugate() * way.normalized();
    const double variance = along.dot(covariance.topLeftCorner<3, 3>() * along) / (ratio * ratio) +
                            along.dot(covariance_back.topLeftCorner<3, 3>() * along);
    ScaleEstimate& by_way = verdict.by_translations = {
        std::log(ratio), std::hypot(std::sqrt(variance) / way.norm(), kWayErrors * shared), 1};
    const double more = 1.0 / (by_way.sigma * by_way.sigma);
    log_scale += more * by_way.log_scale;
    information += more;
  }
  return {log_scale / information, 1.0 / std::sqrt(information), verdict.by_depths.points};
}

/// The scale, then the pose by both directions.
void LoopVerifier::fuse(const View& older, const View& newer, const TrackedFrame& forward, const TrackedFrame& backward,
                        LoopVerdict& verdict) {
  const SE3& T_old_new = forward.trajectory.T_reference_mid;
  const SE3& T_new_old = backward.trajectory.T_reference_mid;  // in the newer one's unit
  if (verdict.by_depths.points < kLeastDepths) {
    verdict.rejected_because = withNumber("too few depths to compare:", verdict.by_depths.points, "");
    return;
  }
  const Matrix6 covariance = honestCovariance(forward);
  const Matrix6 covariance_back = T_new_old.adjoint() * honestCovariance(backward) * T_new_old.adjoint().transpose();
  verdict.disagreement_px = disagreement(*older.keyframe, newer.keyframe->camera, T_old_new, T_new_old,
                                         std::exp(verdict.by_depths.log_scale));
  const ScaleEstimate found = scaleOf(T_old_new, covariance, T_new_old.inverse(), covariance_back, verdict);
  const double scale = std::exp(found.log_scale);
  if (found.sigma > kLargestScaleSigma) {
    verdict.rejected_because = withNumber("the scale is known to", 100.0 * found.sigma, " % only");
  } else if (verdict.disagreement_px > tolerance(verdict.pixel_error)) {
    verdict.rejected_because = withNumber("the two directions differ by", verdict.disagreement_px, " px");
  }
  const Matrix6 information_back = scaledCovariance(covariance_back, scale).inverse();
  const Matrix6 fused = (covariance.inverse() + information_back).inverse();
  const SE3 back = scaled(T_new_old.inverse(), scale);
  verdict.S_old_new = Sim3(T_old_new * SE3::exp(fused * information_back * (T_old_new.inverse() * back).log()), scale);
  // The increment is in the newer one's unit.
  verdict.covariance.topLeftCorner<6, 6>() = scaledCovariance(fused, 1.0 / scale);
  verdict.covariance(6, 6) = found.sigma * found.sigma;
  const double angle = kSharedError * verdict.disagreement_px / newer.keyframe->camera.fx;
  const double length = angle * medianDepth(*newer.reference);
  verdict.covariance.diagonal().head<3>().array() += length * length;
  verdict.covariance.diagonal().segment<3>(3).array() += angle * angle;
}

void LoopVerifier::hearWitnesses(const View& older, const View& newer, const std::vector<LoopWitness>& witnesses,
                                 LoopVerdict& verdict) const {
  int contradictions = 0;
  std::string contradiction;
  const SE3& T_old_new = verdict.S_old_new.rigid();
  const double scale = verdict.S_old_new.scale();
  for (const LoopWitness& witness : witnesses) {
    if (verdict.witnesses >= kWitnesses || contradictions >= kContradictions) break;
    const View view(witness.keyframe);
    // A newer one is compared with the older keyframe, an older one with the newer keyframe.
    const View& reference = witness.beside_old ? newer : older;
    const SE3 expected = witness.beside_old ? scaled(T_old_new.inverse() * witness.T_beside_keyframe, 1.0 / scale)
                                            : T_old_new * scaled(witness.T_beside_keyframe, scale);
    const TrackedFrame seen = align(reference, view, expected, true);
    if (!seen.tracked() || seen.measures.visible_fraction < kLeastVisible) continue;  // it cannot tell
    const double apart = disagreement(*reference.keyframe, view.keyframe->camera, expected,
                                      seen.trajectory.T_reference_mid.inverse(), 1.0);
    std::string because = doubt(seen);
    if (because.empty() && apart > tolerance(verdict.pixel_error)) because = withNumber("it is off by", apart, " px");
    if (because.empty()) {
      ++verdict.witnesses;
    } else {
      ++contradictions;
      contradiction = "keyframe " + std::to_string(view.reference->id.keyframe_id) + " contradicts: " + because;
    }
  }
  if (contradictions >= kContradictions) {
    verdict.rejected_because = contradiction;
  } else if (verdict.witnesses < kWitnesses) {
    verdict.rejected_because = "too few other keyframes see it: " + std::to_string(verdict.witnesses) +
                               (contradiction.empty() ? "" : ", and " + contradiction);
  }
}

}  // namespace mba_vo
