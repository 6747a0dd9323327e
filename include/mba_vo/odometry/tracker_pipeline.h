#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mba_vo/odometry/bounded_queue.h"
#include "mba_vo/odometry/image_intake.h"
#include "mba_vo/odometry/pipeline_messages.h"
#include "mba_vo/odometry/tracking_load.h"
#include "mba_vo/odometry/tracking_loop.h"
#include "mba_vo/trajectory/odometry_covariance.h"

namespace mba_vo {

/// What one step of the tracker half did.
struct TrackerStep {
  enum class Kind {
    kImage,     // an image has its result: the first one, that which is published
    kLate,      // a frame that had to wait, or is tracked once more, has another result
    kRepeated,  // an image shows an earlier one again: it has the result of that one
    kRejected,  // an image is of no use
    kShed,      // an image has been left out because too many wait
    kReset,     // what went before has been forgotten
    kPassed     // nothing that anybody has to know
  };
  Kind kind = Kind::kPassed;
  std::uint64_t sequence = 0;        // of the image, also below
  std::int64_t stamp_ns = 0;         // [ns]
  std::int64_t mid_exposure_ns = 0;  // [ns]
  double arrival = 0.0;              // when it came in, as it was told [s]
  std::optional<double> exposure;    // that it came with, if it can be true [s]
  bool exposure_from_topic = false;
  std::string reason;                    // why it was rejected, what is wrong with it, or why all was reset
  std::string notice;                    // what is done differently from this image on; seldom
  bool contradicts_calibration = false;  // rejected because it is not of the calibration's size or kind
  bool began_anew = false;               // what went before has been forgotten first
  double build_ms = 0.0;                 // time taken to make a frame of the image
  bool failed_leap = false;              // a frame that waits was tried, and is too far away
  std::vector<TrackerMessage> placed;  // further ones, for the mapper half, after `message`: frames that were left out
  TrackerMessage message;              // for the mapper half; without `tracked` there is none
  TrackedFrameConstPtr repeated;  // of a repeated image: what was found for the earlier one, under the stamp of this
  TrackingPhase phase = TrackingPhase::kNoMap;  // afterwards
  SE3 T_odom_camera;                            // at mid-exposure, of an image with a pose
  BodyMotion motion;                            // about then, in the camera's axes
  SE3 T_map_odom;
  MotionCovariance covariance;                 // of an image with a pose or an orientation
  std::optional<SE3> predicted_T_odom_camera;  // of an image that is not aligned to the map in use

  /// It says what became of an image that came in.
  bool endsImage() const { return kind == Kind::kImage || kind == Kind::kRepeated || kind == Kind::kRejected; }
};

/// Of an image that is left out: the step that says so.
TrackerStep stepOfShed(const CameraImage& image, const std::string& reason);

struct TrackerPipelineConfig {
  OdometryConfig odometry;
  PhotometricCalibration photometric;
  std::size_t max_queue_bytes = 64000000;  // of images that wait for the tracker
  bool correct_in_background = false;      // see ImageIntake
};

/// The tracker half of the pipeline: images and references go in at any time, from any thread; step(), which one thread
/// calls, does the next piece of work. What comes first is decided here and nowhere else, by the phase of the tracking:
/// see `turn` in the source.
class TrackerPipeline {
 public:
  explicit TrackerPipeline(const TrackerPipelineConfig& config, std::uint64_t first_session = 1);

  // What comes in. Thread-safe.

  /// `arrival` [s] on the caller's clock. Returns the images that had to be shed, because too many wait.
  std::vector<CameraImage> addImage(CameraImage image, double arrival = 0.0);
  void addFrame(const FrameConstPtr& frame);
  void addReference(const MapperMessage& reference);
  /// Another calibration of the camera ends what went before, once there was one. `known`: how it is to be corrected.
  void setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known = {});
  void requestReset();
  std::size_t queueBytes() const { return queue_.bytes(); }
  std::size_t queuedJobs() const { return queue_.size(); }

  // The rest is for the one thread.

  void adoptReferences();
  /// nullopt if there is nothing to do until something comes in. Throws what the tracker throws; a reset then helps.
  std::optional<TrackerStep> step();
  /// As if step() had said so: the next image has not had to wait. For a run in which no time passes.
  void rest() { idle_since_image_ = true; }
  /// As step(), of frames that wait alone, and no keyframe is waited for: there will be none.
  std::optional<TrackerStep> finishStep();
  /// References that were taken since the last call, and how many were of no use.
  std::vector<ReferenceConstPtr> takeAdopted();
  std::size_t takeStale();
  /// True if the calibration was corrected by one of them.
  bool takeCorrected();
  /// The image that the last step took, also if it has thrown; nullopt if it did something else.
  const std::optional<TrackerStep>& imageInWork() const { return in_work_; }
  /// Those that wait, for whoever ends: nothing will be done with them, nor with whatever else waits.
  std::vector<CameraImage> takeImages();

  const TrackingLoop& tracking() const { return loop_; }

 private:
  struct KnownCamera {
    CameraCalibration calibration;
    CalibrationCorrection correction;
  };
  struct ResetRequest {};
  using Job = std::variant<CameraImage, FrameConstPtr, KnownCamera, ResetRequest>;
  enum class Turn { kQueue, kWaitingFrame, kNothing };

  static std::size_t bytesOf(const Job& job);
  static std::size_t mostDispensable(const std::deque<Job>& jobs);
  Turn turn() const;
  std::optional<TrackerStep> nextStep();
  std::optional<TrackerStep> withPhase(std::optional<TrackerStep> step) const;
  TrackerStep takeJob();
  /// What is to be said of it; may be empty.
  std::string relieve();
  TrackerStep takeImage(const CameraImage& image);
  TrackerStep takeFrame(const FrameConstPtr& frame);
  TrackerStep takeCalibration(const KnownCamera& camera);
  std::optional<TrackerStep> trackWaiting(bool may_hold);
  Backlog backlog() const;
  TrackerStep reset(const std::string& reason);
  void beginSession();
  void track(const FrameConstPtr& frame, bool frozen, TrackerStep& step);
  void addResult(const TrackedFrameConstPtr& tracked, TrackerStep& step);
  void repeat(const CameraImage& image, TrackerStep& step) const;
  TrackerMessage messageOf(const TrackedFrameConstPtr& tracked) const;

  BoundedQueue<Job> queue_;
  std::mutex references_mutex_;
  std::vector<MapperMessage> references_;  // arrived, not adopted yet

  // Of the one thread from here on.
  ImageIntake intake_;
  TrackingLoop loop_;
  TrackingLoad load_;
  OdometryCovariance covariance_;
  std::optional<TrackerStep> in_work_;
  TrackerStep last_;  // of the newest image that had a result of its own
  std::uint64_t session_;
  std::string camera_frame_;       // of the newest image
  bool late_since_image_ = false;  // a waiting frame has been tracked since the last image
  bool idle_since_image_ = true;   // nothing was left to do
  bool keep_map_ = true;
  bool told_of_leaps_ = false;
  std::vector<ReferenceConstPtr> adopted_;
  std::size_t stale_ = 0;
  bool corrected_ = false;
};

}  // namespace mba_vo
