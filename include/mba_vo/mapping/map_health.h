#pragma once

#include <deque>
#include <string>
#include <vector>

#include "mba_vo/window/depth_agreement.h"

namespace mba_vo {

struct Reference;

/// Shift of a keyframe's image that would cause residuals of this rms [grey levels] at its points [px].
double keyframeError(double rms, const Reference& keyframe);

struct MapHealthConfig {
  double max_error = 1.0;
  double max_rise = 0.4;
  double wrong_error = 1.8;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("max_error", c.max_error, 0.1, 100.0,
      "residual over gradient of the keyframes above which poses are degraded [px]");
    v("max_rise", c.max_rise, 0.1, 100.0, "the same, for its rise above the map's lower quartile [px]");
    v("wrong_error", c.wrong_error, 0.1, 100.0, "the same, above which the map is given up [px]");
  }
};

/// Whether a map explains the images it is made of. Residuals are compared with the gradient there: the shift of an
/// image that would cause them does not depend on how much texture there is to see.
class MapHealth {
 public:
  explicit MapHealth(const MapHealthConfig& config) : config_(config) {}

  /// A keyframe's error after optimisation [px].
  void addKeyframe(double error);
  /// How measured depths and images agreed then: where they do not, the map is wrong.
  void addDepths(const DepthAgreement& depths);
  /// A tracked frame's error [px]. A map whose first frames contradict it is wrong, too; two that begin so one after
  /// the other are not to blame: the camera is not well known.
  void addFrame(double error);
  /// Another map begins.
  void reset();
  /// It is one of an earlier run: how the first frames here fit says nothing of how it began.
  void trustBeginning() { judges_beginning_ = false; }

  /// Why poses of this map are not to be relied on now; empty if they are.
  std::string doubt() const;
  /// True if the map is wrong and of no more use. A young map has to be right from the first keyframe on.
  bool isWrong() const;
  /// Keyframes that were bad in a row, the newest among them.
  int badInARow() const { return bad_in_a_row_; }
  bool isYoung() const;
  /// Its first frames contradict it: nothing of it is of use.
  bool beganWrong() const;
  bool contradictsDepths() const { return depths_.fails(); }
  /// What frames of this map usually have [px], 0 before the first.
  double usualFrameError() const;
  double lastKeyframeError() const { return errors_.empty() ? 0.0 : errors_.back(); }

 private:
  double limit() const;

  MapHealthConfig config_;
  std::vector<double> errors_;  // of keyframes
  std::deque<double> frame_errors_;
  DepthAgreement depths_;
  int bad_in_a_row_ = 0;
  int wrong_in_a_row_ = 0;
  bool judges_beginning_ = true;
  bool contradicted_ = false;      // by its first frames
  int contradicted_in_a_row_ = 0;  // maps
};

}  // namespace mba_vo
