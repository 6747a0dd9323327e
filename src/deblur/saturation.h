#pragma once

namespace mba_vo {

constexpr float kSaturated = 254.0F;  // [grey levels of the camera] from here on a pixel tells only that it is bright

}  // namespace mba_vo
