#include "mba_vo/inspection/folder_inspection.h"

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/miniature.h"
#include "io/temporary_folder.h"
#include "mba_vo/inspection/camera_inspection.h"
#include "mba_vo/inspection/judgements.h"
#include "mba_vo/io/camera_yaml.h"

namespace mba_vo::folder_inspection_test {
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
  std::string inspect() const { return namesIn(folder()); }

  static std::string namesIn(const std::string& folder) {
    const InspectionReport report = inspectFolder(folder, {}, [](std::size_t, std::size_t) {});
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
  const InspectionReport report = inspectFolder(folder(), {}, [](std::size_t, std::size_t) {});
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

TEST_F(FolderInspectionTest, ACameraThatIsNamedIsChosenOrRefused) {
  DatasetOptions options;
  options.camera = "cam1";
  const auto look = [&] { return inspectFolder(folder(), options, [](std::size_t, std::size_t) {}); };
  const InspectionReport refused = look();
  ASSERT_FALSE(refused.cameras.front().findings.empty() && refused.findings.empty());
  std::ostringstream text;
  print(refused, text);
  EXPECT_NE(text.str().find("camera.yaml: there is no camera 'cam1' to choose"), std::string::npos) << text.str();
  std::filesystem::remove(path("camera.yaml"));
  std::ofstream(path("camchain.yaml")) << "cam1:\n  intrinsics: [160, 160, 79.5, 59.5]\n  resolution: [160, 120]\n";
  const InspectionReport chosen = look();
  EXPECT_EQ(chosen.cameras.front().facts.calibration->fx, 160.0);
  std::ostringstream commands;
  print(chosen, commands);
  EXPECT_NE(commands.str().find(" --camera cam1"), std::string::npos) << commands.str();
}

TEST_F(FolderInspectionTest, WithoutImagesThereIsNothingToLookAt) {
  std::filesystem::remove_all(path("images"));
  EXPECT_EQ(inspect(), "no-images 2");
}

/// Of what is in the miniatures, of one grey level and with hardly an image, this much may be said.
TEST_F(FolderInspectionTest, DataSetsOfEveryFormAreLookedAt) {
  const auto look = [&](const char* name, const auto& write) {
    write(folder_, name);
    const InspectionReport report = inspectFolder(path(name), {}, [](std::size_t, std::size_t) {});
    EXPECT_EQ(report.cameras.size(), 1U) << name;
    if (report.cameras.empty()) return std::string();
    const CameraFacts& facts = report.cameras.front().facts;
    return report.contents.at(0) + ", " + std::to_string(facts.images.size()) + " images, " +
           std::to_string(facts.exposures.size()) + " exposures, fx " +
           std::to_string(static_cast<int>(facts.calibration->fx)) + (facts.response_known ? ", response" : "");
  };
  EXPECT_EQ(look("tum", writeTumRgbd), "form: TUM RGB-D, 3 images, 0 exposures, fx 517");
  EXPECT_EQ(look("eth3d", writeEth3d), "form: ETH3D SLAM, 2 images, 0 exposures, fx 726");
  EXPECT_EQ(look("euroc", writeEuroc), "form: EuRoC (ASL), 2 images, 0 exposures, fx 458");
  EXPECT_EQ(look("tumvi", writeTumVi), "form: TUM-VI, 3 images, 2 exposures, fx 190, response");
  EXPECT_EQ(look("seven", writeSevenScenes), "form: 7-Scenes, 3 images, 0 exposures, fx 525");
  writeTumMono(folder_, "mono");
  const InspectionReport mono = inspectFolder(path("mono"), {}, [](std::size_t, std::size_t) {});
  EXPECT_TRUE(mono.cameras.at(0).facts.response_known);
  EXPECT_EQ(mono.cameras.at(0).facts.images.size(), 3U);
  EXPECT_EQ(namesIn(path("mono")).find("gamma"), std::string::npos) << "its JPEG come with a response";
}

TEST_F(FolderInspectionTest, OfADataSetTheFileThatIsMissingIsNamed) {
  writeEuroc(folder_, "euroc");
  std::filesystem::remove(path("euroc/mav0/cam0/sensor.yaml"));
  const InspectionReport report = inspectFolder(path("euroc"), {}, [](std::size_t, std::size_t) {});
  EXPECT_EQ(exitStatus(report), 2);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].check, Check::kBadFolder);
  EXPECT_NE(report.findings[0].what.find("sensor.yaml"), std::string::npos) << report.findings[0].what;
  std::filesystem::create_directories(path("nothing"));
  EXPECT_EQ(namesIn(path("nothing")), "bad-folder 2");
}

TEST_F(FolderInspectionTest, AnImageOfAnotherSizeEndsADataSet) {
  writeEth3d(folder_, "eth3d");
  writeImage(folder_, "eth3d/rgb/5455.220805.png", {8, 8}, 60);
  const InspectionReport report = inspectFolder(path("eth3d"), {}, [](std::size_t, std::size_t) {});
  EXPECT_EQ(exitStatus(report), 1);
  EXPECT_EQ(report.cameras.at(0).facts.images.size(), 1U) << "what was read is told all the same";
  EXPECT_NE(report.findings.at(0).what.find("5455.220805.png: image is 8x8"), std::string::npos);
}

TEST(CameraInspection, ExposuresThatChangeTellTheResponse) {
  for (const double gamma : {1.0, 2.2}) {
    CameraInspection camera;
    camera.setJpeg();
    for (int i = 0; i < kImages; ++i) {
      const double factor = 1.0 + 0.3 * (i % 3 - 1);  // 0.7 to 1.3
      cv::Mat1d light;
      view(i).convertTo(light, CV_64F, factor / 255.0 / 1.4);
      cv::pow(light, 1.0 / gamma, light);
      cv::Mat1b image;
      light.convertTo(image, CV_8U, 255.0);
      const std::int64_t stamp = (i + 1) * 40'000'000LL;
      camera.add({stamp, image, "jpeg", "", false});
      camera.addExposure(stamp, 0.01 * factor);
    }
    const auto response = measureResponse(camera.facts());
    ASSERT_TRUE(response) << gamma;
    EXPECT_NEAR(response->power, 1.0 / gamma, 0.03);
    EXPECT_EQ(judgeResponse(camera.facts()).size(), gamma == 1.0 ? 0U : 1U);
  }
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
}  // namespace mba_vo::folder_inspection_test
