#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/csv_file.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// What was published first about an image.
enum class OnlineStatus { kTracking, kDegraded, kOrientation, kInitializing, kLost, kRepeated, kRejected, kShed };

/// As written in frames.csv.
const char* toString(OnlineStatus status);

/// One input image and what became of it at once, from frames.csv of the odometry.
struct OnlineFrame {
  double time = 0.0;                // mid-exposure [s]
  std::optional<double> arrival;    // on the clock of the run [s]
  std::optional<double> published;  // of its first pose or orientation, same clock [s]; nullopt: never in time
  OnlineStatus status = OnlineStatus::kLost;
  std::optional<Matrix6> covariance;  // of delta in T_odom_camera Exp(delta) [m, rad]

  /// Published with a full pose, however late.
  bool hasPose() const;
  /// Published with at least an orientation, however late.
  bool hasOrientation() const;
  /// From arrival to publication [s]; only where published.
  double latency() const { return *published - *arrival; }
};

/// The columns `time`, `arrival`, `published`, `online_status` and `covariance` of a frames.csv, in the order of the
/// file. Throws std::runtime_error naming file and line if malformed, and for a file without images.
std::vector<OnlineFrame> onlineLog(const CsvTable& table);

}  // namespace mba_vo
