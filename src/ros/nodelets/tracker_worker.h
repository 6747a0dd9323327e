#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "calibration_store.h"
#include "extrinsic.h"
#include "mba_vo/odometry/input_guard.h"
#include "mba_vo/odometry/tracking_loop.h"
#include "mba_vo/ros/bounded_queue.h"
#include "mba_vo/ros/image_assembler.h"
#include "mba_vo/ros/intra_process_messages.h"
#include "motion_publisher.h"
#include "status_reporter.h"

namespace mba_vo {

/// The tracker's own thread: takes images from a bounded queue, tracks them against the newest reference, publishes.
/// All public functions return at once and may be called from any thread.
class TrackerWorker {
 public:
  TrackerWorker(ros::NodeHandle& nh, const NodeConfig& config, CalibrationStore& calibration, StatusReporter& status);
  ~TrackerWorker();

  void addImage(const InputImage& image);
  void addReference(const ReferenceMessageConstPtr& reference);
  void reset();
  std::size_t queueBytes() const { return queue_.bytes(); }

 private:
  struct Reset {};
  struct NewReference {};  // it is among references_
  using Job = std::variant<InputImage, Reset, NewReference>;

  static std::size_t bytesOf(const Job& job);
  static std::size_t mostDispensable(const std::deque<Job>& jobs);

  void run();
  void beginSession(bool keep_map);
  void process(const InputImage& image);
  /// Null if the image is of no use; the status then says why.
  FrameConstPtr makeFrame(const InputImage& image);
  /// Empty if there is none of any use.
  cv::Mat1f depthOf(const InputImage& image) const;
  void updateFrameBuilder();
  void adoptReferences();
  /// Frames that waited for the first reference of a map are tracked; newer references are adopted in between. Frames
  /// that are tracked once more do not hold up an image.
  void catchUp(bool image_waits);
  /// Images are soon made as the mapper believes they should be.
  void correctCalibration(const CalibrationCorrection& correction);
  void forward(const TrackedFrameConstPtr& tracked, bool has_reference);
  MeasuredMotion motionOf(const TrackedFrameConstPtr& tracked, const SE3& T_odom_camera);
  double secondsSinceMeasured(const Frame& frame) const;
  void publishMotion(const TrackedFrameConstPtr& tracked);
  /// False if the frame is not lost, or for too long, or TF is not to be predicted.
  bool publishPrediction(const TrackedFrameConstPtr& tracked);

  const NodeConfig config_;
  CalibrationStore& calibration_;
  StatusReporter& status_;
  const PhotometricCalibration photometric_;
  const StampReference stamp_reference_;
  ros::Publisher tracked_frames_;
  MotionPublisher motions_;

  BoundedQueue<Job> queue_;
  std::mutex references_mutex_;
  std::vector<ReferenceMessageConstPtr> references_;  // arrived, not adopted yet

  // Of the thread alone from here on.
  InputGuard guard_;
  TrackingLoop loop_;
  std::shared_ptr<const CameraCalibration> built_for_;
  std::unique_ptr<FrameBuilder> builder_;
  CalibrationCorrection correction_;                         // that it makes images with, or next_builder_ will
  std::future<std::unique_ptr<FrameBuilder>> next_builder_;  // in the making
  std::string camera_frame_;
  Extrinsic extrinsic_;
  std::uint64_t session_ = 0;
  bool keep_map_ = true;
  std::uint64_t next_number_ = 0;
  std::int64_t last_measured_ns_ = 0;  // mid-exposure; 0 = none

  std::thread thread_;
};

}  // namespace mba_vo
