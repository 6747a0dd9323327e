#pragma once

#include <string>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// All options of the odometry. Written down once, in the `describe` functions; read from YAML or ROS parameters.
struct OdometryConfig {
  FrameBuilderConfig image;
  TrackerConfig tracker;
  KeyframePolicyConfig keyframe;
  MapperConfig mapper;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v.section("image", c.image);
    v.section("tracker", c.tracker);
    v.section("keyframe", c.keyframe);
    v.section("mapper", c.mapper);
  }
};

}  // namespace mba_vo
