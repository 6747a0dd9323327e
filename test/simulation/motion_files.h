#pragma once

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "mba_vo/simulation/hand_held_motion.h"
#include "mba_vo/simulation/renderer.h"

namespace mba_vo::test {

/// A file that is gone with its owner.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content = "") {
    static int count = 0;
    name_ = (std::filesystem::temp_directory_path() /
             ("mba_vo_motion_" + std::to_string(::getpid()) + "_" + std::to_string(count++) + ".txt"))
                .string();
    std::ofstream(name_) << content;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(name_); }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

inline std::string motionLine(double t, const SE3& pose) {
  char line[200];
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  std::snprintf(line, sizeof(line), "%.4f %.6f %.6f %.6f %.8f %.8f %.8f %.8f\n", t, p.x(), p.y(), p.z(), q.x(), q.y(),
                q.z(), q.w());
  return line;
}

/// A motion sampled at 100 Hz, from t = 0.
inline std::string motionText(const PoseFunction& pose, double duration) {
  std::string text = "# t tx ty tz qx qy qz qw\n";
  for (int i = 0; 0.01 * i <= duration + 1e-9; ++i) text += motionLine(0.01 * i, pose(0.01 * i));
  return text;
}

/// A hand-held motion through a space of any size, not over the origin.
inline PoseFunction roaming(const Eigen::Vector3d& half_size, double duration, double path_length) {
  const HandHeldMotion motion({4, duration, 0.5, path_length}, FreeSpace{{12.0, -3.0, 0.2}, half_size});
  return [motion](double t) { return motion.pose(t); };
}

}  // namespace mba_vo::test
