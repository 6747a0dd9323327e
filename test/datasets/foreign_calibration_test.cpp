#include "mba_vo/datasets/foreign_calibration.h"

#include <functional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/persistence.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/io/camera_file.h"

namespace mba_vo::foreign_calibration_test {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

CameraCalibration camera(const std::string& model, std::vector<double> distortion) {
  return {752, 480, 458.654, 457.296, 367.215, 248.375, model, std::move(distortion)};
}

const CameraCalibration kPinhole = camera("plumb_bob", {});
const CameraCalibration kRadial = camera("plumb_bob", {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05});
const CameraCalibration kThirdRadial = camera("plumb_bob", {0.26, -0.95, -0.005, 0.0026, 1.163314});
const CameraCalibration kEquidistant = camera("equidistant", {0.0034823894, 0.0007150348, -0.0020532361, 0.0002});
const CameraCalibration kFov = camera("fov", {0.933271});
const CameraCalibration kRational = camera("rational_polynomial", {0.1, 0.2, 0, 0, 0.01, 0.1, 0.2, 0.01});

using Writer = std::function<void(const CameraCalibration&, std::ostream&)>;

std::string textOf(const Writer& write, const CameraCalibration& calibration) {
  std::ostringstream text;
  write(calibration, text);
  return text.str();
}

void writeAsl20(const CameraCalibration& c, std::ostream& out) { writeAslCamera(c, 20.0, out); }
void writeOrb20(const CameraCalibration& c, std::ostream& out) { writeOrbSlamSettings(c, 20.0, out); }

/// What is written is read again by this project's own reader, which reads the real files of the data sets.
void expectReadAgain(const Writer& write, const CameraCalibration& c, const std::string& name) {
  const TemporaryFolder folder;
  const CameraCalibration read = readCameraFile(folder.write(name, textOf(write, c))).calibration;
  EXPECT_EQ(read.width, c.width);
  EXPECT_EQ(read.height, c.height);
  EXPECT_EQ(read.fx, c.fx);
  EXPECT_EQ(read.fy, c.fy);
  EXPECT_EQ(read.cx, c.cx);
  EXPECT_EQ(read.cy, c.cy);
  if (isUndistorted(c)) {
    EXPECT_TRUE(isUndistorted(read));
  } else {
    EXPECT_EQ(read.distortion_model, c.distortion_model);
    EXPECT_THAT(read.distortion, ElementsAreArray(c.distortion));
  }
}

TEST(ForeignCalibration, OfDsoIsReadAgain) {
  for (const CameraCalibration& c : {kPinhole, kRadial, kEquidistant, kFov}) {
    expectReadAgain(writeDsoCamera, c, "camera.txt");
  }
}

TEST(ForeignCalibration, OfEurocIsReadAgain) {
  for (const CameraCalibration& c : {kPinhole, kRadial, kEquidistant}) expectReadAgain(writeAsl20, c, "sensor.yaml");
}

TEST(ForeignCalibration, DsoGetsSidesThatItCanHalve) {
  EXPECT_THAT(textOf(writeDsoCamera, kPinhole), testing::EndsWith("752 480\nnone\n752 480\n"));
  EXPECT_THAT(textOf(writeDsoCamera, kRadial), testing::EndsWith("752 480\ncrop\n752 480\n"));
  CameraCalibration odd = kPinhole;
  odd.width = 739;
  odd.height = 458;
  EXPECT_THAT(textOf(writeDsoCamera, odd), testing::EndsWith("739 458\ncrop\n736 448\n"));
}

/// As ORB-SLAM reads it, with OpenCV. Numbers other than these must be real, or it ends.
cv::FileStorage orbSlam(const CameraCalibration& c) {
  return {textOf(writeOrb20, c), cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML};
}

TEST(ForeignCalibration, OrbSlamFindsEveryKeyThatItAsksFor) {
  CameraCalibration whole = kThirdRadial;
  whole.fx = 500.0;
  const cv::FileStorage settings = orbSlam(whole);
  EXPECT_EQ(settings["File.version"].string(), "1.0");
  EXPECT_EQ(settings["Camera.type"].string(), "PinHole");
  const std::vector<std::pair<const char*, double>> values{{"fx", 500.0},   {"fy", 457.296}, {"cx", 367.215},
                                                           {"cy", 248.375}, {"k1", 0.26},    {"k2", -0.95},
                                                           {"p1", -0.005},  {"p2", 0.0026},  {"k3", 1.163314}};
  for (const char* prefix : {"Camera1.", "Camera."}) {
    for (const auto& [key, value] : values) {
      const cv::FileNode node = settings[prefix + std::string(key)];
      ASSERT_TRUE(node.isReal()) << prefix << key;
      EXPECT_EQ(node.real(), value) << prefix << key;
    }
  }
  for (const char* key : {"Camera.fps", "Camera.RGB", "Camera.width", "Camera.height", "ORBextractor.nFeatures",
                          "ORBextractor.nLevels", "ORBextractor.iniThFAST", "ORBextractor.minThFAST"}) {
    EXPECT_TRUE(settings[key].isInt()) << key;
  }
  EXPECT_EQ(static_cast<int>(settings["Camera.fps"]), 20);
  for (const char* key : {"ORBextractor.scaleFactor", "Viewer.KeyFrameSize", "Viewer.KeyFrameLineWidth",
                          "Viewer.GraphLineWidth", "Viewer.PointSize", "Viewer.CameraSize", "Viewer.CameraLineWidth",
                          "Viewer.ViewpointX", "Viewer.ViewpointY", "Viewer.ViewpointZ", "Viewer.ViewpointF"}) {
    EXPECT_TRUE(settings[key].isReal()) << key;
  }
}

TEST(ForeignCalibration, OrbSlamIsToldOfNoDistortionWhereThereIsNone) {
  const cv::FileStorage pinhole = orbSlam(kPinhole);
  EXPECT_TRUE(pinhole["Camera1.k1"].empty()) << "ORB-SLAM3 would undistort";
  EXPECT_EQ(pinhole["Camera.k1"].real(), 0.0) << "ORB-SLAM2 asks for it";
  const cv::FileStorage fisheye = orbSlam(kEquidistant);
  EXPECT_EQ(fisheye["Camera.type"].string(), "KannalaBrandt8");
  EXPECT_EQ(fisheye["Camera1.k3"].real(), -0.0020532361);
  EXPECT_TRUE(fisheye["Camera.fx"].empty()) << "ORB-SLAM2 would take it for a pinhole";
}

TEST(ForeignCalibration, ALensThatAnotherSystemHasNotIsNamed) {
  const auto error = [](const Writer& write, const CameraCalibration& c) {
    return messageOf([&] { textOf(write, c); });
  };
  EXPECT_THAT(error(writeDsoCamera, kThirdRadial), HasSubstr("plumb_bob with k3 = 1.163314: DSO knows no such"));
  EXPECT_THAT(error(writeDsoCamera, kRational), HasSubstr("rational_polynomial: DSO"));
  EXPECT_THAT(error(writeAsl20, kThirdRadial), HasSubstr("k3 = 1.163314: the form of EuRoC"));
  EXPECT_THAT(error(writeAsl20, kFov), HasSubstr("lens fov: the form of EuRoC"));
  EXPECT_THAT(error(writeOrb20, kFov), HasSubstr("lens fov: ORB-SLAM knows no such; plumb_bob, equidistant"));
  EXPECT_THAT(error(writeOrb20, kRational), HasSubstr("rectify"));
}

}  // namespace
}  // namespace mba_vo::foreign_calibration_test
