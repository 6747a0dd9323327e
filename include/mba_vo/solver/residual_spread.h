#pragma once

#include <vector>

namespace mba_vo {

/// Standard deviation of the residuals that are no outliers, from the median of their sizes; 0 if there are none.
/// Changes the order of `sizes`, which are not negative.
double residualSpread(std::vector<float>& sizes);

/// Huber threshold for residuals of that spread: 2.5 standard deviations. Blur takes from the residuals what it takes
/// from the contrast, and a threshold made for sharp images would let all outliers pass. At most `largest`, and never
/// so small that rounded intensities pass for outliers.
double huberThreshold(double spread, double largest);

/// Weight of a squared residual of that spread: with it residuals of blurred and of sharp images count by what they
/// tell. At least as much as rounded intensities is taken for noise.
double residualPrecision(double spread);

}  // namespace mba_vo
