#pragma once

#include <optional>

namespace mba_vo {

/// Automatic exposure with an upper limit, which cameras do not offer: exposure up to there, and gain beyond.
class ExposureRegulator {
 public:
  struct Limits {
    double min_exposure = 0.0, max_exposure = 0.0;  // [s]
    int min_gain = 0, max_gain = 0;                 // of the control; equal = there is none
  };
  struct Setting {
    double exposure = 0.0;  // [s]
    int gain = 0;
  };

  /// Begins with the longest exposure and the least gain.
  explicit ExposureRegulator(const Limits& limits);

  const Setting& setting() const { return setting_; }
  /// What to set after an image of this mean, 0 (black) to 1 (white), taken with setting(), which changes to it.
  /// nullopt: it is bright enough and not too bright, or nothing can be done.
  std::optional<Setting> update(double level);

 private:
  Limits limits_;
  Setting setting_;
};

}  // namespace mba_vo
