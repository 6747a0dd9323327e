#include "diagnostics_publisher.h"

#include <utility>

namespace mba_vo {
namespace {

/// Since the last call [s].
double elapsed(ros::SteadyTime& last) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  return (now - std::exchange(last, now)).toSec();
}

}  // namespace

TrackerDiagnostics::TrackerDiagnostics(ros::NodeHandle& nh, ros::NodeHandle& private_nh, const std::string& name)
    : updater_(nh, private_nh, name), last_(ros::SteadyTime::now()) {
  updater_.setHardwareID("none");
  updater_.add("input", [this](auto& diagnostic) { diagnoseInput(health_, diagnostic); });
  updater_.add("tracking", [this](auto& diagnostic) { diagnoseTracking(health_, diagnostic); });
}

void TrackerDiagnostics::update(TrackerHealth health) {
  health.before = health_.now;
  health.seconds = elapsed(last_);
  health_ = std::move(health);
  updater_.force_update();
}

MapperDiagnostics::MapperDiagnostics(ros::NodeHandle& nh, ros::NodeHandle& private_nh, const std::string& name)
    : updater_(nh, private_nh, name), last_(ros::SteadyTime::now()) {
  updater_.setHardwareID("none");
  updater_.add("mapping", [this](auto& diagnostic) { diagnoseMapping(health_, diagnostic); });
}

void MapperDiagnostics::update(const MapperStatus& status, double busy_seconds) {
  health_.before = std::exchange(health_.now, status);
  health_.seconds = elapsed(last_);
  health_.busy_seconds = busy_seconds - std::exchange(busy_seconds_, busy_seconds);
  updater_.force_update();
}

}  // namespace mba_vo
