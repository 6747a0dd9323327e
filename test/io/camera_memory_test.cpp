#include "mba_vo/io/camera_memory.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "io/temporary_folder.h"

namespace mba_vo::camera_memory_test {
namespace {

CameraCalibration camera() { return {640, 480, 460.1, 459.0, 320.3, 239.7, "plumb_bob", {-0.1, 0.01, 0, 0, 0}}; }

FrameBuilderConfig configFor(const std::string& file) {
  FrameBuilderConfig config;
  config.learnt_file = file;
  config.row_time = 5e-5;
  return config;
}

CalibrationCorrection learnt() {
  CalibrationCorrection correction;
  correction.values << 0.0101, -1.0 / 3.0, 1e-17, 0.02, -0.03, 5.4e-5, -0.35, -0.06, -0.014;
  return correction;
}

std::string messageOf(CameraMemory& memory, const CameraCalibration& calibration) {
  try {
    memory.recall(calibration);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::string contentOf(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The content of a file that something was kept in.
std::string contentAfterKeeping(const std::string& file) {
  CameraMemory memory(configFor(file));
  memory.recall(camera());
  memory.keep(learnt());
  return contentOf(file);
}

TEST(CameraMemory, KeepsWhatWasLearntToTheLastBit) {
  const TemporaryFolder folder;
  const std::string file = folder.file("camera.yaml");
  CameraMemory first(configFor(file));
  EXPECT_TRUE(first.recall(camera()).isZero()) << "there is no file yet";
  first.keep(learnt());
  EXPECT_EQ(CameraMemory(configFor(file)).recall(camera()), learnt());
}

TEST(CameraMemory, WithoutANameKeepsNothing) {
  CameraMemory memory(configFor(""));
  EXPECT_TRUE(memory.recall(camera()).isZero());
  memory.keep(learnt());
}

TEST(CameraMemory, AnotherCameraIsToldAndLeftAlone) {
  const TemporaryFolder folder;
  const std::string file = folder.file("camera.yaml");
  const std::string before = contentAfterKeeping(file);

  CameraCalibration other = camera();
  other.distortion[0] = -0.11;
  CameraMemory second(configFor(file));
  const std::string message = messageOf(second, other);
  for (const char* part : {file.c_str(), "another camera", "distortion_coefficients", "-0.11", "delete"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  second.keep(CalibrationCorrection());
  EXPECT_EQ(contentOf(file), before);

  FrameBuilderConfig told = configFor(file);
  told.gamma = 2.2;
  CameraMemory third(told);
  EXPECT_NE(messageOf(third, camera()).find("gamma"), std::string::npos) << "a vignette belongs to a response";
}

TEST(CameraMemory, ADamagedFileIsToldAndLeftAlone) {
  const TemporaryFolder folder;
  const std::string file = folder.file("camera.yaml");
  const std::string whole = contentAfterKeeping(file);
  const std::size_t body = whole.find("version");
  for (const std::size_t length : {body, body + 5, body + 40, whole.find("correction:", body), whole.size() - 20}) {
    std::ofstream(file) << whole.substr(0, length);
    CameraMemory memory(configFor(file));
    EXPECT_NE(messageOf(memory, camera()).find(file), std::string::npos) << "of a file of " << length << " bytes";
    memory.keep(learnt());
    EXPECT_EQ(contentOf(file), whole.substr(0, length));
  }
}

TEST(CameraMemory, SaysWhereItCannotWrite) {
  CameraMemory memory(configFor("/nonexistent/camera.yaml"));
  memory.recall(camera());
  EXPECT_THROW(memory.keep(learnt()), std::runtime_error);
}

}  // namespace
}  // namespace mba_vo::camera_memory_test
