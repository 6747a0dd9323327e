#pragma once

namespace mba_vo {

/// Brightens images of dark scenes as a camera with more light would, as far as their noise allows: what is compared
/// with grey levels anywhere was found on ordinary images. A power of two, so that nothing is rounded. It is changed
/// only when the light has clearly changed, by as much as an automatic exposure may change it.
class DigitalGain {
 public:
  double value() const { return value_; }

  /// `mean`: of an image before its gain [grey levels].
  bool suits(double mean) const;
  /// For images like this. `noise`: its standard deviation before the gain [grey levels].
  void choose(double mean, double noise);
  /// From now on images are darker by this factor, though their light is not.
  void makeUpFor(double factor);

 private:
  bool chosen_ = false;
  double mean_ = 0.0;  // of the image that it was chosen for [grey levels]
  double value_ = 1.0;
};

}  // namespace mba_vo
