#include "mba_vo/datasets/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/miniature.h"

namespace mba_vo::dataset_test {
namespace {

namespace fs = std::filesystem;

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

struct Read {
  std::vector<std::int64_t> stamps;  // [ns]
  std::vector<double> exposures;     // [s], 0 = unknown
  std::vector<CameraImage> images;
};

Read readAll(const Dataset& dataset) {
  Read read;
  while (auto image = dataset.reader->next()) {
    EXPECT_EQ(image->stamp_ns, image->mid_exposure_ns);
    EXPECT_EQ(image->problem, "");
    read.stamps.push_back(image->mid_exposure_ns);
    read.exposures.push_back(image->exposure.value_or(0.0));
    read.images.push_back(std::move(*image));
  }
  EXPECT_EQ(read.images.size(), dataset.reader->size());
  return read;
}

TEST(Dataset, TumRgbd) {
  const TemporaryFolder folder;
  writeTumRgbd(folder, "rgbd_dataset_freiburg2_rpy");
  const Dataset dataset = openDataset(folder.file("rgbd_dataset_freiburg2_rpy/"));  // the name decides, not a comment
  EXPECT_EQ(dataset.form, "TUM RGB-D");
  EXPECT_NEAR(dataset.reader->calibration().fx, 520.9, 0.05);
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("rolling shutter")));
  const Read read = readAll(dataset);
  EXPECT_THAT(read.stamps, ElementsAre(1305031229528748000, 1305031229564436000, 1305031229596618000));
  EXPECT_THAT(read.exposures, ElementsAre(0.0, 0.0, 0.0));
  EXPECT_EQ(read.images[0].image.type(), CV_8UC3);
  EXPECT_TRUE(read.images[1].depth.empty());
}

TEST(Dataset, TumRgbdIsCalibratedByItsName) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, double>> focal_lengths{{"rgbd_dataset_freiburg1_desk", 517.3},
                                                                  {"fr2_xyz", 520.9},
                                                                  {"rgbd_dataset_freiburg3_sitting", 535.4},
                                                                  {"mine", 517.3}};
  for (const auto& [name, fx] : focal_lengths) {
    writeTumRgbd(folder, name);
    EXPECT_NEAR(openDataset(folder.file(name)).reader->calibration().fx, fx, 0.05) << name;
  }
  const CameraCalibration first = openDataset(folder.file("rgbd_dataset_freiburg1_desk")).reader->calibration();
  EXPECT_THAT(first.distortion, ElementsAre(0.262383, -0.953104, -0.005358, 0.002628, 1.163314));
  EXPECT_TRUE(openDataset(folder.file("rgbd_dataset_freiburg3_sitting")).reader->calibration().distortion.empty());
}

TEST(Dataset, TumRgbdHasDepthsOfAboutTheSameTime) {
  const TemporaryFolder folder;
  writeTumRgbd(folder, "fr1");
  DatasetOptions options;
  options.depth.subfolder = "depth";
  const Read read = readAll(openDataset(folder.file("fr1"), options));
  EXPECT_TRUE(read.images[0].depth.empty());  // 31 ms off
  ASSERT_FALSE(read.images[1].depth.empty());
  EXPECT_FLOAT_EQ(read.images[1].depth(10, 10), 2.0F);
  EXPECT_TRUE(read.images[2].depth.empty());
}

TEST(Dataset, Eth3d) {
  const TemporaryFolder folder;
  writeEth3d(folder, "camera_shake_1");
  const Dataset dataset = openDataset(folder.file("camera_shake_1"));
  EXPECT_EQ(dataset.form, "ETH3D SLAM");
  const CameraCalibration c = dataset.reader->calibration();
  EXPECT_EQ(cv::Size(c.width, c.height), cv::Size(739, 458));
  EXPECT_DOUBLE_EQ(c.fx, 726.21081542969);
  EXPECT_DOUBLE_EQ(c.cy, 202.47247314453);
  EXPECT_THAT(readAll(dataset).stamps, ElementsAre(5455183914000, 5455220805000));
}

TEST(Dataset, Euroc) {
  const TemporaryFolder folder;
  writeEuroc(folder, "MH_01_easy");
  for (const char* path : {"MH_01_easy", "MH_01_easy/mav0", "MH_01_easy/mav0/cam0", "MH_01_easy/mav0/cam0/"}) {
    const Dataset dataset = openDataset(folder.file(path));
    EXPECT_EQ(dataset.form, "EuRoC (ASL)") << path;
    EXPECT_EQ(dataset.reader->calibration().fx, 458.654);
    EXPECT_EQ(dataset.reader->calibration().distortion_model, "plumb_bob");
    const Read read = readAll(dataset);
    EXPECT_THAT(read.stamps, ElementsAre(1403715273262142976, 1403715273312143104));
    EXPECT_THAT(read.exposures, ElementsAre(0.0, 0.0));
  }
}

TEST(Dataset, TumVi) {
  const TemporaryFolder folder;
  writeTumVi(folder, "dataset-room1_512_16");
  const Dataset dataset = openDataset(folder.file("dataset-room1_512_16"));
  EXPECT_EQ(dataset.form, "TUM-VI");
  EXPECT_EQ(dataset.reader->calibration().distortion_model, "equidistant");
  EXPECT_NEAR(dataset.reader->calibration().fx, 190.9784771, 1e-9);
  EXPECT_EQ(dataset.response_file, folder.file("dataset-room1_512_16/dso/cam0/pcalib.txt"));
  EXPECT_EQ(dataset.vignette_file, folder.file("dataset-room1_512_16/dso/cam0/vignette.png"));
  const Read read = readAll(dataset);
  EXPECT_THAT(read.stamps, ElementsAre(1520530308199447626, 1520530308249450626, 1520530308299447626));
  EXPECT_THAT(read.exposures, ElementsAre(testing::DoubleEq(1.56199e-3), testing::DoubleEq(2.5e-3), 0.0));
  EXPECT_EQ(read.images[0].image.type(), CV_16UC1);
}

TEST(Dataset, TumMono) {
  const TemporaryFolder folder;
  writeTumMono(folder, "sequence_01");
  const Dataset dataset = openDataset(folder.file("sequence_01"));
  EXPECT_EQ(dataset.form, "TUM-mono");
  const CameraCalibration c = dataset.reader->calibration();
  EXPECT_EQ(c.distortion_model, "fov");
  EXPECT_THAT(c.distortion, ElementsAre(0.933271));
  EXPECT_NEAR(c.fx, 446.91584, 1e-9);
  EXPECT_NEAR(c.cy, 510.497504, 1e-9);
  const Read read = readAll(dataset);
  EXPECT_THAT(read.stamps, ElementsAre(1464106180513299000, 1464106180546665192, 1464106180580027103));
  EXPECT_THAT(read.exposures, ElementsAre(testing::DoubleEq(3.9874200821e-3), testing::DoubleEq(0.0498610e-3), 0.0));
}

TEST(Dataset, WhatIsKnownOfThePixelsGoesWhereTheConfigurationIsSilent) {
  const TemporaryFolder folder;
  writeTumMono(folder, "m");
  const Dataset dataset = openDataset(folder.file("m"));
  FrameBuilderConfig silent;
  dataset.configure(silent);
  EXPECT_EQ(silent.response_file, folder.file("m/pcalib.txt"));
  EXPECT_EQ(silent.vignette_file, folder.file("m/vignette.png"));
  FrameBuilderConfig told;
  told.gamma = 2.2;
  told.vignette_file = "mine.png";
  dataset.configure(told);
  EXPECT_EQ(told.response_file, "");
  EXPECT_EQ(told.vignette_file, "mine.png");
}

TEST(Dataset, SevenScenes) {
  const TemporaryFolder folder;
  writeSevenScenes(folder, "chess/seq-01");
  const Dataset dataset = openDataset(folder.file("chess/seq-01"));
  EXPECT_EQ(dataset.form, "7-Scenes");
  EXPECT_EQ(dataset.reader->calibration().fx, 525.0);
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("no calibration is published")));
  EXPECT_THAT(readAll(dataset).stamps, ElementsAre(0, 33333333, 100000000));  // the one that is missing counts
  EXPECT_THAT(messageOf([&] { openDataset(folder.file("chess")); }), HasSubstr("chess/seq-01 is one"));
}

TEST(Dataset, ACalibrationThatIsNamedIsTakenInPlaceOfTheOwn) {
  const TemporaryFolder folder;
  DatasetOptions options;
  options.calibration_file = folder.write("mine.txt", "RadTan 460 461 322 238 -0.2 0.05 0 0\n640 480\n");
  writeTumRgbd(folder, "fr1");
  writeEuroc(folder, "euroc");
  writeSevenScenes(folder, "seq-01");
  writeTumMono(folder, "mono");
  for (const char* name : {"fr1", "euroc", "seq-01", "mono"}) {
    EXPECT_EQ(openDataset(folder.file(name), options).reader->calibration().fx, 460.0) << name;
  }
  const Dataset euroc = openDataset(folder.file("euroc"), options);
  EXPECT_THAT(messageOf([&] { euroc.reader->next(); }), HasSubstr("image is 752x480 px, mine.txt says 640x480"));
}

TEST(Dataset, AnotherCameraOfTheRigCanBeChosen) {
  const TemporaryFolder folder;
  writeTumVi(folder, "vi");
  fs::copy(folder.file("vi/mav0/cam0"), folder.file("vi/mav0/cam1"), fs::copy_options::recursive);
  DatasetOptions options;
  options.camera = "cam1";
  EXPECT_THAT(messageOf([&] { openDataset(folder.file("vi"), options); }), HasSubstr("has no camera 'cam1', but cam0"));
  folder.write("vi/dso/camchain.yaml", folder.read("vi/dso/camchain.yaml") +
                                           "cam1:\n  intrinsics: [200, 201, 255, 256]\n  resolution: [512, 512]\n");
  EXPECT_EQ(openDataset(folder.file("vi"), options).reader->calibration().fx, 200.0);
  EXPECT_EQ(openDataset(folder.file("vi/mav0/cam1")).reader->calibration().fx, 200.0);
}

TEST(Dataset, ACameraThatIsNamedIsChosenFromTheCalibrationOrRefused) {
  const TemporaryFolder folder;
  const std::string rig =
      "cam0:\n  intrinsics: [200, 201, 640, 512]\n  resolution: [1280, 1024]\n"
      "cam1:\n  intrinsics: [300, 301, 640, 512]\n  resolution: [1280, 1024]\n";
  DatasetOptions options;
  options.camera = "cam1";
  writeTumMono(folder, "mono");
  const auto error = [&](const char* name) { return messageOf([&] { openDataset(folder.file(name), options); }); };
  EXPECT_THAT(error("mono"), HasSubstr("camera.txt: there is no camera 'cam1' to choose"));
  fs::remove(folder.file("mono/camera.txt"));
  folder.write("mono/camchain.yaml", rig);
  EXPECT_EQ(openDataset(folder.file("mono"), options).reader->calibration().fx, 300.0);
  writeTumRgbd(folder, "fr1");
  writeSevenScenes(folder, "seq-01");
  writeEuroc(folder, "euroc");
  EXPECT_THAT(error("fr1"), HasSubstr("--camera cam1: TUM RGB-D has one camera"));
  EXPECT_THAT(error("seq-01"), HasSubstr("--camera cam1: 7-Scenes has one camera"));
  EXPECT_THAT(error("euroc/mav0/cam0"), HasSubstr("sensor.yaml: there is no camera 'cam1' to choose"));
  options.calibration_file = folder.write("rig.yaml", rig);
  for (const char* name : {"mono", "fr1", "seq-01", "euroc/mav0/cam0"}) {
    EXPECT_EQ(openDataset(folder.file(name), options).reader->calibration().fx, 300.0) << name;
  }
}

TEST(Dataset, OptionsThatAFormHasNotAreRefused) {
  const TemporaryFolder folder;
  writeEuroc(folder, "euroc");
  writeSevenScenes(folder, "seq-01");
  DatasetOptions depth;
  depth.depth.subfolder = "depth";
  DatasetOptions images;
  images.images = "images_sharp";
  for (const char* name : {"euroc", "seq-01"}) {
    EXPECT_THAT(messageOf([&] { openDataset(folder.file(name), depth); }), HasSubstr("--depth depth: ")) << name;
    EXPECT_THAT(messageOf([&] { openDataset(folder.file(name), images); }), HasSubstr("--images images_sharp")) << name;
  }
}

}  // namespace
}  // namespace mba_vo::dataset_test
