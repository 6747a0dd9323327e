#pragma once

#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

#include "mba_vo/ros/diagnostics.h"

namespace mba_vo {

/// Publishes the tracker's health on /diagnostics with each update.
class TrackerDiagnostics {
 public:
  /// `name`: of the nodelet.
  TrackerDiagnostics(ros::NodeHandle& nh, ros::NodeHandle& private_nh, const std::string& name);
  /// All but `before` and `seconds` is told.
  void update(TrackerHealth health);

 private:
  diagnostic_updater::Updater updater_;
  TrackerHealth health_;
  ros::SteadyTime last_;
};

/// The same of the mapper.
class MapperDiagnostics {
 public:
  MapperDiagnostics(ros::NodeHandle& nh, ros::NodeHandle& private_nh, const std::string& name);
  /// `busy_seconds`: since the start.
  void update(const MapperStatus& status, double busy_seconds);

 private:
  diagnostic_updater::Updater updater_;
  MapperHealth health_;
  double busy_seconds_ = 0.0;  // at the last update
  ros::SteadyTime last_;
};

}  // namespace mba_vo
