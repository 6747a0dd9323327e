// Of the camera that the file tells of: size and focal length; and the message that its poses would come with.
#include <exception>
#include <iostream>

#include <mba_vo/ExposureMotion.h>

#include "mba_vo/io/camera_file.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const mba_vo::CameraCalibration camera = mba_vo::readCameraFile(argv[1]).calibration;
    std::cout << ros::message_traits::DataType<mba_vo::ExposureMotion>::value() << ", " << camera.width << "x"
              << camera.height << ", " << camera.fx << " px\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
