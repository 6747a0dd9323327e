#include "mba_vo/io/frames_csv.h"

#include <iomanip>
#include <optional>
#include <sstream>
#include <string>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

constexpr int kMicroseconds = 6;
constexpr int kCovarianceDigits = 10;  // a motion that odometry has missed leaves far larger variances than others

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' ? "\"\"" : std::string(1, c == '\n' ? ' ' : c);
  }
  return result + "\"";
}

template <typename Value>
std::string optionalText(const std::optional<Value>& value, int decimals) {
  std::ostringstream text;
  if (value) {
    text << std::fixed << std::setprecision(decimals) << *value;
  }
  return text.str();
}

/// The upper triangle, row by row.
std::string upperTriangle(const Matrix6& matrix) {
  std::ostringstream text;
  text << std::setprecision(kCovarianceDigits);
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      text << (row + column > 0 ? " " : "") << matrix(row, column);
    }
  }
  return text.str();
}

/// Covariance of the pose, velocity and its covariance.
std::string uncertaintyText(const std::optional<OnlinePose>& pose) {
  if (!pose) return ",,";
  std::ostringstream text;
  const Eigen::IOFormat in_a_row(kMicroseconds, Eigen::DontAlignCols);
  text << upperTriangle(pose->covariance) << "," << pose->in_map.velocity.transpose().format(in_a_row) << ","
       << upperTriangle(pose->velocity_covariance);
  return text.str();
}

}  // namespace

void writeFramesHeader(std::ostream& out) {
  out << "sequence,time,stamp,exposure,status,reason,map,blur_px,points,residual,error_px,tracking_ms,mapping_ms,"
         "message,arrival,published,online_status,covariance,twist,twist_covariance\n";
}

void writeFrame(const FrameRecord& frame, std::ostream& out) {
  out << std::fixed << std::setprecision(3);
  out << frame.sequence << "," << formatSeconds(frame.mid_exposure_ns) << "," << formatSeconds(frame.stamp_ns) << ","
      << optionalText(frame.exposure, kMicroseconds) << "," << frame.status << "," << quoted(frame.reason) << ","
      << optionalText(frame.map, 0) << "," << optionalText(frame.blur_length_px, 2) << ","
      << optionalText(frame.points_used, 0) << "," << optionalText(frame.residual_rms, 3) << ","
      << optionalText(frame.pixel_error, 3) << "," << frame.tracking_ms << "," << frame.mapping_ms << ","
      << quoted(frame.message) << "," << optionalText(std::optional<double>(frame.arrival), kMicroseconds) << ","
      << optionalText(frame.published, kMicroseconds) << "," << frame.online_status << ","
      << uncertaintyText(frame.online) << "\n";
}

void writeFrames(const std::vector<FrameRecord>& frames, std::ostream& out) {
  writeFramesHeader(out);
  for (const FrameRecord& frame : frames) writeFrame(frame, out);
}

}  // namespace mba_vo
