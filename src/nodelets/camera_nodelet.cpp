#include <memory>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "mba_vo/ros/camera_driver.h"
#include "mba_vo/ros/node_config.h"

namespace mba_vo {

/// The camera in the tracker's manager: images are handed over by pointer.
class CameraNodelet final : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      ros::NodeHandle& nh = getPrivateNodeHandle();
      driver_ = std::make_unique<CameraDriver>(nh, parseCameraConfig(readParameters(nh)));
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());  // the loader would only say that it failed
      throw;
    }
  }

  std::unique_ptr<CameraDriver> driver_;
};

}  // namespace mba_vo

PLUGINLIB_EXPORT_CLASS(mba_vo::CameraNodelet, nodelet::Nodelet)
