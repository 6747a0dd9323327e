#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <mba_vo/ExposureStamped.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Empty.h>
#include <pluginlib/class_list_macros.hpp>

#include "calibration_store.h"
#include "diagnostics_publisher.h"
#include "image_source.h"
#include "mba_vo/ros/exposure_watch.h"
#include "node_constants.h"
#include "published_topics.h"
#include "tracker_worker.h"

namespace mba_vo {
namespace {

constexpr int kInputQueue = 100;      // shorter ones lose images without a word under load
constexpr double kPollPeriod = 0.01;  // [s] how often images that wait are looked at
constexpr int kLooks = 5;             // for each the master is asked

double steadySeconds() { return ros::SteadyTime::now().toSec(); }

}  // namespace

/// The tracker's doors to ROS. Callbacks only hand things on to the worker.
class TrackerNodelet final : public nodelet::Nodelet {
 public:
  TrackerNodelet() = default;
  ~TrackerNodelet() override { disconnect(); }
  TrackerNodelet(const TrackerNodelet&) = delete;
  TrackerNodelet& operator=(const TrackerNodelet&) = delete;

 private:
  void onInit() override {
    try {
      start(getNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());  // the loader would only say that it failed
      disconnect();
      throw;
    }
  }

  void start(ros::NodeHandle& nh) {
    const NodeConfig config = parseNodeConfig(readParameters(nh));
    no_image_warning_ = config.no_image_warning;
    ImageAssemblerOptions options;
    options.fixed_exposure = config.fixedExposure();
    options.exposure_wait = config.exposure_wait;
    options.calibration_wait = config.calibration_wait;
    options.depth_wait = config.depth_wait;
    options.depth_tolerance = config.depth_tolerance;
    assembler_ = std::make_unique<ImageAssembler>(options);
    status_ = std::make_unique<StatusReporter>(nh);
    calibration_ = std::make_unique<CalibrationStore>(nh.resolveName("camera_info"), config.rectified);
    exposure_watch_ =
        std::make_unique<ExposureWatch>(config.fixedExposure() ? "exposure_time" : nh.resolveName("exposure"));
    worker_ = std::make_unique<TrackerWorker>(nh, config, *status_);
    diagnostics_ = std::make_unique<TrackerDiagnostics>(nh, getPrivateNodeHandle(), getName());
    connect(nh, config);
  }

  void connect(ros::NodeHandle& nh, const NodeConfig& config) {
    const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
    reference_subscriber_ = nh.subscribe("reference", kInputQueue, &TrackerNodelet::onReference, this, no_delay);
    info_subscriber_ = nh.subscribe("camera_info", kInputQueue, &TrackerNodelet::onCameraInfo, this, no_delay);
    exposure_subscriber_ = nh.subscribe("exposure", kInputQueue, &TrackerNodelet::onExposure, this, no_delay);
    images_ = std::make_unique<ImageSource>(
        nh, getPrivateNodeHandle(), "image", "image_transport", config.image_transport,
        [this](const auto& image, const std::string& problem) { onImage(image, problem); });
    depths_ = std::make_unique<ImageSource>(
        nh, getPrivateNodeHandle(), "depth", "depth_transport", config.depth_transport,
        [this](const auto& depth, const std::string& problem) { onDepth(depth, problem); });
    reset_server_ = nh.advertiseService("reset", &TrackerNodelet::onReset, this);
    poll_timer_ = nh.createSteadyTimer(ros::WallDuration(kPollPeriod), &TrackerNodelet::onPoll, this);
    status_timer_ = nh.createSteadyTimer(ros::WallDuration(kStatusPeriod), &TrackerNodelet::onStatusTimer, this);
    last_image_ = steadySeconds();
  }

  /// To be done before an exception leaves, too: the loader then destroys the callback queues before the nodelet.
  void disconnect() {
    poll_timer_.stop();
    status_timer_.stop();
    reset_server_.shutdown();
    images_.reset();
    depths_.reset();
    info_subscriber_.shutdown();
    exposure_subscriber_.shutdown();
    reference_subscriber_.shutdown();
    diagnostics_.reset();
    if (worker_) handOn(std::numeric_limits<double>::infinity());  // images that wait for their exposures
    worker_.reset();
    status_.reset();
  }

  void onImage(const sensor_msgs::ImageConstPtr& image, const std::string& problem) {
    last_image_ = steadySeconds();
    any_image_ = true;
    assembler_->expectExposures(exposure_subscriber_.getNumPublishers() > 0);
    status_->imageReceived(assembler_->addImage(image, last_image_, problem));
    handOn();
  }

  void onExposure(const ExposureStampedConstPtr& exposure) {
    assembler_->addExposure(toNanoseconds(exposure->header.stamp), exposure->exposure_time);
    handOn();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& depth, const std::string& problem) {
    if (!problem.empty()) {
      NODELET_WARN_STREAM_THROTTLE(kWarnPeriod, "depth image is not used: " << problem);
      return;
    }
    assembler_->addDepth(depth, steadySeconds());
    handOn();
  }

  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    const std::shared_ptr<const CameraCalibration> before = calibration_->get();
    if (calibration_->set(*info)) {
      if (calibration_->get() != before) worker_->setCalibration(*calibration_->get());
      assembler_->setCalibrated();
      calibrated_ = true;
    } else {
      NODELET_ERROR_STREAM_THROTTLE(kWarnPeriod, calibration_->problem());
    }
  }

  void onReference(const ReferenceMessageConstPtr& reference) {
    if (reference->reference) {
      worker_->addReference(reference);
    } else {
      NODELET_ERROR_STREAM_THROTTLE(kWarnPeriod, "a message on " << reference_subscriber_.getTopic()
                                                                 << " came from another process and carries no map: "
                                                                    "load tracker and mapper into one manager");
    }
  }

  bool onReset(std_srvs::Empty::Request& /*request*/, std_srvs::Empty::Response& /*response*/) {
    worker_->reset();
    return true;
  }

  void onPoll(const ros::SteadyTimerEvent& /*event*/) { handOn(); }

  void onStatusTimer(const ros::SteadyTimerEvent& /*event*/) {
    const double silence = steadySeconds() - last_image_;
    const bool silent = silence > no_image_warning_;
    if (any_image_ && looks_ < kLooks) lookAtOptionalTopics();
    const std::string problem = silent ? missingImages(silence) : problemOfInput();
    if (!problem.empty()) {
      NODELET_WARN_STREAM_THROTTLE(kWarnPeriod, problem);
    }
    status_->publish({problem, silent}, worker_->queueBytes());
    diagnose(problem);
  }

  void diagnose(const std::string& missing) {
    TrackerHealth health;
    health.now = status_->snapshot();
    health.latency = worker_->latency();
    health.missing_input = missing;
    if (const auto calibration = calibration_->get()) {
      health.calibration = describe(*calibration) + (worker_->isCorrected() ? ", corrected by the images" : "");
    }
    diagnostics_->update(std::move(health));
  }

  std::string missingImages(double silence) const {
    const std::string since = any_image_ ? " for " + std::to_string(static_cast<int>(silence)) + " s" : " yet";
    const std::string why =
        images_->knowsType() ? whyNothingComes(images_->topic(), images_->type(), publishedTopics()) : "";
    return "no image on " + images_->topic() + since + ": " +
           (why.empty() ? "it has " + std::to_string(images_->publishers()) + " publishers" : why);
  }

  /// Of what has to come beside the images, or is wrong with it; empty if all is well.
  std::string problemOfInput() const {
    if (!any_image_) return "no image yet";
    if (const std::string problem = calibration_->problem(); !problem.empty()) {
      const std::string why = whyFrom(info_subscriber_, "sensor_msgs/CameraInfo");
      return problem + (why.empty() ? "" : ": " + why);
    }
    if (reference_subscriber_.getNumPublishers() == 0) {
      return "there is no mapper: nobody publishes " + reference_subscriber_.getTopic() +
             "; load mba_vo/Mapper into the manager of the tracker";
    }
    return wrong_topic_.empty() ? exposure_watch_->advice() : wrong_topic_;
  }

  /// Whether they are there, but of another type.
  void lookAtOptionalTopics() {
    ++looks_;
    wrong_topic_.clear();
    const TopicTypes published = publishedTopics();
    const auto look = [&](const std::string& topic, const std::string& type) {
      const std::string why = published.count(topic) > 0 ? whyNothingComes(topic, type, published) : "";
      if (!why.empty()) wrong_topic_ = topic + " is not read: " + why;
    };
    if (depths_->knowsType()) look(depths_->topic(), depths_->type());
    look(exposure_subscriber_.getTopic(), kExposureType);
  }

  static std::string whyFrom(const ros::Subscriber& subscriber, const std::string& type) {
    if (subscriber.getNumPublishers() > 0) return "";
    return whyNothingComes(subscriber.getTopic(), type, publishedTopics());
  }

  void handOn(double now = steadySeconds()) {
    for (InputImage& image : assembler_->takeReady(now)) {
      if (!calibrated_ && image.problem.empty()) image.problem = calibration_->problem();
      exposure_watch_->add(toNanoseconds(image.message->header.stamp), image.exposure, image.exposure_unmatched);
      worker_->addImage(image);
    }
  }

  // Callbacks come one at a time, so these need no lock.
  std::unique_ptr<ImageAssembler> assembler_;
  double last_image_ = 0.0;  // steady clock [s]
  bool any_image_ = false;
  bool calibrated_ = false;        // at some time
  double no_image_warning_ = 0.0;  // [s]
  int looks_ = 0;                  // at the optional topics
  std::string wrong_topic_;        // what they found

  std::unique_ptr<StatusReporter> status_;
  std::unique_ptr<CalibrationStore> calibration_;
  std::unique_ptr<TrackerWorker> worker_;
  std::unique_ptr<ExposureWatch> exposure_watch_;
  std::unique_ptr<ImageSource> images_;
  std::unique_ptr<ImageSource> depths_;
  std::unique_ptr<TrackerDiagnostics> diagnostics_;
  ros::Subscriber info_subscriber_;
  ros::Subscriber exposure_subscriber_;
  ros::Subscriber reference_subscriber_;
  ros::ServiceServer reset_server_;
  ros::SteadyTimer poll_timer_;
  ros::SteadyTimer status_timer_;
};

}  // namespace mba_vo

PLUGINLIB_EXPORT_CLASS(mba_vo::TrackerNodelet, nodelet::Nodelet)
