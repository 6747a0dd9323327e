#include "mba_vo/datasets/sequence_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/datasets/dataset.h"
#include "mba_vo/datasets/ground_truth.h"
#include "mba_vo/image/rectifier.h"

namespace mba_vo::sequence_export_test {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::HasSubstr;

const CameraCalibration kCamera{64, 48, 60.5, 61.0, 31.5, 23.25, "plumb_bob", {-0.1, 0.01, 0.001, -0.002}};
constexpr std::int64_t kFirst = 1403715273262142976;  // [ns]
constexpr std::int64_t kInterval = 50'000'003;        // [ns]

CameraImage imageOf(int index, int type = CV_8UC1) {
  CameraImage image;
  image.sequence = static_cast<std::uint64_t>(index);
  image.mid_exposure_ns = image.stamp_ns = kFirst + index * kInterval;
  image.exposure = 0.01 + 0.001 * index;
  image.image.create(48, 64, type);
  cv::randu(image.image, 1, 250);
  return image;
}

struct Exported {
  TemporaryFolder folder;
  std::vector<CameraImage> images;
};

/// `change`: of the images, before they are added.
template <typename Change>
std::unique_ptr<Exported> exported(const CameraCalibration& camera, const FrameBuilderConfig& config,
                                   const ExportOptions& options, const Change& change,
                                   const std::vector<PoseRecord>& truth = {}) {
  auto result = std::make_unique<Exported>();
  SequenceExport sequence(result->folder.file("out"), camera, config, options);
  for (int i = 0; i < 3; ++i) {
    CameraImage image = imageOf(i);
    change(image);
    sequence.add(image);
    result->images.push_back(image);
  }
  sequence.finish(truth);
  return result;
}

void asItIs(CameraImage& /*image*/) {}

TEST(SequenceExport, EachFormIsReadAgainWithTheSamePixelsTimesAndCalibration) {
  const auto out = exported(kCamera, {}, {}, asItIs);
  for (const std::string form : {"dso", "euroc", "tum"}) {
    const Dataset dataset = openDataset(out->folder.file("out/" + form));
    const CameraCalibration read = dataset.reader->calibration();
    EXPECT_EQ(read.fx, kCamera.fx) << form;
    EXPECT_THAT(read.distortion, testing::ElementsAreArray(kCamera.distortion)) << form;
    for (const CameraImage& original : out->images) {
      const auto image = dataset.reader->next();
      ASSERT_TRUE(image) << form;
      EXPECT_EQ(image->mid_exposure_ns, original.mid_exposure_ns) << form;
      EXPECT_EQ(cv::norm(image->image, original.image, cv::NORM_INF), 0.0) << form;
      if (form == "tum") continue;  // it has no place for them
      ASSERT_TRUE(image->exposure) << form;
      EXPECT_NEAR(*image->exposure, *original.exposure, 1e-12) << form;
    }
    EXPECT_FALSE(dataset.reader->next()) << form;
  }
}

TEST(SequenceExport, ListsAreInTheFormThatOrbSlamAndDsoRead) {
  const auto out = exported(kCamera, {}, {}, [](CameraImage& image) {
    if (image.sequence == 1) image.exposure.reset();
  });
  EXPECT_EQ(out->folder.read("out/euroc/times.txt"), "1403715273262142976\n1403715273312142979\n1403715273362142982\n");
  EXPECT_THAT(out->folder.read("out/tum/rgb.txt"),
              HasSubstr("# timestamp filename\n1403715273.262142976 rgb/1403715273."
                        "262142976.png\n"));
  EXPECT_EQ(out->folder.read("out/dso/times.txt"),
            "000000 1403715273.262142976 10\n000001 1403715273.312142979 0\n000002 1403715273.362142982 12\n");
  EXPECT_THAT(out->folder.read("out/tum/orb_slam.yaml"), HasSubstr("Camera.fps: 20\n"));
}

TEST(SequenceExport, TheTruthIsThatOfTheCameraInEachForm) {
  PoseRecord pose;
  pose.time = 1e-9 * static_cast<double>(kFirst);
  pose.T_world_camera = SE3(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, 2.0, 3.0});
  const auto out = exported(kCamera, {}, {}, asItIs, {pose});
  for (const char* form : {"dso", "euroc", "tum"}) {
    const auto truth = readGroundTruth(out->folder.file(std::string("out/") + form));
    ASSERT_EQ(truth.size(), 1U) << form;
    EXPECT_NEAR(truth[0].time, pose.time, 1e-6) << form;
    EXPECT_TRUE(truth[0].T_world_camera.translation().isApprox(pose.T_world_camera.translation())) << form;
    EXPECT_TRUE(truth[0].T_world_camera.rotationMatrix().isApprox(pose.T_world_camera.rotationMatrix())) << form;
  }
}

TEST(SequenceExport, WhatOthersWouldStumbleUponIsLeftOutAndSaid) {
  const TemporaryFolder folder;
  SequenceExport sequence(folder.file("out"), kCamera, {}, {});
  CameraImage broken = imageOf(1);
  broken.image.release();
  broken.problem = "a.png: not a readable image";
  CameraImage again = imageOf(2);
  again.mid_exposure_ns = kFirst;
  for (const CameraImage& image : {imageOf(0), broken, again, imageOf(3)}) sequence.add(image);
  sequence.finish({});
  EXPECT_THAT(sequence.leftOut(), ElementsAre("image 1: a.png: not a readable image", HasSubstr("image 2: its stamp")));
  EXPECT_TRUE(fs::exists(folder.file("out/dso/images/000001.png")));
  EXPECT_FALSE(fs::exists(folder.file("out/dso/images/000002.png")));
  EXPECT_THAT(folder.read("out/dso/times.txt"), HasSubstr("\n000001 1403715273.412142985 13\n"));
}

TEST(SequenceExport, MoreThanEightBitsBecomeEightByTheWhiteLevel) {
  const auto twelve = [](CameraImage& image) {
    image.image = cv::Mat(48, 64, CV_16UC1, cv::Scalar(2048));
    image.image.at<std::uint16_t>(0, 0) = 4095;
  };
  const auto out = exported(kCamera, {}, {{"dso"}}, twelve);
  const cv::Mat image = cv::imread(out->folder.file("out/dso/images/000000.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(image.type(), CV_8UC1);
  EXPECT_EQ(image.at<std::uint8_t>(0, 0), 255);
  EXPECT_EQ(image.at<std::uint8_t>(5, 5), 128);
  const auto brighter = [&](CameraImage& image_) {
    twelve(image_);
    if (image_.sequence == 2) image_.image.at<std::uint16_t>(0, 0) = 5000;
  };
  EXPECT_THAT(messageOf([&] { exported(kCamera, {}, {{"dso"}}, brighter); }),
              testing::AllOf(HasSubstr("image 2 has values above 4095"), HasSubstr("image.white_level")));
}

TEST(SequenceExport, ColourStaysAndAlphaGoes) {
  const auto out = exported(kCamera, {}, {{"tum"}}, [](CameraImage& image) {
    image.image = cv::Mat(48, 64, CV_8UC4, cv::Scalar(10, 20, 30, 7));
  });
  const cv::Mat image = cv::imread(out->folder.file("out/tum/rgb/1403715273.262142976.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.at<cv::Vec3b>(3, 3), cv::Vec3b(10, 20, 30));
}

TEST(SequenceExport, DepthsAreOfTheSamePixels) {
  const auto out = exported(kCamera, {}, {{"tum"}}, [](CameraImage& image) {
    if (image.sequence == 1) return;
    image.depth = cv::Mat1f(48, 64, 1.5F);
    image.depth(4, 4) = std::numeric_limits<float>::quiet_NaN();
    image.depth(5, 5) = 50.0F;  // does not fit
  });
  DatasetOptions options;
  options.depth.subfolder = "depth";
  const Dataset dataset = openDataset(out->folder.file("out/tum"), options);
  const cv::Mat1f depth = dataset.reader->next()->depth;
  EXPECT_FLOAT_EQ(depth(10, 10), 1.5F);
  EXPECT_TRUE(std::isnan(depth(4, 4)));
  EXPECT_TRUE(std::isnan(depth(5, 5)));
  EXPECT_TRUE(dataset.reader->next()->depth.empty());
  const std::string lines = out->folder.read("out/tum/associations.txt");
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
}

TEST(SequenceExport, WhatIsKnownOfThePixelsGoesToDso) {
  const TemporaryFolder files;
  cv::Mat vignette(48, 64, CV_16UC1, cv::Scalar(65535));
  vignette.at<std::uint16_t>(0, 0) = 30000;
  cv::imwrite(files.file("vignette.png"), vignette);
  FrameBuilderConfig config;
  config.gamma = 2.0;
  config.vignette_file = files.file("vignette.png");
  const auto out = exported(kCamera, config, {{"dso"}}, asItIs);
  const Dataset dataset = openDataset(out->folder.file("out/dso"));
  EXPECT_EQ(cv::norm(cv::imread(dataset.vignette_file, cv::IMREAD_UNCHANGED), vignette, cv::NORM_INF), 0.0);
  std::istringstream response(out->folder.read("out/dso/pcalib.txt"));
  const std::vector<double> values{std::istream_iterator<double>(response), {}};
  ASSERT_EQ(values.size(), 256U);
  EXPECT_NEAR(values[51], 255.0 * 0.2 * 0.2, 1e-6);
  const auto silent = exported(kCamera, {}, {{"dso"}}, asItIs);
  EXPECT_FALSE(fs::exists(silent->folder.file("out/dso/pcalib.txt"))) << "nothing is known of it";
  cv::imwrite(files.file("vignette.png"), cv::Mat(10, 10, CV_8UC1, cv::Scalar(255)));
  EXPECT_THAT(messageOf([&] { exported(kCamera, config, {}, asItIs); }), HasSubstr("vignette of 10x10 px, the images"));
}

TEST(SequenceExport, RectifiedImagesAreThoseOfAPinhole) {
  CameraCalibration rational = kCamera;
  rational.distortion_model = "rational_polynomial";
  rational.distortion = {-0.2, 0.05, 0.0, 0.0, 0.01, 0.02, 0.01, 0.0};
  ExportOptions options;
  EXPECT_THAT(messageOf([&] { exported(rational, {}, options, asItIs); }), HasSubstr("rational_polynomial"));
  options.rectify = true;
  const auto out = exported(rational, {}, options, asItIs);
  const Rectifier rectifier(rational);
  for (const char* form : {"dso", "euroc", "tum"}) {
    const Dataset dataset = openDataset(out->folder.file(std::string("out/") + form));
    EXPECT_TRUE(isUndistorted(dataset.reader->calibration())) << form;
    EXPECT_EQ(dataset.reader->calibration().fx, rectifier.camera().fx) << form;
    cv::Mat1f expected;
    out->images[0].image.convertTo(expected, CV_32F);
    expected = rectifier.rectify(expected);
    EXPECT_NEAR(dataset.reader->next()->image.at<std::uint8_t>(20, 12), expected(20, 12), 0.5) << form;
  }
}

TEST(SequenceExport, TheSheetTellsLightAndTextureOfEachImage) {
  const auto out = exported(kCamera, {}, {{"dso"}}, [](CameraImage& image) {
    for (int x = 0; x < 64; ++x) image.image.col(x).setTo(image.sequence == 0 ? 2 * x : 100);
    if (image.sequence == 2) image.image.rowRange(0, 12).setTo(255);
  });
  const std::string sheet = out->folder.read("out/frames.csv");
  EXPECT_THAT(sheet, HasSubstr("sequence,time,exposure,light,saturated,texture\n"));
  EXPECT_THAT(sheet, HasSubstr("\n0,1403715273.262142976,0.01,63,0.015625,1.9375\n")) << "2 but in the outer columns";
  EXPECT_THAT(sheet, HasSubstr("\n1,1403715273.312142979,0.011,100,0,0\n"));
  EXPECT_THAT(sheet, HasSubstr(",138.75,0.25,"));
}

TEST(SequenceExport, AnotherExportIsReplacedOnlyWhenTold) {
  const TemporaryFolder folder;
  const auto write = [&](bool overwrite, int images) {
    SequenceExport sequence(folder.file("out"), kCamera, {}, {{"dso"}, false, overwrite});
    for (int i = 0; i < images; ++i) sequence.add(imageOf(i));
    sequence.finish({});
  };
  write(false, 3);
  EXPECT_THAT(messageOf([&] { write(false, 2); }), HasSubstr("out/dso: is there already"));
  write(true, 2);
  EXPECT_FALSE(fs::exists(folder.file("out/dso/images/000002.png")));
  fs::remove(folder.file("out/frames.csv"));
  EXPECT_THAT(messageOf([&] { write(true, 2); }), HasSubstr("out/dso: not an earlier export"));
}

TEST(SequenceExport, WrongInputIsNamed) {
  EXPECT_THAT(messageOf([&] { exported(kCamera, {}, {{"kitti"}}, asItIs); }),
              HasSubstr("form 'kitti': must be one of dso, euroc, tum"));
  EXPECT_THAT(messageOf([&] { exported(kCamera, {}, {}, [](CameraImage& i) { i.image = cv::Mat1b(10, 20); }); }),
              HasSubstr("image 0 is 20x10 px, the calibration says 64x48"));
  const TemporaryFolder folder;
  EXPECT_THAT(messageOf([&] { SequenceExport(folder.file("out"), kCamera, {}, {}).finish({}); }),
              HasSubstr("out: no image to export"));
}

}  // namespace
}  // namespace mba_vo::sequence_export_test
