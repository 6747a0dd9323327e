#include <sys/inotify.h>
#include <unistd.h>

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/io/sequence.h"

namespace mba_vo::sequence_folder_test {
namespace {

using testing::HasSubstr;

constexpr const char* kCamera =
    "image_width: 32\nimage_height: 24\ncamera_name: test\n"
    "camera_matrix: {rows: 3, cols: 3, data: [20.5, 0, 15.5, 0, 21.5, 11.5, 0, 0, 1]}\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.01, 0.02, 0]}\n";
constexpr const char* kTimes =
    "# id t exposure\n0 1305031453.359684123 20.0\n1 1305031453.391690 0\n3 1305031453.42 -5\n";

/// A sequence folder of three images, good until a test spoils it.
class SequenceFolderTest : public testing::Test {
 protected:
  SequenceFolderTest() {
    folder_.write("camera.yaml", kCamera);
    folder_.write("times.txt", kTimes);
    std::filesystem::create_directory(folder_.file("images"));
    cv::imwrite(folder_.file("images/000000.png"), cv::Mat(24, 32, CV_8UC1, cv::Scalar(10)));
    cv::imwrite(folder_.file("images/000001.jpg"), cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 20, 30)));
    cv::imwrite(folder_.file("images/000003.png"), cv::Mat(24, 32, CV_16UC1, cv::Scalar(3000)));
  }
  std::string errorOnOpen(const std::string& images = "images") const {
    return messageOf([&] { openSequenceFolder(folder_.file(""), images); });
  }

  const TemporaryFolder folder_;
};

TEST_F(SequenceFolderTest, ReadsCalibrationImagesAndTimes) {
  const auto reader = openSequenceFolder(folder_.file(""), "images");
  const CameraCalibration calibration = reader->calibration();
  EXPECT_EQ(calibration.width, 32);
  EXPECT_EQ(calibration.height, 24);
  EXPECT_DOUBLE_EQ(calibration.fx, 20.5);
  EXPECT_DOUBLE_EQ(calibration.fy, 21.5);
  EXPECT_DOUBLE_EQ(calibration.cx, 15.5);
  EXPECT_DOUBLE_EQ(calibration.cy, 11.5);
  EXPECT_EQ(calibration.distortion_model, "plumb_bob");
  EXPECT_THAT(calibration.distortion, testing::ElementsAre(0.1, -0.2, 0.01, 0.02, 0.0));
  EXPECT_EQ(reader->size(), 3U);
  const auto first = reader->next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->sequence, 0U);
  EXPECT_EQ(first->mid_exposure_ns, 1305031453359684123);
  EXPECT_EQ(first->stamp_ns, first->mid_exposure_ns);
  EXPECT_DOUBLE_EQ(first->exposure.value(), 0.02);
  EXPECT_EQ(first->image.type(), CV_8UC1);
  const auto second = reader->next();
  EXPECT_FALSE(second->exposure.has_value());
  EXPECT_EQ(second->image.type(), CV_8UC3);
  const auto third = reader->next();
  EXPECT_EQ(third->sequence, 2U);
  EXPECT_DOUBLE_EQ(third->exposure.value(), -0.005);  // for the InputGuard to judge
  EXPECT_EQ(third->image.type(), CV_16UC1);
  EXPECT_FALSE(reader->next().has_value());
}

TEST_F(SequenceFolderTest, ExposuresAreThoseOfTheFolderImages) {
  std::filesystem::rename(folder_.file("images"), folder_.file("images_sharp"));
  const auto reader = openSequenceFolder(folder_.file(""), "images_sharp");
  EXPECT_FALSE(reader->next()->exposure.has_value());
}

TEST_F(SequenceFolderTest, ReadsDepthImagesOfTheSameIds) {
  cv::Mat1w depth(24, 32, static_cast<std::uint16_t>(10000));
  depth(3, 4) = 0;
  std::filesystem::create_directory(folder_.file("depth"));
  cv::imwrite(folder_.file("depth/000003.png"), depth);
  cv::imwrite(folder_.file("depth/000007.png"), depth);  // of no image
  for (const double units : {5000.0, 1000.0}) {
    const auto reader = openSequenceFolder(folder_.file(""), "images", {"depth", units});
    EXPECT_TRUE(reader->next()->depth.empty());
    EXPECT_TRUE(reader->next()->depth.empty());
    const cv::Mat1f metres = reader->next()->depth;
    ASSERT_EQ(metres.size(), depth.size());
    EXPECT_FLOAT_EQ(metres(4, 3), static_cast<float>(10000.0 / units));
    EXPECT_TRUE(std::isnan(metres(3, 4)));
  }
}

TEST_F(SequenceFolderTest, WrongDepthImagesAreNamed) {
  const auto error = [&] {
    return messageOf([&] {
      const auto reader = openSequenceFolder(folder_.file(""), "images", {"depth", 5000.0});
      while (reader->next()) {
      }
    });
  };
  EXPECT_THAT(error(), HasSubstr("depth: no such folder"));
  std::filesystem::create_directory(folder_.file("depth"));
  EXPECT_THAT(error(), testing::AllOf(HasSubstr("depth: no depth image"), HasSubstr("000000.png")));
  cv::imwrite(folder_.file("depth/000001.png"), cv::Mat(24, 32, CV_8UC1, cv::Scalar(10)));
  EXPECT_THAT(error(), testing::AllOf(HasSubstr("depth/000001.png"), HasSubstr("8UC1"), HasSubstr("16UC1")));
  cv::imwrite(folder_.file("depth/000001.png"), cv::Mat(12, 32, CV_16UC1, cv::Scalar(10)));
  EXPECT_THAT(error(), testing::AllOf(HasSubstr("depth/000001.png"), HasSubstr("32x12"), HasSubstr("32x24")));
}

TEST_F(SequenceFolderTest, AnUnreadableDepthImageIsTold) {
  folder_.write("depth/000000.png", "nonsense");
  const auto reader = openSequenceFolder(folder_.file(""), "images", {"depth", 5000.0});
  const auto image = reader->next();
  EXPECT_FALSE(image->image.empty());
  EXPECT_TRUE(image->depth.empty());
  EXPECT_THAT(image->problem, HasSubstr("depth/000000.png: not a readable depth image"));
}

TEST_F(SequenceFolderTest, MissingPartsAreNamed) {
  EXPECT_THAT(messageOf([] { openSequenceFolder("/nonexistent", "images"); }),
              HasSubstr("/nonexistent: no such folder"));
  EXPECT_THAT(errorOnOpen("images_sharp"), HasSubstr("images_sharp: no such folder"));
  std::filesystem::remove(folder_.file("images/000003.png"));
  EXPECT_THAT(errorOnOpen(), HasSubstr("images/000003.*: no such image"));
  std::filesystem::remove(folder_.file("times.txt"));
  EXPECT_THAT(errorOnOpen(), HasSubstr("times.txt: cannot be read"));
  std::filesystem::remove(folder_.file("camera.yaml"));
  EXPECT_THAT(errorOnOpen(), HasSubstr("camera.yaml: cannot be read"));
}

TEST_F(SequenceFolderTest, MalformedTimesAreNamedWithTheirLine) {
  const auto error = [&](const std::string& times) {
    folder_.write("times.txt", times);
    return errorOnOpen();
  };
  EXPECT_THAT(error("0 1.0 20\nzero 2.0 20\n"), HasSubstr("times.txt:2: image id 'zero'"));
  EXPECT_THAT(error("-1 1.0 20\n"), HasSubstr("image id '-1'"));
  EXPECT_THAT(error("0 soon 20\n"), HasSubstr("times.txt:1: time 'soon'"));
  EXPECT_THAT(error("0 nan 20\n"), HasSubstr("time 'nan' is out of range"));
  EXPECT_THAT(error("0 1.0 20ms\n"), HasSubstr("exposure '20ms'"));
  EXPECT_THAT(error("0\n"), HasSubstr("1 columns"));
  EXPECT_THAT(error("# nothing\n"), HasSubstr("lists no image"));
}

TEST_F(SequenceFolderTest, WrongCalibrationIsNamed) {
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string camera = kCamera;
    camera.replace(camera.find(from), from.size(), to);
    folder_.write("camera.yaml", camera);
    return errorOnOpen();
  };
  EXPECT_THAT(error("image_width: 32", "width: 32"), HasSubstr("camera.yaml:1: 'image_width' is missing"));
  EXPECT_THAT(error("image_width: 32", "image_width: wide"),
              HasSubstr("camera.yaml:1: 'image_width' is wide, must be a whole number"));
  EXPECT_THAT(error(", 0, 0, 1]", "]"), HasSubstr("'camera_matrix.data'"));
  EXPECT_THAT(error("[20.5", "[-20.5"), HasSubstr("fx"));
  EXPECT_THAT(error("plumb_bob", "fisheye"), HasSubstr("'fisheye'"));
  EXPECT_THAT(error("image_width: 32", "image_width: [32"), HasSubstr("camera.yaml"));
}

TEST_F(SequenceFolderTest, ImageOfAnotherSizeIsAnError) {
  cv::imwrite(folder_.file("images/000000.png"), cv::Mat(20, 30, CV_8UC1, cv::Scalar(10)));
  const auto reader = openSequenceFolder(folder_.file(""), "images");
  EXPECT_THAT(messageOf([&] { reader->next(); }), HasSubstr("000000.png: image is 30x20 px, camera.yaml says 32x24"));
}

TEST_F(SequenceFolderTest, UnreadableImageDoesNotEndTheSequence) {
  folder_.write("images/000000.png", "this is no image");
  const auto reader = openSequenceFolder(folder_.file(""), "images");
  const auto broken = reader->next();
  ASSERT_TRUE(broken.has_value());
  EXPECT_TRUE(broken->image.empty());
  EXPECT_THAT(broken->problem, HasSubstr("000000.png: not a readable image"));
  EXPECT_FALSE(reader->next()->image.empty());
}

TEST_F(SequenceFolderTest, WebpIsReadAsGrey) {
  std::filesystem::remove(folder_.file("images/000000.png"));
  cv::imwrite(folder_.file("images/000000.webp"), cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(77)),
              {cv::IMWRITE_WEBP_QUALITY, 101});  // above 100: lossless
  const auto image = openSequenceFolder(folder_.file(""), "images")->next()->image;
  ASSERT_EQ(image.type(), CV_8UC1);
  EXPECT_EQ(image.at<unsigned char>(5, 5), 77);
}

/// Tells whether a file is opened during the life of the object.
class OpenWatcher {
 public:
  explicit OpenWatcher(const std::string& file) : queue_(inotify_init1(IN_NONBLOCK)) {
    EXPECT_GE(inotify_add_watch(queue_, file.c_str(), IN_OPEN), 0);
  }
  ~OpenWatcher() { close(queue_); }
  OpenWatcher(const OpenWatcher&) = delete;
  OpenWatcher& operator=(const OpenWatcher&) = delete;
  bool opened() const {
    std::array<char, 4096> events{};
    return read(queue_, events.data(), events.size()) > 0;
  }

 private:
  int queue_;
};

TEST_F(SequenceFolderTest, GroundTruthIsNeverOpened) {
  const OpenWatcher watcher(folder_.write("groundtruth.txt", "rubbish"));
  const auto reader = openSequenceFolder(folder_.file(""), "images");
  while (reader->next()) {
  }
  EXPECT_FALSE(watcher.opened());
  folder_.read("groundtruth.txt");
  EXPECT_TRUE(watcher.opened());  // the watcher would have seen it
}

}  // namespace
}  // namespace mba_vo::sequence_folder_test
