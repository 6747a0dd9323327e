#include "mba_vo/ros/camera_driver.h"

#include <cv_bridge/cv_bridge.h>
#include <mba_vo/ExposureStamped.h>

#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {
namespace {

constexpr int kQueue = 100;                      // shorter ones lose images without a word under load
constexpr std::int64_t kPatience = 100'000'000;  // how long the end of the node may wait for an image [ns]

}  // namespace

CameraDriver::CameraDriver(const ros::NodeHandle& nh, const CameraConfig& config,
                           const std::shared_ptr<DeviceCalls>& calls)
    : nh_(nh), config_(config), camera_(openCamera(config.camera, calls, systemClock())) {
  const std::string own = config.camera_info_url.empty() ? camera_->calibrationFile() : config.camera_info_url;
  calibration_ =
      std::make_unique<CalibrationKeeper>(nh, config.camera_name, own, config.field_of_view, config.calibration_camera);
  image_transport::ImageTransport transport(nh_);
  exposure_publisher_ = nh_.advertise<ExposureStamped>("exposure", kQueue);
  info_publisher_ = nh_.advertise<sensor_msgs::CameraInfo>("camera_info", kQueue);
  image_publisher_ = transport.advertise("image_raw", kQueue);
  if (ros::Time::isSimTime()) {
    ROS_WARN_STREAM(nh_.getNamespace() << ": use_sim_time is set, but its images are stamped with wall time");
  }
  thread_ = std::thread([this] { run(); });
}

CameraDriver::~CameraDriver() {
  running_ = false;
  thread_.join();
}

void CameraDriver::waitForListener() const {
  if (isDevice(config_.camera.device.path) || image_publisher_.getNumSubscribers() > 0) return;
  ROS_INFO_STREAM(nh_.getNamespace() << ": playing begins when somebody listens to " << image_publisher_.getTopic());
  while (running_ && image_publisher_.getNumSubscribers() == 0) {
    ros::WallDuration(1e-9 * static_cast<double>(kPatience)).sleep();
  }
}

void CameraDriver::run() try {
  waitForListener();
  while (running_) {
    const CameraEvent event = camera_->next(kPatience);
    if (const auto* image = std::get_if<CapturedImage>(&event)) {
      publish(*image);
    } else if (const auto* notice = std::get_if<CameraNotice>(&event)) {
      ROS_LOG_STREAM(notice->warning ? ros::console::levels::Warn : ros::console::levels::Info, ROSCONSOLE_DEFAULT_NAME,
                     nh_.getNamespace() << ": " << notice->text);
    } else if (std::holds_alternative<EndOfRecording>(event)) {
      ROS_INFO_STREAM(nh_.getNamespace() << ": end of the recording, " << published_ << " images published");
      break;
    }
  }
  ended_ = true;
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(nh_.getNamespace() << ": " << error.what());
  ended_ = true;
}

void CameraDriver::publish(const CapturedImage& captured) {
  tellCalibration(captured.image.size());
  std_msgs::Header header;
  header.seq = static_cast<std::uint32_t>(captured.number);  // gaps tell the tracker what is missing
  header.stamp = toRosTime(stampOf(captured.mid_exposure_ns, captured.exposure, config_.stampReference()));
  header.frame_id = config_.frame_id;
  const auto exposure = boost::make_shared<ExposureStamped>();
  exposure->header = header;
  exposure->exposure_time = exposureToMessage(captured.exposure);
  exposure_publisher_.publish(exposure);
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>(calibration_->infoFor(captured.image.size()));
  info->header = header;
  info_publisher_.publish(info);
  // By pointer: within the tracker's process nothing is copied.
  image_publisher_.publish(cv_bridge::CvImage(header, encodingOf(captured.image), captured.image).toImageMsg());
  ++published_;
}

void CameraDriver::tellCalibration(const cv::Size& size) {
  const std::string problem = calibration_->problem(size);
  if (problem == last_problem_) return;
  last_problem_ = problem;
  if (problem.empty()) {
    ROS_INFO_STREAM(nh_.getNamespace() << ": the camera is calibrated now");
  } else {
    ROS_WARN_STREAM(nh_.getNamespace() << ": " << problem);
  }
}

}  // namespace mba_vo
