#pragma once

#include "mba_vo/deblur/level_problem.h"

namespace mba_vo {

/// Keyframe and neighbour made comparable without knowing the sharp image, because blurs commute: the keyframe blurred
/// along the neighbour's paths, and the neighbour, laid over it, along the keyframe's.
struct CommutedImages {
  cv::Mat1f keyframe, neighbour;  // [grey levels]
  cv::Mat1f known;                // 1 where both are, else 0
  // What the blurs along either's paths leave of the variance of white noise.
  float keyframe_gain = 1.0F, neighbour_gain = 1.0F;
};

CommutedImages commute(const Observation& keyframe, const Observation& neighbour);

/// Variance of what the neighbour's image has in it beyond the blurred sharp image and its noise, around each pixel
/// [grey levels^2]: by how much the commuted images differ more than by noise. `keyframe_noise`, `neighbour_noise`:
/// standard deviations [grey levels].
cv::Mat1f modelVariance(const CommutedImages& images, float keyframe_noise, float neighbour_noise);

}  // namespace mba_vo
