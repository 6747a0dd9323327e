#include "mba_vo/simulation/simulation_config.h"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

namespace mba_vo::simulation_config_test {
namespace {

std::string messageOf(const std::function<void(SimulationConfig&)>& change) {
  SimulationConfig config;
  change(config);
  try {
    config.validate();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SimulationConfig, DefaultsAreValidAndCentred) {
  const SimulationConfig config;
  EXPECT_NO_THROW(config.validate());
  EXPECT_EQ(config.camera().fy, 430.0);
  EXPECT_EQ(config.camera().cx, 375.5);
  EXPECT_EQ(config.camera().cy, 239.5);
}

TEST(SimulationConfig, BadValuesAreNamed) {
  const std::pair<std::string, std::function<void(SimulationConfig&)>> cases[] = {
      {"width = 3", [](auto& c) { c.width = 3; }},
      {"rate = 0", [](auto& c) { c.rate = 0.0; }},
      {"noise = nan", [](auto& c) { c.noise = std::numeric_limits<double>::quiet_NaN(); }},
      {"exposure = -1", [](auto& c) { c.exposure = -1.0; }},
      {"longer than the frame interval", [](auto& c) { c.exposure = 0.05; }},
      {"longer than the frame interval", [](auto& c) { c.row_time = 1e-3; }},
      {"distortion_model = 'barrel'", [](auto& c) { c.distortion_model = "barrel"; }},
      {"plumb_bob takes 0, 4 or 5", [](auto& c) { c.distortion = {0.1}; }},
      {"equidistant takes 4", [](auto& c) { c.distortion_model = "equidistant"; }},
      {"duration = 0 has a meaning only", [](auto& c) { c.duration = 0.0; }},
      {"start = 3.000000 s: there is no recorded motion", [](auto& c) { c.start = 3.0; }},
      {"exposure_max = 0.05", [](auto& c) { c.exposure_min = c.exposure_max = 0.05; }},
      {"exposure_min = 0.000000 s must be above 0", [](auto& c) { c.exposure_max = 0.02; }},
      {"exposure_min = 0.020000 s must be above 0 and at most exposure_max = 0.0100",
       [](auto& c) {
         c.exposure_min = 0.02;
         c.exposure_max = 0.01;
       }},
      {"exposure = 0: exposures that vary",
       [](auto& c) {
         c.exposure = 0.0;
         c.exposure_min = c.exposure_max = 0.01;
       }},
      {"gain_error = 0.100000 needs auto_gain", [](auto& c) { c.gain_error = 0.1; }},
      {"jpeg = 101", [](auto& c) { c.jpeg = 101; }},
  };
  for (const auto& [expected, change] : cases) {
    const std::string message = messageOf(change);
    EXPECT_NE(message.find(expected), std::string::npos) << message;
  }
}

TEST(SimulationConfig, ResizeKeepsTheFieldOfView) {
  SimulationConfig config;
  const PinholeCamera before = config.camera();
  config.resize(376, 240);
  const PinholeCamera after = config.camera();
  // The outer borders of the corner pixels see along the same rays.
  const Eigen::Vector3d a = before.unproject({751.5, 479.5});
  const Eigen::Vector3d b = after.unproject({375.5, 239.5});
  EXPECT_LT((a - b).norm(), 1e-12);
}

TEST(SimulationConfig, FingerprintFollowsEveryValueThatChangesImages) {
  const std::string base = SimulationConfig().fingerprint();
  const std::function<void(SimulationConfig&)> changes[] = {
      [](auto& c) { c.width = 751; },
      [](auto& c) { c.fx = 430.0000001; },
      [](auto& c) { c.exposure = 0.01; },
      [](auto& c) {
        c.distortion = {0, 0, 0, 1e-9};
      },
      [](auto& c) { c.distortion_model = "rational_polynomial"; },
      [](auto& c) { c.scene_seed = 2; },
      [](auto& c) { c.trajectory_seed = 2; },
      [](auto& c) { c.row_time = 1e-6; },
      [](auto& c) { c.gamma = 2.2; },
      [](auto& c) { c.duration = 11.0; },
      [](auto& c) { c.shake = 0.5; },
      [](auto& c) { c.exposure_min = 0.01; },
      [](auto& c) { c.exposure_max = 0.03; },
      [](auto& c) { c.exposure_period = 7.0; },
      [](auto& c) { c.auto_gain = true; },
      [](auto& c) { c.gain_error = 0.01; },
      [](auto& c) { c.jpeg = 90; },
  };
  for (const auto& change : changes) {
    SimulationConfig config;
    change(config);
    EXPECT_NE(config.fingerprint(), base);
  }
  SimulationConfig more_images;
  more_images.sharp = more_images.depth = true;
  EXPECT_EQ(more_images.fingerprint(), base);
}

}  // namespace
}  // namespace mba_vo::simulation_config_test
