#include "mba_vo/io/online_record.h"

#include <cerrno>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "mba_vo/io/frames_csv.h"

namespace mba_vo {
namespace {

std::ofstream open(const std::filesystem::path& file) {
  errno = 0;
  std::ofstream stream(file);
  if (!stream) throw std::runtime_error(cannotBeWritten(file.string()));
  return stream;
}

}  // namespace

OnlineRecord::OnlineRecord(const std::string& folder) : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder + ": cannot be made: " + error.message());
  const std::filesystem::path path(folder);
  trajectory_file_ = open(path / "online_trajectory.txt");
  exposures_file_ = open(path / "online_exposure_trajectory.txt");
  odometry_file_ = open(path / "online_odometry.txt");
  frames_file_ = open(path / "frames.csv");
  trajectory_ = std::make_unique<PoseLines>(trajectory_file_, kOnlineTrajectory);
  exposures_ = std::make_unique<ExposureLines>(exposures_file_, kOnlineTrajectory);
  odometry_ = std::make_unique<PoseLines>(odometry_file_, kOnlineOdometry);
  writeFramesHeader(frames_file_);
}

void OnlineRecord::add(const PublishedImage& image) {
  writeShed(image.step.sequence);
  write(recordOf(image));
}

void OnlineRecord::addShed(const TrackerStep& step) {
  const std::lock_guard<std::mutex> lock(shed_mutex_);
  shed_[step.sequence] = step;
}

void OnlineRecord::finish() { writeShed(std::numeric_limits<std::uint64_t>::max()); }

/// Those before number `end`.
void OnlineRecord::writeShed(std::uint64_t end) {
  while (const std::optional<TrackerStep> step = takeShed(end)) write(recordOf({*step, 0.0}));
}

std::optional<TrackerStep> OnlineRecord::takeShed(std::uint64_t end) {
  const std::lock_guard<std::mutex> lock(shed_mutex_);
  if (shed_.empty() || shed_.begin()->first >= end) return std::nullopt;
  return shed_.extract(shed_.begin()).mapped();
}

void OnlineRecord::write(const FrameRecord& record) {
  if (failed_) return;
  errno = 0;
  writeFrame(record, frames_file_);
  if (record.online) {
    trajectory_->write(record.mid_exposure_ns, record.online->map, record.online->in_map.T_reference_mid);
    exposures_->write(record.mid_exposure_ns, record.online->map, record.online->in_map);
    odometry_->write(record.mid_exposure_ns, record.online->map, record.online->T_odom_camera);
  }
  // A run that is killed leaves what it has published.
  failed_ = !frames_file_.flush() || !trajectory_file_.flush() || !exposures_file_.flush() || !odometry_file_.flush();
  if (failed_) {
    throw std::runtime_error(cannotBeWritten(folder_) + "; what is published is no longer written down");
  }
}

}  // namespace mba_vo
