#pragma once

#include <optional>
#include <vector>

#include "mba_vo/deblur/neighbour.h"

namespace mba_vo {

/// Mean squared error [grey levels^2] that the best linear estimate of a sharp image is left with, given images of it
/// that were smeared along straight `paths` [px] and have noise of `noise` [grey levels]. Smearing multiplies the
/// frequency f [1/px] by sinc(f . path), which is 0 at whole f . path: what one image lost another one has if it was
/// smeared in another direction, or less. The sharp image is taken to be like images are: a power of 1 / |f|^2.
double expectedError(const std::vector<Eigen::Vector2f>& paths, float noise);

struct NeighbourChoice {
  std::size_t index;  // of the neighbour
  double gain_db;     // by how much less error is to be expected than with the keyframe alone [dB]
};

/// The neighbour that tells most about what the keyframe's blur destroyed, over the whole image: places that it does
/// not see count as well. nullopt if there is none with a usable image and motion. `keyframe`: from the keyframe to
/// itself; `depth`: of every pixel of the keyframe [1/m].
std::optional<NeighbourChoice> chooseNeighbour(const BlurGeometry& keyframe, const cv::Mat1f& depth, float noise,
                                               const std::vector<DeblurNeighbour>& neighbours);

/// From the keyframe to a level of one of its neighbours.
BlurGeometry geometryOf(const DeblurNeighbour& neighbour, int level, const BlurGeometry& keyframe);

}  // namespace mba_vo
