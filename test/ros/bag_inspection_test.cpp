#include "mba_vo/ros/bag_inspection.h"

#include <algorithm>
#include <string>
#include <vector>

#include "bag_fixture.h"
#include "io/temporary_folder.h"
#include "mba_vo/ros/bag_image_writer.h"

namespace mba_vo::bag_inspection_test {
namespace {

class BagInspectionTest : public BagTest {
 protected:
  void write(const CameraCalibration& calibration) const {
    BagImageWriter writer(file_, calibration, StampReference::kMiddle);
    for (int i = 0; i < 3; ++i) writer.write(kStart + i * kInterval, 0.01, testImage(i));
    writer.close();
  }
  InspectionReport inspect(const BagInspectionOptions& options) const {
    return inspectBag(file_, options, [](std::size_t, std::size_t) {});
  }
  static bool has(const CameraReport& camera, Check check) {
    return std::any_of(camera.findings.begin(), camera.findings.end(),
                       [check](const Finding& finding) { return finding.check == check; });
  }

  const TemporaryFolder folder_;
};

TEST_F(BagInspectionTest, ACalibrationFileIsUsedInPlaceOfCameraInfo) {
  CameraCalibration zero = testCalibration();
  zero.fx = 0.0;
  write(zero);
  EXPECT_TRUE(has(inspect({}).cameras.at(0), Check::kBadCameraInfo));
  folder_.write("chain.yaml",
                "cam0: {camera_model: pinhole, intrinsics: [20, 20, 16, 10], distortion_model: none, "
                "distortion_coeffs: [], resolution: [32, 20]}\n"
                "cam1: {camera_model: pinhole, intrinsics: [31, 31, 16, 10], distortion_model: none, "
                "distortion_coeffs: [], resolution: [32, 20]}\n");
  const std::string file = folder_.file("chain.yaml");
  const InspectionReport report = inspect({"", file, "cam1"});
  const CameraReport& camera = report.cameras.at(0);
  EXPECT_FALSE(has(camera, Check::kBadCameraInfo));
  ASSERT_TRUE(camera.facts.calibration);
  EXPECT_EQ(camera.facts.calibration->fx, 31.0);
  const std::vector<std::string> lines = commandsFor(report, camera).lines;
  ASSERT_EQ(lines.size(), 1U) << "nodes would take the camera_info of the bag";
  EXPECT_NE(lines[0].find(" --camera cam1 --calibration " + file + " "), std::string::npos) << lines[0];
  EXPECT_EQ(lines[0].find("--camera-info-topic"), std::string::npos) << lines[0];
}

TEST_F(BagInspectionTest, ACalibrationFileThatIsWrongIsNamed) {
  write(testCalibration());
  folder_.write("camera.yaml", "image_width: 160\n");
  const CameraReport camera = inspect({"", folder_.file("camera.yaml"), ""}).cameras.at(0);
  ASSERT_TRUE(has(camera, Check::kBadCameraInfo));
  EXPECT_NE(camera.findings.at(0).what.find("camera.yaml"), std::string::npos) << camera.findings.at(0).what;
}

TEST_F(BagInspectionTest, WithoutOneBothCommandsNameTheTopics) {
  write(testCalibration());
  const InspectionReport report = inspect({});
  const std::vector<std::string> lines = commandsFor(report, report.cameras.at(0)).lines;
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].find(" --camera-info-topic /camera/camera_info "), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find(" camera_info:=/camera/camera_info "), std::string::npos) << lines[1];
}

}  // namespace
}  // namespace mba_vo::bag_inspection_test
