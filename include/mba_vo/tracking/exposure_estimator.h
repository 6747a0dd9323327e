#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/tracking/exposure_probe.h"

namespace mba_vo {

/// Estimates by what factor exposures differ from those that came with the images, or from the assumed one where none
/// came: blur is compared with the motion between the frames, over stretches where that is smooth. The factor is the
/// median of what single frames say. It is used where no exposure came with the images as soon as it is known, and else
/// only if it is so far from 1 that the exposures that came must be wrong.
class ExposureEstimator {
 public:
  explicit ExposureEstimator(const TrackerConfig& config) : config_(config) {}

  /// Exposure to track a frame with, given the one that came with it [s]; nullopt = not known.
  std::optional<double> exposureFor(const std::optional<double>& given) const;
  const ExposureEstimate& estimate(bool given) const { return ratios_[given].estimate; }

  /// `given`: the exposure that came with the frame. Frames should come in the order of time; the others are left out.
  void add(const ReferenceConstPtr& reference, const std::shared_ptr<const TrackedFrame>& tracked,
           const std::optional<double>& given);
  /// Goes on relative to another reference.
  void changeReference(const SE3& T_new_old);
  /// Goes on with other frames, of another map.
  void forgetFrames() { seen_.clear(); }
  void reset();

 private:
  struct Seen {
    std::shared_ptr<const TrackedFrame> tracked;
    SE3 T_reference_mid;  // relative to the newest reference
    double given;         // exposure, or the assumed one [s]
    bool known;           // it came with the frame
  };
  struct Sample {
    double log_ratio, weight;
  };
  struct Ratio {
    std::deque<Sample> samples;
    ExposureEstimate estimate;
  };
  static int framesBetweenProbes(const Ratio& ratio);
  std::optional<ExposureSample> probeMiddle(const Reference& reference);
  static void update(Ratio& ratio, bool known);
  static double weightedMedian(std::vector<Sample> samples);  // of the logarithms; at least one sample

  TrackerConfig config_;
  std::deque<Seen> seen_;        // the newest ones
  std::array<Ratio, 2> ratios_;  // to the assumed exposure where none came; to those that came
  std::int64_t newest_probed_ns_ = 0;
  int left_out_ = 0;  // frames since the last probe, itself included
};

}  // namespace mba_vo
