#include "mba_vo/simulation/motion_file.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

constexpr double kLongestGap = 0.2;      // [s]; to fill a longer one would be to invent a motion
constexpr double kLargestTurn = 45.0;    // [deg] from line to line, beyond which the way between is anyone's guess
constexpr double kNormTolerance = 0.01;  // of a quaternion; six digits keep it within 1e-6
constexpr std::size_t kFewestPoses = 4;  // for a cubic

/// Says what is wrong with a line of a file.
class LineReader {
 public:
  LineReader(const std::string& file, int number) : file_(file), number_(number) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(file_ + ":" + std::to_string(number_) + ": " + what);
  }

  TimedPose read(const std::string& line) const {
    std::istringstream words(line);
    double values[8];
    for (double& value : values) {
      if (!(words >> value) || !std::isfinite(value)) fail("'" + line + "' is not t tx ty tz qx qy qz qw");
    }
    std::string more;
    if (words >> more) fail("'" + more + "' follows the eight numbers of a pose");
    const Eigen::Quaterniond rotation(values[7], values[4], values[5], values[6]);
    if (std::abs(rotation.norm() - 1.0) > kNormTolerance) {
      fail("the quaternion's length is " + std::to_string(rotation.norm()) + ", not 1");
    }
    return {values[0], SE3(rotation, {values[1], values[2], values[3]})};
  }

  void checkStep(const TimedPose& before, const TimedPose& pose) const {
    const double step = pose.t - before.t;
    if (step <= 0.0) fail("time " + std::to_string(pose.t) + " s does not follow " + std::to_string(before.t) + " s");
    if (step > kLongestGap) {
      fail("no pose for " + std::to_string(step) + " s; at most " + std::to_string(kLongestGap) + " s may be left out");
    }
    const double turn =
        kDegreesPerRadian * before.T_world_camera.rotation().angularDistance(pose.T_world_camera.rotation());
    if (turn > kLargestTurn) {
      fail("the camera turns by " + std::to_string(turn) + " degrees from the pose before; at most " +
           std::to_string(kLargestTurn) + " are allowed");
    }
  }

 private:
  const std::string& file_;
  int number_;
};

}  // namespace

std::vector<TimedPose> readMotionFile(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::vector<TimedPose> poses;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    const LineReader reader(file, ++number);
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const TimedPose pose = reader.read(line);
    if (!poses.empty()) reader.checkStep(poses.back(), pose);
    poses.push_back(pose);
  }
  if (poses.size() < kFewestPoses) {
    throw std::runtime_error(file + ": " + std::to_string(poses.size()) + " poses; a motion needs at least " +
                             std::to_string(kFewestPoses));
  }
  return poses;
}

}  // namespace mba_vo
