#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "io/temporary_folder.h"
#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// A row of frames.csv as text, by the column names that the evaluation reads.
struct FrameRow {
  double time = 0.0;  // [s]
  std::string arrival, published, online_status, covariance;
};

inline std::string numberText(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

/// A row with the usual latency of `latency` [s] and a clock of the run that is 1000 s ahead.
inline FrameRow publishedRow(double time, double latency, const std::string& status) {
  constexpr double kClock = 1000.0;  // [s]
  return {time, numberText(time + kClock), numberText(time + kClock + latency), status, ""};
}

inline FrameRow silentRow(double time, const std::string& status) {
  FrameRow row = publishedRow(time, 0.0, status);
  row.published.clear();
  return row;
}

/// 21 numbers: the upper triangle row by row.
inline std::string covarianceText(const Matrix6& P) {
  std::string text;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      text += (text.empty() ? "" : " ") + numberText(P(row, column));
    }
  }
  return text;
}

inline std::string framesText(const std::vector<FrameRow>& rows) {
  std::string text = "sequence,time,status,reason,message,arrival,published,online_status,covariance\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FrameRow& r = rows[i];
    text += std::to_string(i) + "," + numberText(r.time) + ",TRACKING,\"a, b\",\"\"," + r.arrival + "," + r.published +
            "," + r.online_status + "," + r.covariance + "\n";
  }
  return text;
}

/// TUM form with `# map N` where the map changes.
inline std::string posesText(const std::vector<PoseRecord>& poses) {
  std::string text = "# t tx ty tz qx qy qz qw\n";
  std::optional<int> map;
  for (const PoseRecord& pose : poses) {
    if (map != pose.map) {
      map = pose.map;
      text += "# map " + std::to_string(pose.map) + "\n";
    }
    const Eigen::Vector3d& t = pose.T_world_camera.translation();
    const Eigen::Vector4d q = pose.T_world_camera.rotation().coeffs();
    text += numberText(pose.time);
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += " " + numberText(value);
    }
    text += "\n";
  }
  return text;
}

/// Writes a run into `folder`.
inline void writeRunFolder(const TemporaryFolder& folder, const std::vector<PoseRecord>& online,
                           const std::vector<PoseRecord>& smoothed, const std::vector<FrameRow>& rows,
                           const std::string& summary) {
  folder.write("run/online_trajectory.txt", posesText(online));
  folder.write("run/online_odometry.txt", posesText(online));
  folder.write("run/trajectory.txt", posesText(smoothed));
  folder.write("run/frames.csv", framesText(rows));
  folder.write("run/summary.yaml", summary);
}

/// The same poses in other coordinates, `scale` metres per unit.
inline std::vector<PoseRecord> inOtherCoordinates(std::vector<PoseRecord> poses, double scale) {
  const SE3 T(Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized())), {0.4, 2.0, -1.0});
  for (PoseRecord& pose : poses) {
    const SE3 moved = T * pose.T_world_camera;
    pose.T_world_camera = SE3(moved.rotation(), moved.translation() / scale);
  }
  return poses;
}

}  // namespace mba_vo
