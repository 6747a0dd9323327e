#include "live_odometry.h"

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <std_srvs/Empty.h>

namespace mba_vo {

LiveOdometry::LiveOdometry(const std::string& ns, const std::string& input, std::shared_ptr<nodelet::Loader> manager,
                           bool with_mapper)
    : nh_(ns),
      remappings_{{ns + "/image", input + "/image_raw"},
                  {ns + "/camera_info", input + "/camera_info"},
                  {ns + "/exposure", input + "/exposure"}},
      manager_(manager ? std::move(manager) : std::make_shared<nodelet::Loader>(false)) {
  listen("odometry", &Outputs::odometry);
  listen("pose", &Outputs::pose);
  listen("exposure_motion", &Outputs::exposure_motion);
  listen("status", &Outputs::status);
  listen("mapper/status", &Outputs::mapper_status);
  listen("path", &Outputs::path);
  listen("points", &Outputs::points);
  listen("keyframe/image", &Outputs::keyframe_image);
  listen("keyframe/sharp", &Outputs::keyframe_sharp);
  listen("tracked_frame", &Outputs::tracked_frame);
  listen("reference", &Outputs::reference);
  const boost::function<void(const tf2_msgs::TFMessageConstPtr&)> on_tf = [this](const auto& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    outputs_.transforms.insert(outputs_.transforms.end(), message->transforms.begin(), message->transforms.end());
  };
  subscribers_.push_back(nh_.subscribe<tf2_msgs::TFMessage>("/tf", 1000, on_tf));
  if (with_mapper) load("mapping");
  load("tracking");
}

LiveOdometry::~LiveOdometry() {
  manager_->unload(nh_.resolveName("tracking"));
  manager_->unload(nh_.resolveName("mapping"));
}

void LiveOdometry::load(const std::string& name) {
  const std::string type = name == "mapping" ? "mba_vo/Mapper" : "mba_vo/Tracker";
  if (!manager_->load(nh_.resolveName(name), type, remappings_, {}))
    throw std::runtime_error(type + " cannot be loaded");
}

void LiveOdometry::restart(const std::string& name) {
  if (!manager_->unload(nh_.resolveName(name))) throw std::runtime_error(name + " cannot be ended");
  load(name);
}

template <typename Message>
void LiveOdometry::listen(const std::string& topic, std::vector<boost::shared_ptr<const Message>> Outputs::*list) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> callback = [this, list](const auto& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    (outputs_.*list).push_back(message);
  };
  subscribers_.push_back(nh_.subscribe<Message>(topic, 10000, callback));
}

Outputs LiveOdometry::outputs() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return outputs_;
}

Status LiveOdometry::status() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return outputs_.status.empty() ? Status() : *outputs_.status.back();
}

bool LiveOdometry::waitFor(const std::function<bool(const Outputs&)>& condition, double timeout) const {
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(timeout);
  while (ros::WallTime::now() < deadline) {
    if (condition(outputs())) {
      return true;
    }
    ros::WallDuration(0.05).sleep();
  }
  return false;
}

bool LiveOdometry::waitUntilDone(std::uint64_t images, double timeout) const {
  return waitFor(
      [images](const Outputs& outputs) {
        if (outputs.status.empty() || outputs.mapper_status.empty()) {
          return false;
        }
        const Status& tracker = *outputs.status.back();
        const MapperStatus& mapper = *outputs.mapper_status.back();
        return tracker.frames_in >= images && finishedImages(tracker) == tracker.frames_in &&
               mapper.frames_in >= outputs.tracked_frame.size() &&
               mapper.frames_processed + mapper.frames_shed == mapper.frames_in;
      },
      timeout);
}

bool LiveOdometry::reset() {
  std_srvs::Empty service;
  return ros::service::call(nh_.resolveName("reset"), service);
}

std_srvs::TriggerResponse LiveOdometry::askForTrajectory() {
  std_srvs::Trigger service;
  if (!ros::service::call(nh_.resolveName("save_trajectory"), service)) service.response.message = "no answer";
  return service.response;
}

std::uint64_t finishedImages(const Status& status) {
  return status.frames_tracked + status.frames_degraded + status.frames_initializing + status.frames_lost +
         status.frames_repeated + status.frames_rejected + status.frames_shed + status.frames_failed;
}

bool playBag(const std::string& file, double rate) {
  const std::string command =
      "rosbag play --clock --quiet --delay=1 --rate=" + std::to_string(rate) + " '" + file + "' < /dev/null";
  return std::system(command.c_str()) == 0;
}

}  // namespace mba_vo
