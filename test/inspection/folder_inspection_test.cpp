#include "mba_vo/inspection/folder_inspection.h"

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/inspection/camera_inspection.h"
#include "mba_vo/io/camera_yaml.h"

namespace mba_vo {
namespace {

constexpr int kImages = 40;
const cv::Size kSize(160, 120);

/// A camera that moves over blocks of random brightness, large and small: image `i`.
cv::Mat1b view(int i) {
  cv::RNG random(1);
  cv::Mat1b small(60, 80);
  cv::Mat1b large(9, 12);
  random.fill(small, cv::RNG::UNIFORM, 0, 40);
  random.fill(large, cv::RNG::UNIFORM, 20, 200);
  const cv::Size size(480, 360);
  cv::Mat1b scene;
  cv::resize(small, small, size, 0, 0, cv::INTER_NEAREST);
  cv::resize(large, large, size, 0, 0, cv::INTER_NEAREST);
  cv::add(small, large, scene);
  cv::Mat1b image = scene(cv::Rect({3 * i, 2 * i}, kSize)).clone();
  cv::Mat1b noise(kSize);
  cv::RNG(static_cast<unsigned>(i + 2)).fill(noise, cv::RNG::UNIFORM, 0, 4);
  cv::add(image, noise, image);
  return image;
}

class FolderInspectionTest : public ::testing::Test {
 protected:
  FolderInspectionTest() {
    std::filesystem::create_directories(path("images"));
    std::ofstream times(path("times.txt"));
    for (int i = 0; i < kImages; ++i) {
      std::ostringstream name;
      name << "images/" << std::setw(6) << std::setfill('0') << i << ".png";
      cv::imwrite(path(name.str()), view(i));
      times << i << " " << 100.0 + 0.04 * i << " 10.0\n";
    }
    std::ofstream camera(path("camera.yaml"));
    writeCameraYaml({kSize.width, kSize.height, 150.0, 150.0, 79.5, 59.5, "plumb_bob", {0, 0, 0, 0, 0}}, "test",
                    camera);
  }

  std::string path(const std::string& name) const { return folder_.file(name); }

  std::string folder() const { return std::filesystem::path(path("times.txt")).parent_path().string(); }

  /// Names of what is found, and the exit status.
  std::string inspect() const {
    const InspectionReport report = inspectFolder(folder(), "images", [](std::size_t, std::size_t) {});
    std::string text;
    const auto append = [&](const std::vector<Finding>& findings) {
      for (const Finding& finding : findings) text += std::string(textOf(finding.check).name) + " ";
    };
    append(report.findings);
    for (const CameraReport& camera : report.cameras) append(camera.findings);
    return text + std::to_string(exitStatus(report));
  }

  TemporaryFolder folder_;
};

TEST_F(FolderInspectionTest, NothingIsWrongWithAGoodFolderAndItsCommandIsTold) {
  EXPECT_EQ(inspect(), "0");
  const InspectionReport report = inspectFolder(folder(), "images", [](std::size_t, std::size_t) {});
  std::ostringstream text;
  print(report, text);
  EXPECT_NE(text.str().find("rosrun mba_vo mba_vo_offline " + folder() + " --output"), std::string::npos);
  EXPECT_NE(text.str().find("40, 160x120"), std::string::npos) << text.str();
  EXPECT_NE(text.str().find("3.6 px from image to image"), std::string::npos) << text.str();  // 3 and 2 px
  EXPECT_NE(text.str().find("blur 0.9 "), std::string::npos) << text.str();                   // a quarter of it
}

TEST_F(FolderInspectionTest, DoesNotStopAtTheFirstThingThatIsWrong) {
  std::filesystem::remove(path("images/000003.png"));
  std::ofstream(path("images/000005.png")) << "no image";
  std::ofstream(path("camera.yaml")) << "image_width: 160\n";
  EXPECT_EQ(inspect(), "bad-camera-info missing-images image-damaged 1");
  std::filesystem::remove(path("camera.yaml"));
  std::ofstream(path("times.txt")) << "0 now\n";
  EXPECT_EQ(inspect(), "no-camera-info bad-times image-damaged no-exposure 1");
}

TEST_F(FolderInspectionTest, WithoutImagesThereIsNothingToLookAt) {
  std::filesystem::remove_all(path("images"));
  EXPECT_EQ(inspect(), "no-images 2");
}

TEST(CameraInspection, BlurTakesAwayTheDetail) {
  CameraInspection camera;
  for (int i = 0; i < 3; ++i) {
    cv::Mat image = view(i);
    if (i == 1) cv::blur(image, image, {9, 1});  // motion: the other direction stays sharp
    if (i == 2) cv::blur(image, image, {21, 21});
    camera.add({1 + i, image, "mono8", "", false});
  }
  const std::vector<ImageFacts>& images = camera.facts().images;
  EXPECT_GT(images[0].pixels.detail, 1.5);
  EXPECT_GT(images[1].pixels.detail, 1.5);
  EXPECT_LT(images[2].pixels.detail, 0.6);
}

TEST(CameraInspection, TwelveBitImagesAndRepeatsAreNoticed) {
  CameraInspection camera;
  cv::Mat wide;
  view(0).convertTo(wide, CV_16U, 16.0);
  camera.add({1, wide, "mono16", "", false});
  camera.add({2, wide, "mono16", "", false});
  camera.add({3, cv::Mat1f(120, 160, 1.0F), "32FC1", "", false});
  EXPECT_EQ(camera.facts().white_level, 4095.0);
  EXPECT_FALSE(camera.facts().images[0].repeats);
  EXPECT_TRUE(camera.facts().images[1].repeats);
  EXPECT_TRUE(camera.facts().images[2].bad_encoding);
}

}  // namespace
}  // namespace mba_vo
