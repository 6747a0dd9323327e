// Feeds images to the odometry and prints where the camera was when each exposure began and when it ended.
#include <iostream>
#include <stdexcept>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/io/camera_file.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"

int main(int argc, char** argv) try {
  if (argc < 5) throw std::invalid_argument("CAMERA.yaml IMAGES_PER_SECOND EXPOSURE_SECONDS IMAGE... are needed");
  const double rate = std::stod(argv[2]), exposure = std::stod(argv[3]);
  mba_vo::OdometryConfig config;
  mba_vo::finalize(config);
  mba_vo::Odometry odometry(config, 0);
  odometry.setCalibration(mba_vo::readCameraFile(argv[1]).calibration, {});
  for (int i = 4; i < argc; ++i) {
    mba_vo::CameraImage image;
    image.sequence = static_cast<std::uint64_t>(i - 4);
    image.stamp_ns = image.mid_exposure_ns = static_cast<std::int64_t>(1e9 * (i - 4) / rate);
    image.exposure = exposure;
    image.image = cv::imread(argv[i], cv::IMREAD_GRAYSCALE);
    for (const mba_vo::PublishedImage& done : odometry.process(image).images) {
      const mba_vo::TrackedFrameConstPtr& tracked = done.step.message.tracked;
      if (!tracked || !tracked->tracked()) continue;  // no map yet, or lost, or a bad image: there is no pose
      mba_vo::ExposureTrajectory in_odom = tracked->trajectory;
      in_odom.T_reference_mid = done.step.T_odom_camera;
      const mba_vo::SE3 start = in_odom.start(), end = in_odom.end();
      std::cout << argv[4 + done.step.sequence] << ": from " << start.translation().transpose() << " to "
                << end.translation().transpose() << "\n";
    }
  }
} catch (const std::exception& error) {
  std::cerr << "minimal: " << error.what() << "\n";
  return 1;
}
