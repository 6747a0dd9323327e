#include "mba_vo/io/camera_file.h"

#include <array>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include "camera_forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

bool beginsIni(const std::vector<TextLine>& lines) {
  for (const TextLine& line : lines) {
    if (line.words.size() == 1 && line.words.front() == "[image]") return true;
  }
  return false;
}

bool isYaml(const std::vector<TextLine>& lines) {
  for (const TextLine& line : lines) {
    const std::string& word = line.words.front();
    const bool key = std::isalpha(static_cast<unsigned char>(word.front())) != 0 || word.front() == '%';
    if (key && word.find(':') != std::string::npos) return true;
    if (key && line.words.size() > 1 && line.words[1].front() == ':') return true;
  }
  return false;
}

}  // namespace

void requireValid(const CameraCalibration& calibration, const std::string& where) {
  try {
    validate(calibration);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(where + ": " + error.what());
  }
}

SE3 poseOfMatrix(const std::vector<double>& values) {
  constexpr double kTolerance = 1e-3;  // files carry as few as four decimals
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool rigid = T.allFinite() && (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kTolerance &&
                     R.determinant() > 0.0 && (T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kTolerance;
  if (!rigid) throw std::invalid_argument("a rotation and a translation, over 0 0 0 1");
  return {Eigen::Quaterniond(R), T.topRightCorner<3, 1>()};
}

CameraFile readCameraFile(const std::string& file, const std::string& camera, cv::Size image_size) {
  const std::string text = readText(file, kMostCalibrationBytes);
  const std::vector<TextLine> lines = splitLines(text, file);
  if (lines.empty()) throw std::runtime_error(file + ": has nothing but comments, must be a camera calibration");
  if (beginsIni(lines)) return readCameraIni(text, file);
  if (isYaml(lines)) return readCameraYaml(YamlFields::parse(text, file), file, camera);
  return readCameraText(text, file, image_size);
}

CameraFile readChosenCamera(const std::string& file, const std::string& camera, cv::Size image_size) {
  CameraFile result = readCameraFile(file, camera, image_size);
  if (camera.empty() || result.has_names) return result;
  throw std::runtime_error(file + ": there is no camera '" + camera + "' to choose, for it (" + result.form +
                           ") is of one camera without a name: leave the name out, or name a calibration that has it");
}

std::string cameraFileIn(const std::string& folder) {
  constexpr std::array<const char*, 5> kNames{"camera.yaml", "camera.ini", "camera.txt", "camchain.yaml",
                                              "sensor.yaml"};
  const std::filesystem::path path(folder);
  for (const char* name : kNames) {
    if (std::filesystem::exists(path / name)) return (path / name).string();
  }
  return (path / kNames.front()).string();
}

}  // namespace mba_vo
