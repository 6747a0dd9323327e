#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/tracking/exposure_filter.h"
#include "mba_vo/tracking/exposure_probe.h"

namespace mba_vo {

/// Estimates by what factor exposures differ from those that came with the images, or from the assumed one where none
/// came: blur is compared with the motion between the frames, over stretches where that is smooth. Of exposures that
/// came, the factor is the median of what single frames say, and is used only if it is so far from 1 that they must be
/// wrong. Where none came it is followed from frame to frame, as automatic exposure may change it, and used as soon as
/// it is known; the rows of a rolling shutter then tell it with every frame (TrackedFrame::exposure_by_rows).
class ExposureEstimator {
 public:
  explicit ExposureEstimator(const TrackerConfig& config);

  /// Exposure to track a frame with, given the one that came with it [s]; nullopt = not known.
  std::optional<double> exposureFor(const std::optional<double>& given, std::int64_t mid_exposure_ns) const;
  ExposureEstimate estimate(bool given, std::int64_t mid_exposure_ns) const;
  /// Of exposures that did not come, as all frames so far tell them; null without any.
  std::shared_ptr<const ExposureHistory> history() const { return history_; }

  /// `given`: the exposure that came with the frame. Frames should come in the order of time; the others are left out.
  void add(const ReferenceConstPtr& reference, const std::shared_ptr<const TrackedFrame>& tracked,
           const std::optional<double>& given);
  /// What a first map's frames say of exposures that did not come. Not for times before what is known.
  void learn(std::int64_t mid_exposure_ns, const ExposureSample& sample);
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
  int framesBetweenProbes(bool known) const;
  void addByRows(const Reference& reference, const TrackedFrame& tracked);
  std::optional<ExposureSample> probeMiddle(const Reference& reference);
  static void update(Ratio& ratio);
  void updateHistory();
  static double weightedMedian(std::vector<Sample> samples);  // of the logarithms; at least one sample

  TrackerConfig config_;
  std::deque<Seen> seen_;                           // the newest ones
  Ratio ratio_;                                     // to the exposures that came
  ExposureFilter unknown_;                          // where none came, relative to the assumed one
  std::shared_ptr<const ExposureHistory> history_;  // of the same
  std::int64_t newest_probed_ns_ = 0;
  int left_out_ = 0;  // frames since the last probe, itself included
};

}  // namespace mba_vo
