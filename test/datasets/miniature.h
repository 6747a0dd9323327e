#pragma once

#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"

namespace mba_vo {

/// Folders with a few images each, in the forms of the data sets and with the heads of their files.

inline void writeImage(const TemporaryFolder& folder, const std::string& name, cv::Size size, int grey,
                       int type = CV_8UC1) {
  folder.write(name, "");  // makes the folders
  cv::imwrite(folder.file(name), cv::Mat(size, type, cv::Scalar::all(grey)));
}

inline void writeTumRgbd(const TemporaryFolder& folder, const std::string& root) {
  folder.write(root + "/rgb.txt",
               "# color images\n# file: 'rgbd_dataset_freiburg1_rpy.bag'\n# timestamp filename\n"
               "1305031229.528748 rgb/1305031229.528748.png\n1305031229.564436 rgb/1305031229.564436.png\n"
               "1305031229.596618 rgb/1305031229.596618.png\n");
  folder.write(root + "/depth.txt",
               "# depth maps\n# file: 'rgbd_dataset_freiburg1_rpy.bag'\n# timestamp filename\n"
               "1305031229.560000 depth/1305031229.560000.png\n1305031229.700000 depth/1305031229.700000.png\n");
  folder.write(root + "/groundtruth.txt",
               "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg1_rpy.bag'\n"
               "# timestamp tx ty tz qx qy qz qw\n"
               "1305031225.9334 1.3357 0.6698 1.6180 0.6504 0.6012 -0.3056 -0.3496\n"
               "1305031225.9434 1.3358 0.6699 1.6181 0.6504 0.6012 -0.3056 -0.3496\n");
  for (const char* stamp : {"1305031229.528748", "1305031229.564436", "1305031229.596618"}) {
    writeImage(folder, root + "/rgb/" + stamp + ".png", {640, 480}, 50, CV_8UC3);
  }
  writeImage(folder, root + "/depth/1305031229.560000.png", {640, 480}, 10000, CV_16UC1);
  writeImage(folder, root + "/depth/1305031229.700000.png", {640, 480}, 10000, CV_16UC1);
}

inline void writeEth3d(const TemporaryFolder& folder, const std::string& root) {
  folder.write(root + "/rgb.txt", "5455.183914 rgb/5455.183914.png\n5455.220805 rgb/5455.220805.png\n");
  folder.write(root + "/calibration.txt", "726.21081542969 726.21081542969 359.2048034668 202.47247314453\n");
  folder.write(root + "/groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n5455.183914 0.1 0.2 0.3 0 0 0.6 0.8\n");
  writeImage(folder, root + "/rgb/5455.183914.png", {739, 458}, 50, CV_8UC3);
  writeImage(folder, root + "/rgb/5455.220805.png", {739, 458}, 60, CV_8UC3);
}

inline void writeEuroc(const TemporaryFolder& folder, const std::string& root) {
  folder.write(root + "/mav0/cam0/data.csv",
               "#timestamp [ns],filename\r\n1403715273262142976,1403715273262142976.png\r\n"
               "1403715273312143104,1403715273312143104.png\r\n");
  folder.write(root + "/mav0/cam0/sensor.yaml",
               "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
               "# Sensor extrinsics wrt. the body-frame.\nT_BS:\n  cols: 4\n  rows: 4\n"
               "  data: [0.0, -1.0, 0.0, -0.02,\n         1.0, 0.0, 0.0, -0.06,\n         0.0, 0.0, 1.0, 0.01,\n"
               "         0.0, 0.0, 0.0, 1.0]\n\n# Camera specific definitions.\nrate_hz: 20\nresolution: [752, 480]\n"
               "camera_model: pinhole\nintrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n"
               "distortion_model: radial-tangential\n"
               "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n");
  folder.write(root + "/mav0/state_groundtruth_estimate0/data.csv",
               "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
               "v_RS_R_x [m s^-1]\n"
               "1403715273262142976,4.0,5.0,6.0,0.5,0.5,0.5,0.5,0.1\n1403715273267142976,4.5,5.5,6.5,1,0,0,0,0.1\n");
  for (const char* stamp : {"1403715273262142976", "1403715273312143104"}) {
    writeImage(folder, root + "/mav0/cam0/data/" + stamp + ".png", {752, 480}, 50);
  }
}

inline std::string identityResponse() {
  std::string text;
  for (int i = 0; i < 256; ++i) text += std::to_string(i) + ".0 ";
  return text + "\n";
}

inline void writeTumVi(const TemporaryFolder& folder, const std::string& root) {
  folder.write(root + "/mav0/cam0/data.csv",
               "#timestamp [ns],filename\n1520530308199447626,1520530308199447626.png\n"
               "1520530308249450626,1520530308249450626.png\n1520530308299447626,1520530308299447626.png\n");
  folder.write(root + "/mav0/mocap0/data.csv",
               "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
               "1520530308199447626,1.0,2.0,3.0,1.0,0.0,0.0,0.0\n");
  folder.write(root + "/dso/cam0/times.txt",
               "# timestamp[ns] timestamp[s] exposure[ms]\n1520530308199447626 1520530308.199447626 1.56199\n"
               "1520530308249450626 1520530308.249450626 2.5\n");
  folder.write(root + "/dso/cam0/pcalib.txt", identityResponse());
  writeImage(folder, root + "/dso/cam0/vignette.png", {512, 512}, 60000, CV_16UC1);
  folder.write(root + "/dso/camchain.yaml",
               "cam0:\n  T_cam_imu:\n  - [1.0, 0.0, 0.0, 0.1]\n  - [0.0, 0.0, -1.0, 0.2]\n  - [0.0, 1.0, 0.0, 0.3]\n"
               "  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
               "  distortion_coeffs: [0.0034823894, 0.0007150348, -0.0020532361, 0.0002029367]\n"
               "  distortion_model: equidistant\n"
               "  intrinsics: [190.9784771, 190.9733071, 254.9317060, 256.8974428]\n  resolution: [512, 512]\n"
               "  rostopic: /cam0/image_raw\n");
  for (const char* stamp : {"1520530308199447626", "1520530308249450626", "1520530308299447626"}) {
    writeImage(folder, root + "/mav0/cam0/data/" + stamp + ".png", {512, 512}, 20000, CV_16UC1);
  }
}

inline void writeTumMono(const TemporaryFolder& folder, const std::string& root) {
  folder.write(root + "/camera.txt",
               "0.349153 0.436593 0.493140 0.499021 0.933271\n1280 1024\n0.4 0.53 0.5 0.5 0\n640 480\n");
  folder.write(root + "/times.txt",
               "00000 1464106180.5132990000 3.9874200821\n00001 1464106180.5466651917 0.0498610\n"
               "00002 1464106180.5800271034 0\n");
  folder.write(root + "/pcalib.txt", identityResponse());
  folder.write(root + "/groundtruthSync.txt",
               "1464106180.513299 0.1 0.2 0.3 0 0 0 1\n1464106180.546665 NaN NaN NaN NaN NaN NaN NaN\n"
               "1464106180.580027 0.4 0.5 0.6 0 0 0 1\n");
  writeImage(folder, root + "/vignette.png", {1280, 1024}, 65535, CV_16UC1);
  for (const char* id : {"00000", "00001", "00002"}) {
    writeImage(folder, root + "/images/" + id + ".jpg", {1280, 1024}, 50);
  }
}

inline void writeSevenScenes(const TemporaryFolder& folder, const std::string& root) {
  for (const char* id : {"000000", "000001", "000003"}) {
    writeImage(folder, root + "/frame-" + id + ".color.png", {640, 480}, 50, CV_8UC3);
    writeImage(folder, root + "/frame-" + id + ".depth.png", {640, 480}, 1500, CV_16UC1);
    folder.write(root + "/frame-" + id + ".pose.txt",
                 "0.0000000e+000\t -1.0000000e+000\t 0.0000000e+000\t 1.0e-001\t \n"
                 "1.0000000e+000\t 0.0000000e+000\t 0.0000000e+000\t 2.0e-001\t \n"
                 "0.0000000e+000\t 0.0000000e+000\t 1.0000000e+000\t 3.0e-001\t \n"
                 "0.0000000e+000\t 0.0000000e+000\t 0.0000000e+000\t 1.0e+000\t \n");
  }
}

}  // namespace mba_vo
