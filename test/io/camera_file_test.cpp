#include "mba_vo/io/camera_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"

namespace mba_vo::camera_file_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kRos =
    "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [461.5, 0., 322.25, 0., 460.5, 238.75, 0., 0., 1.]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.28, 0.07, 0.001, -0.002, 0.]\n";
const std::string kIni =
    "# Prosilica camera intrinsics\n\n[image]\n\nwidth\n2448\n\nheight\n2050\n\n[prosilica]\n\ncamera matrix\n"
    "4827.93789 0.00000 1223.50000\n0.00000 4835.62362 1024.50000\n0.00000 0.00000 1.00000\n\ndistortion\n"
    "-0.41527 0.31874 -0.00197 0.00071 0.00000\n\nrectification\n1 0 0\n0 1 0\n0 0 1\n\nprojection\n"
    "4827.9 0 1223.5 0\n0 4835.6 1024.5 0\n0 0 1 0\n";
const std::string kKalibr =
    "cam0:\n  T_cam_imu:\n  - [0.0, 1.0, 0.0, 0.1]\n  - [-1.0, 0.0, 0.0, 0.2]\n  - [0.0, 0.0, 1.0, 0.3]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
    "  distortion_coeffs: [0.0034, 0.0007, -0.0020, 0.0002]\n  distortion_model: equidistant\n"
    "  intrinsics: [190.97, 190.98, 254.93, 256.89]\n  resolution: [512, 510]\n  rostopic: /cam0/image_raw\n"
    "cam1:\n  camera_model: pinhole\n  distortion_coeffs: [-0.1, 0.02, 0.001, -0.002]\n  distortion_model: radtan\n"
    "  intrinsics: [290.5, 291.5, 250.0, 251.0]\n  resolution: [512, 510]\n";
const std::string kAsl =
    "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n"
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,\n"
    "         0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,\n"
    "        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,\n         0.0, 0.0, 0.0, 1.0]\n"
    "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
    "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
const std::string kFov = "FOV 0.349153 0.436593 0.493140 0.499021 0.933271\n1280 1024\n0.4 0.53 0.5 0.5 0\n640 480\n";

class CameraFileTest : public testing::Test {
 protected:
  CameraFile read(const std::string& text, const std::string& camera = "", cv::Size size = {}) const {
    return readCameraFile(folder_.write("file", text), camera, size);
  }
  /// The message, without the folder's name.
  std::string error(const std::string& text, const std::string& camera = "") const {
    const std::string message = messageOf([&] { read(text, camera); });
    const std::size_t name = message.find("file");
    return name == std::string::npos ? message : message.substr(name);
  }

  const TemporaryFolder folder_;
};

/// `text` with the first `from` in it replaced.
std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void expectCamera(const CameraCalibration& c, const CameraCalibration& expected) {
  EXPECT_EQ(c.width, expected.width);
  EXPECT_EQ(c.height, expected.height);
  EXPECT_NEAR(c.fx, expected.fx, 1e-9);
  EXPECT_NEAR(c.fy, expected.fy, 1e-9);
  EXPECT_NEAR(c.cx, expected.cx, 1e-9);
  EXPECT_NEAR(c.cy, expected.cy, 1e-9);
  EXPECT_EQ(c.distortion_model, expected.distortion_model);
  EXPECT_EQ(c.distortion, expected.distortion);
}

TEST_F(CameraFileTest, OfRos) {
  expectCamera(read(kRos).calibration,
               {640, 480, 461.5, 460.5, 322.25, 238.75, "plumb_bob", {-0.28, 0.07, 0.001, -0.002, 0.0}});
  EXPECT_FALSE(read(kRos).T_body_camera.has_value());
  EXPECT_EQ(read(with(kRos, "distortion_model: plumb_bob\n", "")).calibration.distortion_model, "plumb_bob");
  expectCamera(read("%YAML:1.0\n---\n" + with(kRos, "camera_matrix:", "camera_matrix: !!opencv-matrix")).calibration,
               read(kRos).calibration);
}

TEST_F(CameraFileTest, OfRosAsIni) {
  expectCamera(
      read(kIni).calibration,
      {2448, 2050, 4827.93789, 4835.62362, 1223.5, 1024.5, "plumb_bob", {-0.41527, 0.31874, -0.00197, 0.00071, 0.0}});
  const CameraFile rational = read(with(kIni, "0.00071 0.00000", "0.00071 0.1 0.2 0.3 0.4"));
  EXPECT_EQ(rational.calibration.distortion_model, "rational_polynomial");
}

TEST_F(CameraFileTest, OfKalibr) {
  const CameraFile first = read(kKalibr);
  expectCamera(first.calibration,
               {512, 510, 190.97, 190.98, 254.93, 256.89, "equidistant", {0.0034, 0.0007, -0.0020, 0.0002}});
  // T_cam_imu turns by -90 degrees about z: the camera is where its inverse puts the origin.
  ASSERT_TRUE(first.T_body_camera.has_value());
  EXPECT_TRUE(first.T_body_camera->translation().isApprox(Eigen::Vector3d(0.2, -0.1, -0.3), 1e-12));
  EXPECT_TRUE((*first.T_body_camera * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0.2, 0.9, -0.3), 1e-12));
  const CameraFile second = read(kKalibr, "cam1");
  expectCamera(second.calibration, {512, 510, 290.5, 291.5, 250.0, 251.0, "plumb_bob", {-0.1, 0.02, 0.001, -0.002}});
  EXPECT_FALSE(second.T_body_camera.has_value());
  EXPECT_EQ(read(kKalibr.substr(kKalibr.find("cam1"))).calibration.fx, 290.5) << "the only one";
}

TEST_F(CameraFileTest, OfAnAslFolder) {
  const CameraFile file = read(kAsl);
  expectCamera(file.calibration, {752,
                                  480,
                                  458.654,
                                  457.296,
                                  367.215,
                                  248.375,
                                  "plumb_bob",
                                  {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}});
  ASSERT_TRUE(file.T_body_camera.has_value());
  EXPECT_TRUE(file.T_body_camera->translation().isApprox(
      Eigen::Vector3d(-0.0216401454975, -0.064676986768, 0.00981073058949), 1e-12));
  EXPECT_NEAR(file.T_body_camera->rotationMatrix()(0, 1), -0.999880929698, 1e-6);
}

TEST_F(CameraFileTest, OfTumMonoRelativeToTheImage) {
  const CameraCalibration fov{
      1280, 1024, 1280 * 0.349153, 1024 * 0.436593, 1280 * 0.493140 - 0.5, 1024 * 0.499021 - 0.5, "fov", {0.933271}};
  expectCamera(read(kFov).calibration, fov);
  expectCamera(read(with(kFov, "FOV ", "")).calibration, fov);
  expectCamera(read(with(kFov, "0.4 0.53 0.5 0.5 0\n640 480\n", "crop\n")).calibration, fov);
  expectCamera(read("EquiDistant 0.373 0.374 0.498 0.502 0.0034 0.0007 -0.002 0.0002\r\n512 512\r\ncrop\r\n512 512\r\n")
                   .calibration,
               {512,
                512,
                512 * 0.373,
                512 * 0.374,
                512 * 0.498 - 0.5,
                512 * 0.502 - 0.5,
                "equidistant",
                {0.0034, 0.0007, -0.002, 0.0002}});
}

TEST_F(CameraFileTest, OfTumMonoInPixels) {
  expectCamera(read("RadTan 460 461 322 238 -0.2 0.05 0.001 -0.002\n640 480\nnone\n640 480\n").calibration,
               {640, 480, 460, 461, 322, 238, "plumb_bob", {-0.2, 0.05, 0.001, -0.002}});
  expectCamera(read("460 461 322 238 -0.2 0.05 0.001 -0.002\n640 480\n").calibration,
               {640, 480, 460, 461, 322, 238, "plumb_bob", {-0.2, 0.05, 0.001, -0.002}});
  expectCamera(read("Pinhole 460 461 322 238 0\n640 480\nfull\n640 480\n").calibration,
               {640, 480, 460, 461, 322, 238, "", {}});
}

TEST_F(CameraFileTest, OfEth3dNeedsTheSizeOfTheImages) {
  expectCamera(read("726.28741 726.28741 354.64965 186.46566\n", "", {739, 458}).calibration,
               {739, 458, 726.28741, 726.28741, 354.64965, 186.46566, "", {}});
  EXPECT_THAT(error("726.28741 726.28741 354.64965 186.46566\n"), HasSubstr("file:1: fx fy cx cy without the size"));
}

TEST_F(CameraFileTest, ANamedCameraIsTakenOrRefused) {
  const auto chosen = [&](const std::string& text, const std::string& camera) {
    return readChosenCamera(folder_.write("file", text), camera).calibration;
  };
  EXPECT_EQ(chosen(kKalibr, "cam1").fx, 290.5);
  EXPECT_EQ(chosen(kKalibr, "").fx, 190.97);
  EXPECT_EQ(chosen(kRos, "").fx, 461.5);
  EXPECT_THAT(messageOf([&] { chosen(kKalibr, "cam2"); }), HasSubstr("has no camera 'cam2', but cam0, cam1"));
  for (const std::string& one : {kRos, kIni, kAsl, kFov}) {
    EXPECT_THAT(messageOf([&] { chosen(one, "cam1"); }),
                AllOf(HasSubstr("file: there is no camera 'cam1' to choose"), HasSubstr("of one camera")));
  }
}

TEST_F(CameraFileTest, TheFirstOfTheKnownNamesIsTaken) {
  EXPECT_EQ(cameraFileIn(folder_.file("")), folder_.file("camera.yaml"));
  folder_.write("camchain.yaml", "");
  EXPECT_EQ(cameraFileIn(folder_.file("")), folder_.file("camchain.yaml"));
  folder_.write("camera.txt", "");
  EXPECT_EQ(cameraFileIn(folder_.file("")), folder_.file("camera.txt"));
}

struct Spoilt {
  std::string text;
  std::vector<std::string> told;  // in the message
};

std::vector<Spoilt> spoiltYaml() {
  return {
      {with(kRos, "image_width: 640\n", ""), {"file:1: 'image_width' is missing"}},
      {with(kRos, "640", "-640"), {"width", "-640", "at least 2"}},
      {with(kRos, "640", "640.5"), {"file:1: 'image_width' is 640.5", "whole number"}},
      {with(kRos, ", 0., 0., 1.]", "]"), {"file:7: 'camera_matrix.data'", "list of 9 numbers, has 6"}},
      {with(kRos, "461.5", "f"), {"file:7: 'camera_matrix.data'", "list of numbers"}},
      {with(kRos, "461.5", ".nan"), {"file:7: 'camera_matrix.data'", "finite"}},
      {with(kRos, "[461.5", "[-461.5"), {"fx is -461.5", "greater than 0"}},
      {with(kRos, "plumb_bob", "fisheye"), {"'fisheye'", "plumb_bob, rational_polynomial, equidistant, fov"}},
      {with(kRos, ", -0.002, 0.]", "]"), {"plumb_bob coefficients is 3", "4 or 5"}},
      {with(kRos, "461.5, 0.,", "461.5, [0.,"), {"file:", "no YAML"}},
      {with(kRos, "distortion_coefficients:", "distortion_coefficients: 3\nother:"), {"file:9", "is 3, must be a map"}},
      {with(kKalibr, "pinhole", "omni"), {"file:8: 'cam0.camera_model' is omni", "pinhole"}},
      {with(kKalibr, "equidistant", "polynomial"), {"'cam0.distortion_model' is polynomial", "radtan"}},
      {with(kKalibr, "[512, 510]", "[512]"), {"'cam0.resolution'", "list of 2 numbers, has 1"}},
      {with(kKalibr, "[512, 510]", "[512, 0]"), {"'cam0.resolution'", "whole numbers of pixels"}},
      {with(kKalibr, "[190.97, ", "["), {"'cam0.intrinsics'", "list of 4 numbers, has 3"}},
      {with(kKalibr, "  - [-1.0, 0.0, 0.0, 0.2]\n", ""), {"'cam0.T_cam_imu'", "4 lists of 4"}},
      {with(kKalibr, "[-1.0, 0.0", "[-1.5, 0.0"), {"'cam0.T_cam_imu'", "a rotation and a translation"}},
      {with(kKalibr, "  intrinsics:", "  k:"), {"'cam0.intrinsics' is missing"}},
      {with(kAsl, "0.07395907, ", ""), {"'distortion_coefficients'", "4 or 5 numbers, has 3"}},
      {with(kAsl, "0.999557249008", "1.999557249008"), {"file:8: 'T_BS.data'", "a rotation"}},
      {with(kAsl, "intrinsics", "intrinsic"), {"'intrinsics' (ASL) is missing", "intrinsic,"}},
      {"sensor_type: imu\nrate_hz: 200\n", {"no calibration that is known", "sensor_type, rate_hz"}},
      {std::string(2000, '[') + "\na: 1\n", {"file"}},
  };
}

std::vector<Spoilt> spoiltText() {
  return {
      {with(kFov, "FOV", "Fisheye"), {"file:1: camera model 'Fisheye'", "FOV, Pinhole, RadTan"}},
      {with(kFov, " 0.933271", ""), {"file:1: FOV has 4 values, must have 5"}},
      {with(kFov, "0.933271", "3.5"), {"file:1", "omega is 3.5", "below pi"}},
      {with(kFov, "0.436593", "0.43x"), {"file:1: value '0.43x' is not a number"}},
      {with(kFov, "1280 1024", "1280"), {"file:2: 1 words", "width and height"}},
      {with(kFov, "1280 1024", "1280 1024.5"), {"file:2: height '1024.5' is not a whole number"}},
      {with(kFov, "0.4 0.53 0.5 0.5 0", "cropped"), {"file:3: 'cropped'", "crop, full, none"}},
      {with(kFov, "640 480", "640 x 480"), {"file:4: 3 words"}},
      {"FOV 0.3 0.4 0.5 0.5 0.9\n", {"second line", "is missing"}},
      {"FOV 460 461 0.5 0.5 0.9\n640 480\n", {"file:1", "all be in pixels, or all relative"}},
      {"Pinhole 460 461 322 0.5 0\n640 480\n", {"file:1", "all be in pixels, or all relative"}},
      {"Pinhole 460 461 322 238 0.9\n640 480\n", {"fifth value of Pinhole is 0.9, must be 0"}},
      {"460 461 322 238 0.1 0.2\n640 480\n", {"file:1: 6 values without a camera model"}},
      {"RadTan 460 461 322 238 nan 0 0 0\n640 480\n", {"file:1: value 'nan' is not finite"}},
      {with(kIni, "width\n2448\n", ""), {"'width' is missing"}},
      {with(kIni, "2448", "2448.5"), {"'width' is 2448.5", "whole"}},
      {with(kIni, "0.00000 0.00000 1.00000\n", ""), {"file:13: 'camera matrix' has 6 numbers, must have 9"}},
      {with(kIni, "4827.93789", "4827,93"), {"file:14", "'4827,93' is not a number"}},
      {with(kIni, "-0.41527 0.31874", ""), {"'distortion' has 3 numbers, must have 4 or 5 or 8"}},
      {"", {"file: is empty"}},
      {"# nothing\n", {"has nothing but comments"}},
      {std::string("FOV\0 1", 6), {"is no text file"}},
      {"\x89PNG\r\n\x1a\n", {"camera model"}},
  };
}

TEST_F(CameraFileTest, EachSpoiltFileIsToldWhatIsWrong) {
  std::vector<Spoilt> files = spoiltYaml();
  for (const Spoilt& file : spoiltText()) files.push_back(file);
  EXPECT_GE(files.size(), 30U);
  for (const Spoilt& spoilt : files) {
    const std::string message = error(spoilt.text);
    EXPECT_THAT(message, HasSubstr("file")) << spoilt.text;
    for (const std::string& part : spoilt.told) EXPECT_THAT(message, HasSubstr(part)) << spoilt.text;
  }
}

TEST_F(CameraFileTest, WhatIsNoFileIsTold) {
  EXPECT_THAT(messageOf([&] { readCameraFile(folder_.file("none.yaml")); }), HasSubstr("none.yaml: cannot be read"));
  EXPECT_THAT(messageOf([&] { readCameraFile(folder_.file("")); }), HasSubstr("cannot be read"));
  EXPECT_THAT(error(std::string(1U << 21U, '1')), AllOf(HasSubstr("2097152 bytes"), HasSubstr("at most")));
  EXPECT_THAT(error(kKalibr, "cam7"), HasSubstr("file: has no camera 'cam7', but cam0, cam1"));
}

/// Wherever a file ends too early, it is read or told of, but nothing crashes.
TEST_F(CameraFileTest, TruncatedFilesAreReadOrToldOf) {
  for (const std::string& text : {kRos, kIni, kKalibr, kAsl, kFov}) {
    for (std::size_t length = 0; length < text.size(); length += 7) {
      const std::string message = error(text.substr(0, length));
      EXPECT_THAT(message, testing::AnyOf(HasSubstr("file"), HasSubstr("nothing thrown"))) << length;
    }
  }
}

}  // namespace
}  // namespace mba_vo::camera_file_test
