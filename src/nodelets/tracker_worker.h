#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "extrinsic.h"
#include "mba_vo/io/camera_memory.h"
#include "mba_vo/io/online_record.h"
#include "mba_vo/odometry/pipeline_thread.h"
#include "mba_vo/odometry/tracker_pipeline.h"
#include "mba_vo/ros/image_assembler.h"
#include "mba_vo/ros/intra_process_messages.h"
#include "motion_publisher.h"
#include "status_reporter.h"
#include "tracker_console.h"
#include "view_publisher.h"

namespace mba_vo {

/// The tracker half of the pipeline with a thread of its own, and what it has to say to ROS. All public functions
/// return at once and may be called from any thread.
class TrackerWorker {
 public:
  TrackerWorker(ros::NodeHandle& nh, const NodeConfig& config, StatusReporter& status);
  ~TrackerWorker();
  TrackerWorker(const TrackerWorker&) = delete;
  TrackerWorker& operator=(const TrackerWorker&) = delete;

  void addImage(const InputImage& image);
  void addReference(const ReferenceMessageConstPtr& reference);
  void setCalibration(const CameraCalibration& calibration);
  void reset();
  std::size_t queueBytes() const { return pipeline_.queueBytes(); }
  /// Of the newest image, from its arrival to its result [s]; NaN = none yet.
  double latency() const { return latency_; }
  /// The calibration is corrected, by what the images say.
  bool isCorrected() const { return corrected_; }

 private:
  bool step();
  void recover(const std::string& what);
  void tellAdopted();
  void keepLearnt(const CalibrationCorrection& correction);
  void forward(const TrackerMessage& message);
  void publishImage(const TrackerStep& step);
  void publishMotion(const TrackerStep& step);
  void publishRepeated(const TrackerStep& step);
  /// False if the frame is not lost, or for too long, or TF is not to be predicted.
  bool publishPrediction(const TrackerStep& step);
  void record(const TrackerStep& step);
  void recordShed(const CameraImage& image, const std::string& reason);
  TrackerStep numbered(TrackerStep step) const;
  /// Of an image, for people.
  std::string nameOf(const TrackerStep& step) const;
  MeasuredMotion motionOf(const TrackerStep& step, const TrackedFrameConstPtr& tracked, const SE3& T_odom_camera);
  double secondsSinceMeasured(const Frame& frame) const;

  const NodeConfig config_;
  const std::uint64_t first_sequence_;  // what the outside is told begins at 0
  const StampReference stamp_reference_;
  CameraMemory memory_;
  StatusReporter& status_;
  ros::Publisher tracked_frames_;
  MotionPublisher motions_;
  ViewPublisher view_;
  std::atomic<double> latency_{std::numeric_limits<double>::quiet_NaN()};
  std::atomic<bool> corrected_{false};
  TrackerPipeline pipeline_;
  const std::unique_ptr<OnlineRecord> record_;  // null: nothing is written

  // Of the thread alone from here on.
  Extrinsic extrinsic_;
  bool recorded_ = false;          // the image that is being worked on
  std::uint64_t next_number_ = 0;  // of the frames forwarded in this session
  std::uint64_t session_ = 0;
  std::optional<CalibrationCorrection> kept_;  // for the next start
  std::int64_t last_measured_ns_ = 0;          // mid-exposure; 0 = none
  TrackerConsole console_;

  PipelineThread thread_;  // the last one: it ends first
};

}  // namespace mba_vo
