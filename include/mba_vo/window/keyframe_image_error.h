#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/tracking/reference.h"
#include "mba_vo/window/window_linearizer.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// How well a keyframe as a host explains the other keyframes of the window, with their poses and brightness as they
/// are: the shift of the image that would make residuals as large as those of `points`, seen from the host [px].
struct KeyframeImageError {
  double with_own_image = 0.0;
  double with_sharp_image = 0.0;
};

/// With the image that the keyframe numbered `host` has and with the sharp one. None if hardly any points can be
/// compared.
std::optional<KeyframeImageError> compareHostImages(const WindowState& state, int host,
                                                    const std::shared_ptr<const ImagePyramid>& sharp,
                                                    const std::vector<ReferencePoint>& points,
                                                    const WindowLinearizer& linearizer);

}  // namespace mba_vo
