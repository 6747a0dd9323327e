#pragma once

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// How bright the last tracked image was.
struct BrightnessState {
  AffineBrightness brightness;  // relative to the map
  double contrast = 0.0;        // [grey levels]

  /// Of an image with that contrast: the same, unless it has clearly got brighter or darker. Then a change of exposure
  /// has to be followed.
  AffineBrightness expectedAt(double contrast_now) const;
};

}  // namespace mba_vo
