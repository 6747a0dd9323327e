#include <memory>
#include <string>
#include <utility>

#include <image_transport/image_transport.h>
#include <mba_vo/ExposureStamped.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Empty.h>
#include <pluginlib/class_list_macros.hpp>

#include "calibration_store.h"
#include "diagnostics_publisher.h"
#include "tracker_worker.h"

namespace mba_vo {
namespace {

constexpr int kInputQueue = 100;       // shorter ones lose images without a word under load
constexpr double kPollPeriod = 0.01;   // [s] how often images that wait are looked at
constexpr double kStatusPeriod = 1.0;  // [s]
constexpr double kWarnPeriod = 5.0;    // [s]
constexpr double kNumbersPerSecond = 1e3;

double steadySeconds() { return ros::SteadyTime::now().toSec(); }

}  // namespace

/// The tracker's doors to ROS. Callbacks only hand things on to the worker.
class TrackerNodelet final : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      start(getNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());  // the loader would only say that it failed
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
    // The trajectory store knows frames by number: a tracker that is restarted must not use numbers again.
    options.first_sequence = static_cast<std::uint64_t>(kNumbersPerSecond * ros::WallTime::now().toSec());
    assembler_ = std::make_unique<ImageAssembler>(options);
    status_ = std::make_unique<StatusReporter>(nh);
    calibration_ = std::make_unique<CalibrationStore>(nh.resolveName("camera_info"), config.rectified);
    worker_ = std::make_unique<TrackerWorker>(nh, config, *status_);
    diagnostics_ = std::make_unique<TrackerDiagnostics>(nh, getPrivateNodeHandle(), getName());
    connect(nh, config);
  }

  void connect(ros::NodeHandle& nh, const NodeConfig& config) {
    const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
    reference_subscriber_ = nh.subscribe("reference", kInputQueue, &TrackerNodelet::onReference, this, no_delay);
    info_subscriber_ = nh.subscribe("camera_info", kInputQueue, &TrackerNodelet::onCameraInfo, this, no_delay);
    exposure_subscriber_ = nh.subscribe("exposure", kInputQueue, &TrackerNodelet::onExposure, this, no_delay);
    transport_ = std::make_unique<image_transport::ImageTransport>(nh);
    image_subscriber_ = transport_->subscribe(
        "image", kInputQueue, &TrackerNodelet::onImage, this,
        image_transport::TransportHints(config.image_transport, no_delay, getPrivateNodeHandle()));
    depth_subscriber_ = transport_->subscribe(
        "depth", kInputQueue, &TrackerNodelet::onDepth, this,
        image_transport::TransportHints(config.depth_transport, no_delay, getPrivateNodeHandle(), "depth_transport"));
    reset_server_ = nh.advertiseService("reset", &TrackerNodelet::onReset, this);
    poll_timer_ = nh.createSteadyTimer(ros::WallDuration(kPollPeriod), &TrackerNodelet::onPoll, this);
    status_timer_ = nh.createSteadyTimer(ros::WallDuration(kStatusPeriod), &TrackerNodelet::onStatusTimer, this);
    last_image_ = steadySeconds();
  }

  void onImage(const sensor_msgs::ImageConstPtr& image) {
    last_image_ = steadySeconds();
    any_image_ = true;
    assembler_->expectExposures(exposure_subscriber_.getNumPublishers() > 0);
    status_->imageReceived(assembler_->addImage(image, last_image_));
    handOn();
  }

  void onExposure(const ExposureStampedConstPtr& exposure) {
    assembler_->addExposure(toNanoseconds(exposure->header.stamp), exposure->exposure_time);
    handOn();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& depth) {
    assembler_->addDepth(depth, steadySeconds());
    handOn();
  }

  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    const std::shared_ptr<const CameraCalibration> before = calibration_->get();
    if (calibration_->set(*info)) {
      if (calibration_->get() != before) worker_->setCalibration(*calibration_->get());
      assembler_->setCalibrated();
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
    const std::string missing = missingInput();
    if (!missing.empty()) {
      NODELET_WARN_STREAM_THROTTLE(kWarnPeriod, missing);
    }
    status_->publish(missing, worker_->queueBytes());
    diagnose(missing);
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

  std::string missingInput() const {
    const double silence = steadySeconds() - last_image_;
    if (silence > no_image_warning_) {
      const std::string since = any_image_ ? " for " + std::to_string(static_cast<int>(silence)) + " s" : " yet";
      return "no image on " + image_subscriber_.getTopic() + since + ", which has " +
             std::to_string(image_subscriber_.getNumPublishers()) + " publishers";
    }
    return any_image_ ? calibration_->problem() : "no image yet";
  }

  void handOn() {
    for (const InputImage& image : assembler_->takeReady(steadySeconds())) {
      worker_->addImage(image);
    }
  }

  // Callbacks come one at a time, so these need no lock.
  std::unique_ptr<ImageAssembler> assembler_;
  double last_image_ = 0.0;  // steady clock [s]
  bool any_image_ = false;
  double no_image_warning_ = 0.0;  // [s]

  std::unique_ptr<StatusReporter> status_;
  std::unique_ptr<CalibrationStore> calibration_;
  std::unique_ptr<TrackerWorker> worker_;
  std::unique_ptr<TrackerDiagnostics> diagnostics_;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber image_subscriber_;
  image_transport::Subscriber depth_subscriber_;
  ros::Subscriber info_subscriber_;
  ros::Subscriber exposure_subscriber_;
  ros::Subscriber reference_subscriber_;
  ros::ServiceServer reset_server_;
  ros::SteadyTimer poll_timer_;
  ros::SteadyTimer status_timer_;
};

}  // namespace mba_vo

PLUGINLIB_EXPORT_CLASS(mba_vo::TrackerNodelet, nodelet::Nodelet)
