#pragma once

#include <optional>

#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// Tries exposures, at most `longest` [s]: with which does the frame, seen while moving with `velocity`, agree best
/// with the reference? Those around the `expected` one are tried, or, where little is known of it, all of them: where
/// the blur is wrong altogether, one that is a bit less wrong may be no better. The velocity has to come from
/// elsewhere, as from the poses of the frames before and after it. A reference with blur of its own is taken as exposed
/// as long as the frame. nullopt if there is no best one, as where hardly anything is blurred.
std::optional<ExposureSample> probeExposure(const Reference& reference, const TrackedFrame& tracked,
                                            const Vector6& velocity, const ExposureSample& expected, double longest,
                                            const TrackerConfig& config);

/// How the camera passes a reference's points while a frame is taken, as the poses around it tell.
struct Passage {
  Vector6 velocity;  // of the frame, camera frame [m/s, rad/s]
  double interval;   // between frames [s]
  double path_px;    // of the points, in an interval
  double alike;      // share of it that the reference's own blur goes along with; 1: what is blurred tells nothing

  /// True if frames are near enough to each other, and what they show moves by enough.
  bool tells() const;
  /// Share of a blur along the path that shows: the difference of the squares of both.
  double shown() const;
};

Passage passageOf(const Reference& reference, const TrackedFrame& tracked, const Vector6& velocity, double interval);

/// The sample, as short as it may well be: too long an exposure does harm, too short a one does not.
ExposureSample asShortAsMayBe(ExposureSample sample);

/// probeExposure, with an honest standard deviation, which the path's own, `doubt_px`, is part of. `told`: the exposure
/// that came with the frame, if any [s]; where none did, the sample is as short as it may well be: too long does harm.
std::optional<ExposureSample> sampleExposure(const Reference& reference, const TrackedFrame& tracked,
                                             const Passage& passage, double doubt_px, const ExposureSample& expected,
                                             const std::optional<double>& told, const TrackerConfig& config);

}  // namespace mba_vo
